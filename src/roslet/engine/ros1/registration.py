"""Keeps the master's view of this node equal to what the node has: registers, retries, and registers everything anew
after a master has been away. Runs on MicroPython."""

from roslet.errors import Fault

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.ros1.engine import Engine
    from roslet.engine.ros1.graph import Publication, ServiceOffer, Subscription

    Entry = Publication | Subscription | ServiceOffer

WANTED = 0
ASKED = 1
DONE = 2

# Seconds between two tries while the master does not answer.
RETRY = 0.5
# Seconds between two checks that the master still knows this node: it forgets everybody when it is restarted.
CHECK = 2.0


class Registrations:
    """The node's entries and how far the master knows them."""

    def __init__(self, engine: "Engine", check: float = CHECK, retry: float = RETRY) -> None:
        self.engine = engine
        self.check = check
        self.retry = retry
        self.entries: dict[Entry, int] = {}
        self.master_lost = False
        self._next: float | None = None
        self._checking = False

    def add(self, entry: "Entry", now: float) -> None:
        self.entries[entry] = WANTED
        self._register(entry, now)

    def remove(self, entry: "Entry", now: float) -> None:
        """Forget the entry and tell the master, once, without retrying: a master that is away forgets by itself."""
        if self.entries.pop(entry, None) is None:
            return
        engine = self.engine
        where = engine.service_uri if entry.kind == "Service" else engine.uri
        engine.call_master("unregister" + entry.kind, [engine.name, entry.topic, where], _ignore, now)

    def done(self, entry: "Entry") -> bool:
        return self.entries.get(entry) == DONE

    @property
    def settled(self) -> bool:
        """Whether the master has answered for every entry."""
        return all([state == DONE for state in self.entries.values()])

    def deadline(self) -> "float | None":
        return self._next

    def handle_deadline(self, now: float) -> None:
        if self._next is None or now < self._next:
            return
        self._next = now + self.check
        wanted = [entry for entry, state in self.entries.items() if state == WANTED]
        if self.master_lost:
            # One call finds out whether the master is back; it must not be asked with everything at once.
            for entry in wanted[:1]:
                self._register(entry, now)
        elif wanted:
            for entry in wanted:
                self._register(entry, now)
        elif self.entries and not self._checking:
            self._checking = True
            self.engine.call_master("lookupNode", [self.engine.name, self.engine.name], self._checked, now)

    def _register(self, entry: "Entry", now: float) -> None:
        engine = self.engine
        self.entries[entry] = ASKED
        if entry.kind == "Service":
            arguments = [engine.name, entry.topic, engine.service_uri, engine.uri]
        else:
            arguments = [engine.name, entry.topic, entry.type, engine.uri]

        def answered(value: object, error: "Exception | None", when: float) -> None:
            self._answered(entry, value, error, when)

        engine.call_master("register" + entry.kind, arguments, answered, now)

    def _answered(self, entry: "Entry", value: object, error: "Exception | None", now: float) -> None:
        if entry not in self.entries:
            return
        if error is not None:
            self.entries[entry] = WANTED
            if isinstance(error, Fault):
                self.engine.note("the master refuses %s %s: %s" % (entry.kind.lower(), entry.topic, error))
                self.entries[entry] = DONE
            else:
                self._lost(error, now)
            return
        self.entries[entry] = DONE
        if self._next is None:
            self._next = now + self.check
        if self.master_lost:
            self._found(now)
        if entry.kind == "Subscriber" and isinstance(value, list):
            entry.update([uri for uri in value if isinstance(uri, str)], now)  # type: ignore[union-attr]

    def _checked(self, value: object, error: "Exception | None", now: float) -> None:
        self._checking = False
        if error is None:
            if value != self.engine.uri:
                # Another node has our name now; the master tells us to shut down.
                self.engine.count("master: name-taken")
            return
        if isinstance(error, Fault):
            if self.entries:
                self.engine.note("the master has forgotten this node (it was restarted): registering again")
                self._again(now)
        else:
            for entry in self.entries:
                self.entries[entry] = WANTED
            self._lost(error, now)

    def _lost(self, error: Exception, now: float) -> None:
        self._next = now + self.retry
        if not self.master_lost:
            self.master_lost = True
            self.engine.note(
                "cannot reach the master at %s (%s); waiting for it" % (self.engine.master_uri, error)
            )
        for entry, state in self.entries.items():
            if state == DONE:
                self.entries[entry] = WANTED

    def _found(self, now: float) -> None:
        self.master_lost = False
        self.engine.note("the master at %s answers" % self.engine.master_uri)
        self.engine.master_found(now)
        self._again(now, only_wanted=True)

    def _again(self, now: float, only_wanted: bool = False) -> None:
        for entry, state in list(self.entries.items()):
            if state == WANTED or (state == DONE and not only_wanted):
                self._register(entry, now)
        if not only_wanted:
            self.engine.master_found(now)
        self._next = now + self.check


def _ignore(value: object, error: "Exception | None", now: float) -> None:
    return
