"""Keeps the master's view of this node equal to what the node has: registers, retries, and registers everything anew
after a master has been away. Runs on MicroPython."""

from roslet.engine.ros1.graph import Subscription
from roslet.errors import Fault

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.ros1.engine import Engine
    from roslet.engine.ros1.graph import Publication, ServiceOffer

    Entry = Publication | Subscription | ServiceOffer

WANTED = 0
ASKED = 1
DONE = 2

# Seconds between two tries while the master does not answer.
RETRY = 0.5
# Seconds between two checks that the master still knows this node: it forgets everybody when it is restarted.
CHECK = 2.0
# Seconds after which every other node must have noticed a restart too, and registered again.
GRACE = 2.5 * CHECK
# Registrations that may be under way: a node with thousands of topics must not flood a master that has just come back.
IN_FLIGHT = 64
# What is withdrawn while the master is away is told to it when it is back; this many at most.
MAX_WITHDRAWN = 1000


class Registrations:
    """The node's entries and how far the master knows them.

    master_lost   whether the master did not answer the last time. Then one entry is tried every `retry` seconds.
    """

    def __init__(self, engine: "Engine", check: float = CHECK, retry: float = RETRY) -> None:
        self.engine = engine
        self.check = check
        self.retry = retry
        self.entries: dict[Entry, int] = {}
        self.master_lost = False
        self._next: float | None = None
        self._checking = False
        self._asked = 0
        self._forgotten = False
        self._withdrawn: list[tuple[str, list[object]]] = []

    def add(self, entry: "Entry", now: float) -> None:
        self.entries[entry] = WANTED
        if not self.master_lost:
            self._register_wanted(now)

    def remove(self, entry: "Entry", now: float) -> None:
        """Forget the entry and tell the master; later, where it is away."""
        if self.entries.pop(entry, None) is None:
            return
        method, arguments = self.withdrawal(entry)
        self._withdraw(method, arguments, now)

    def _withdraw(self, method: str, arguments: "list[object]", now: float) -> None:
        def answered(value: object, error: "Exception | None", when: float) -> None:
            if error is None or isinstance(error, Fault) or self._forgotten:
                return
            if len(self._withdrawn) < MAX_WITHDRAWN:
                # It may only be out of reach, and still send others here.
                self._withdrawn.append((method, arguments))
            self._lost(error, when)

        self.engine.call_master(method, arguments, answered, now)

    def withdrawal(self, entry: "Entry") -> "tuple[str, list[object]]":
        """The call that takes an entry back."""
        engine = self.engine
        where = engine.service_uri if entry.kind == "Service" else engine.uri
        arguments: list[object] = [engine.name, entry.topic, where]
        return "unregister" + entry.kind, arguments

    def forget(self) -> None:
        """Register nothing any more: the node ends."""
        self.entries.clear()
        self._next = None
        self._forgotten = True

    def done(self, entry: "Entry") -> bool:
        return self.entries.get(entry) == DONE

    @property
    def settled(self) -> bool:
        """Whether the master has answered for every entry."""
        return all(state == DONE for state in self.entries.values())

    def deadline(self) -> "float | None":
        return self._next

    def handle_deadline(self, now: float) -> None:
        if self._next is None or now < self._next:
            return
        self._next = now + (self.retry if self.master_lost else self.check)
        if WANTED in self.entries.values():
            self._register_wanted(now)
        elif (self.entries or self.master_lost) and not self._checking and not self._asked:
            self._checking = True
            self.engine.call_master("lookupNode", [self.engine.name, self.engine.name], self._checked, now)

    def _register_wanted(self, now: float) -> None:
        """Go on registering. While the master is lost one call finds out whether it is back."""
        for entry, state in list(self.entries.items()):
            if self._asked >= (1 if self.master_lost else IN_FLIGHT):
                return
            if state == WANTED:
                self._register(entry, now)

    def _register(self, entry: "Entry", now: float) -> None:
        engine = self.engine
        self.entries[entry] = ASKED
        self._asked += 1
        if entry.kind == "Service":
            arguments = [engine.name, entry.topic, engine.service_uri, engine.uri]
        else:
            arguments = [engine.name, entry.topic, entry.type, engine.uri]

        def answered(value: object, error: "Exception | None", when: float) -> None:
            self._asked -= 1
            self._answered(entry, value, error, when)

        engine.call_master("register" + entry.kind, arguments, answered, now)

    def _answered(self, entry: "Entry", value: object, error: "Exception | None", now: float) -> None:
        if self._forgotten:
            return
        if error is not None and not isinstance(error, Fault):
            if entry in self.entries:
                self.entries[entry] = WANTED
            self._lost(error, now)
            return
        if self.master_lost:
            self._found(now)
        if self._next is None:
            self._next = now + self.check
        if entry in self.entries:
            self.entries[entry] = DONE
            if error is not None:
                self.engine.count("registration-refused")
                self.engine.note("the master refuses %s %s: %s" % (entry.kind.lower(), entry.topic, error))
            elif isinstance(entry, Subscription) and isinstance(value, list):
                entry.update([uri for uri in value if isinstance(uri, str)], now)
        self._register_wanted(now)

    def _checked(self, value: object, error: "Exception | None", now: float) -> None:
        self._checking = False
        if self._forgotten:
            return
        if error is not None and not isinstance(error, Fault):
            self._lost(error, now)
        elif self.master_lost:
            self._found(now)
        elif error is None:
            if value != self.engine.uri:
                # Another node has our name now; the master tells us to shut down.
                self.engine.count("name-taken")
        elif self.entries:
            self.engine.note("the master has forgotten this node (it was restarted): registering again")
            self._again(now)

    def _lost(self, error: Exception, now: float) -> None:
        self._next = now + self.retry
        if not self.master_lost:
            self.master_lost = True
            self.engine.note(
                "cannot reach the master at %s (%s); waiting for it" % (self.engine.master_uri, error)
            )

    def _found(self, now: float) -> None:
        """It answers again. It may be a new one, which knows nothing."""
        self.master_lost = False
        self.engine.note("the master at %s answers" % self.engine.master_uri)
        self._again(now)
        withdrawn, self._withdrawn = self._withdrawn, []
        for method, arguments in withdrawn:
            self._withdraw(method, arguments, now)

    def _again(self, now: float) -> None:
        """Register everything that is registered, as if it were new."""
        for entry, state in self.entries.items():
            if state == DONE:
                self.entries[entry] = WANTED
        self._next = now + self.check
        self.engine.grace_until = now + GRACE
        self.engine.master_found(now)
        self._register_wanted(now)
