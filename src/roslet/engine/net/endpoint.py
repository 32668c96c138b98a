"""One UDP port of a host: what a socket is elsewhere."""

from roslet.wire.net import ipv4

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.net.ip_host import IpHost

    Address = tuple[str, int]


class Endpoint:
    """Made by `IpHost.open`. Addresses are (host, port) with the host as text, as those of sockets are."""

    def __init__(self, host: "IpHost", port: int) -> None:
        self.port = port
        self.groups: list[bytes] = []
        self.closed = False
        self._host = host
        self._received: list[tuple[bytes, Address]] = []
        self._bytes = 0

    @property
    def address(self) -> "Address":
        """What others reach it by."""
        return self._host.address, self.port

    def send(self, data: "bytes | bytearray | memoryview", address: "Address", now: float) -> bool:
        """One datagram to an address of IPv4; whether it could be sent, or waits for a hardware address.

        Raises ValueError for what is no address, or more than a datagram holds, and where the endpoint is closed.
        """
        if self.closed:
            raise ValueError("the endpoint of port %d is closed" % self.port)
        return self._host.send_datagram(self, data, ipv4.octets_of(address[0]), address[1], now)

    @property
    def pending(self) -> bool:
        """Whether `receive` has something."""
        return bool(self._received)

    def receive(self) -> "tuple[bytes, Address] | None":
        """The oldest datagram that came, and where it is from."""
        if not self._received:
            return None
        found = self._received.pop(0)
        self._bytes -= len(found[0])
        return found

    def join(self, group: str, now: float) -> None:
        """Take what is sent to a multicast group too. Raises ValueError where it is none, or one too many."""
        octets = ipv4.octets_of(group)
        if octets not in self.groups:
            self._host.join(octets, now)
            self.groups.append(octets)

    def leave(self, group: str) -> None:
        """No longer."""
        octets = ipv4.octets_of(group)
        if octets in self.groups:
            self.groups.remove(octets)
            self._host.leave(octets)

    def close(self) -> None:
        """Give the port back. Closing twice is allowed."""
        if not self.closed:
            self.closed = True
            for group in self.groups:
                self._host.leave(group)
            self.groups = []
            self._host.forget(self)

    def deliver(self, data: bytes, source: "Address") -> str:
        """What the host does; the reason why it was dropped, or nothing."""
        limits = self._host.limits
        if len(self._received) >= limits.datagrams:
            return "datagrams-full"
        if self._bytes + len(data) > limits.received_bytes:
            return "received-bytes-full"
        self._received.append((data, source))
        self._bytes += len(data)
        return ""
