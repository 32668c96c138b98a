"""A software host on an Ethernet: what a runtime, or a simulated wire, drives frame by frame."""

from roslet.engine.net import events
from roslet.engine.net.arp import Neighbours
from roslet.engine.net.ip_host import ALL_BROADCAST, NO_ADDRESS, IpHost
from roslet.errors import ProtocolError
from roslet.wire.net import arp, ethernet, igmp, ipv4
from roslet.wire.net.arp import Arp
from roslet.wire.net.ethernet import BROADCAST, Frame

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.net.limits import Limits


class Host(IpHost):
    """One host with one address.

    mac        its hardware address, such as "02:00:00:00:00:01"
    gateway    where everything goes that is not for its network; without one it is dropped
    the others as `IpHost` has them
    """

    def __init__(
        self,
        mac: str,
        address: str,
        gateway: str = "",
        seed: int = 0,
        mtu: int = ethernet.MTU,
        limits: "Limits | None" = None,
    ) -> None:
        super().__init__(address, seed, mtu, limits)
        self.mac = ethernet.octets_of(mac)
        if ethernet.is_group(self.mac):
            raise ValueError("a host cannot have the group address %s" % mac)
        self._gateway = ipv4.octets_of(gateway) if gateway else b""
        if self._gateway and not self._near(self._gateway):
            raise ValueError("the gateway %s is not in the network of %s" % (gateway, address))
        self.neighbours = Neighbours(
            self.mac, self.ip, self.limits, self._send_arp, self._send_ipv4, self.count, self._unanswered
        )

    # -- what a runtime does

    def start(self, now: float) -> None:
        """Say that we are here."""
        self.neighbours.announce()

    def receive_frame(self, data: "bytes | bytearray | memoryview", now: float) -> None:
        """Take one frame, without its FCS. Never raises; what is wrong, or not for us, is counted by reason."""
        try:
            frame = ethernet.parse(memoryview(data))
            group = ethernet.is_group(frame.destination)
            if frame.destination != self.mac and not (group and self._wanted(frame.destination)):
                self.count("ethernet-not-for-us")
            elif ethernet.is_group(frame.source):
                self.count("ethernet-source-a-group")
            elif frame.kind == ethernet.IPV4:
                self._receive_ipv4(ipv4.parse(frame.payload), now)
            elif frame.kind == ethernet.ARP:
                self._receive_arp(arp.parse(frame.payload), now)
            else:
                self.count("ethernet-type-unknown")
        except ProtocolError as error:
            self.count(error.reason)

    def deadline(self) -> "float | None":
        """When `frames_to_send` has something, or `handle_deadline` something to do."""
        times = [super().deadline(), self.neighbours.deadline()]
        due = [at for at in times if at is not None]
        return min(due) if due else None

    def handle_deadline(self, now: float) -> None:
        """Do what is due."""
        self.neighbours.handle_deadline(now)
        super().handle_deadline(now)

    # -- receiving

    def _wanted(self, mac: bytes) -> bool:
        """Whether a group address of Ethernet may hold what is for us."""
        if mac == BROADCAST or mac == ipv4.multicast_mac(igmp.ALL_HOSTS):
            return True
        return mac in [ipv4.multicast_mac(group) for group in self.groups.joined]

    def _receive_arp(self, message: Arp, now: float) -> None:
        if ethernet.is_group(message.sender_mac) or ipv4.is_multicast(message.sender_ip):
            self.count("arp-sender-a-group")
        elif message.sender_mac == self.mac:
            self.count("arp-from-ourselves")
        elif message.sender_ip == self.ip:
            self.count("arp-conflict")
            self._tell(events.AddressConflicted(ethernet.text_of(message.sender_mac)))
        elif message.sender_ip != NO_ADDRESS and not self._near(message.sender_ip):
            self.count("arp-from-another-network")
        else:
            self.neighbours.receive(message, now)

    # -- sending

    def _link(self, destination: bytes, packets: "list[bytes]", now: float) -> bool:
        if destination in (ALL_BROADCAST, self._broadcast):
            for packet in packets:
                self._send_ipv4(BROADCAST, packet)
            return True
        hop = destination if self._near(destination) else self._gateway
        if not hop or hop == self.ip:
            self.count("no-way")
            return False
        for packet in packets:
            self.neighbours.send(hop, packet, now)
        return True

    def _link_to_group(self, group: bytes, packet: bytes) -> None:
        self._send_ipv4(ipv4.multicast_mac(group), packet)

    def _send_ipv4(self, mac: bytes, packet: bytes) -> None:
        self._put(Frame(mac, self.mac, ethernet.IPV4, packet).emit())

    def _send_arp(self, mac: bytes, message: Arp) -> None:
        self._put(Frame(mac, self.mac, ethernet.ARP, message.emit()).emit())

    def _unanswered(self, ip: bytes) -> None:
        self._tell(events.AddressUnanswered(ipv4.text_of(ip)))
