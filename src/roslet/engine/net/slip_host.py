"""A software host at one end of a serial line: what a runtime drives octet by octet. RFC 1055."""

from roslet.engine.net.ip_host import IpHost
from roslet.errors import ProtocolError
from roslet.wire.net import ethernet, ipv4, slip

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.net.limits import Limits
    from roslet.wire.net.igmp import Igmp


class SlipHost(IpHost):
    """One host with one address, and on the line another. Everything goes to that one, whatever its address.

    A frame is an IP packet. A runtime gives octets of the line to `receive_data` and takes them from `data_to_send`, or
    whole packets to `receive_frame` and from `frames_to_send`. No IGMP is spoken: there is no switch that would listen.

    The line is slow: of what `limits.frames` lets wait, the octets should not take longer than others believe in us.
    """

    def __init__(
        self, address: str, seed: int = 0, mtu: int = ethernet.MTU, limits: "Limits | None" = None
    ) -> None:
        super().__init__(address, seed, mtu, limits)
        self._decoder = slip.Decoder(mtu, self.count)

    def start(self, now: float) -> None:
        """Nobody on the line has to be told that we are here."""

    def receive_data(self, data: "bytes | bytearray | memoryview", now: float) -> None:
        """Take octets of the line. Never raises; what is wrong, or not for us, is counted by reason."""
        for packet in self._decoder.receive_data(data):
            self.receive_frame(packet, now)

    def data_to_send(self, now: float) -> bytes:
        """Octets for the line, of all packets that are to be sent now."""
        return b"".join([slip.emit(packet) for packet in self.frames_to_send(now)])

    def receive_frame(self, data: "bytes | bytearray | memoryview", now: float) -> None:
        """Take one packet. Never raises; what is wrong, or not for us, is counted by reason."""
        try:
            self._receive_ipv4(ipv4.parse(memoryview(data)), now)
        except ProtocolError as error:
            self.count(error.reason)

    def _link(self, destination: bytes, packets: "list[bytes]", now: float) -> bool:
        for packet in packets:
            self._put(packet)
        return True

    def _link_to_group(self, group: bytes, packet: bytes) -> None:
        self._put(packet)

    def _send_igmp(self, destination: bytes, message: "Igmp") -> None:
        """Not here."""
