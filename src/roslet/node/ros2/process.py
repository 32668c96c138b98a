"""What the nodes of a process share on one ROS 2 network: the participant, and each other's topics and services.

Samples between them take a way of their own (see `topics`, `services`): the participant matches only with others.
"""

from __future__ import annotations

from roslet.io.ros2 import Ros2Shell

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.io.select import Reactor
    from roslet.names import Ros2Network as Settings
    from roslet.node.ros2.services import Ros2Client, Ros2Service
    from roslet.node.ros2.topics import Ros2Publisher, Ros2Subscription

_processes: dict[tuple[int, str, str], Process] = {}


class Process:
    """Get one by `join`; `leave` it as often as joined, and the last one closes it."""

    def __init__(self, key: tuple[int, str, str], shell: Ros2Shell) -> None:
        self.shell = shell
        self.users = 0
        self.publishers: dict[str, list[Ros2Publisher]] = {}
        self.subscriptions: dict[str, list[Ros2Subscription]] = {}
        self.services: dict[str, list[Ros2Service]] = {}
        self.clients: dict[str, list[Ros2Client]] = {}
        self._key = key

    def leave(self) -> None:
        """Undo one `join`."""
        with self.shell.reactor.lock:
            self.users -= 1
            if self.users:
                return
            _processes.pop(self._key, None)
        self.shell.close()

    def abandon(self) -> None:
        """In a forked child: it is the parent's. Doing it twice is allowed."""
        if _processes.pop(self._key, None) is not None:
            self.shell.abandon()


def join(reactor: Reactor, settings: Settings, enclave: str, warn: Callable[[str], None]) -> Process:
    """What there is for this network and enclave, or a new one, of which `warn` hears what goes wrong behind the scenes.
    Raises Unreachable."""
    key = (id(reactor), settings.url, enclave)
    with reactor.lock:
        process = _processes.get(key)
        if process is None:
            process = _processes[key] = Process(key, Ros2Shell(reactor, settings, enclave, warn))
        process.users += 1
        return process
