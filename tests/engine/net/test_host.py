"""Hosts on one cable: they find each other, ping, send datagrams of all sizes, join groups, and keep within bounds."""

import pytest

from engine.net.lan import Lan
from roslet.engine.net import arp as neighbours
from roslet.engine.net import reassembly
from roslet.engine.net.events import AddressConflicted, AddressUnanswered, EchoLost, EchoReplied
from roslet.engine.net.host import Host
from roslet.engine.net.limits import Limits
from roslet.wire.net import arp, ethernet, icmp, igmp, ipv4
from roslet.wire.net.arp import Arp
from roslet.wire.net.ethernet import BROADCAST, Frame
from roslet.wire.net.icmp import Echo
from roslet.wire.net.igmp import Igmp
from roslet.wire.net.ipv4 import Packet
from roslet.wire.net.udp import Datagram

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

A_MAC, B_MAC = "02:00:00:00:00:01", "02:00:00:00:00:02"
A_IP, B_IP = "192.168.1.2", "192.168.1.10"
A, B = bytes([192, 168, 1, 2]), bytes([192, 168, 1, 10])
AM, BM = bytes([2, 0, 0, 0, 0, 1]), bytes([2, 0, 0, 0, 0, 2])
GROUP = "239.255.0.1"
GROUP_OCTETS = bytes([239, 255, 0, 1])


def a_host(**fields: "Any") -> Host:
    return Host(A_MAC, A_IP + "/24", **fields)


def two(**fields: "Any") -> "tuple[Host, Host, Lan]":
    one, other = a_host(seed=1), Host(B_MAC, B_IP + "/24", seed=2)
    return one, other, Lan(one, other, **fields)


def known(host: Host) -> Host:
    """A host that knows B already."""
    host.receive_frame(Frame(AM, BM, ethernet.ARP, Arp(arp.REPLY, BM, B, AM, A).emit()).emit(), 0.0)
    return host


def from_b(protocol: int, payload: "bytes | bytearray", destination: bytes = A, **fields: "Any") -> bytes:
    """A frame with an IPv4 packet of B's."""
    packet = Packet(B, destination, protocol, payload, **fields)
    mac = ipv4.multicast_mac(destination) if ipv4.is_multicast(destination) else AM
    return Frame(mac, BM, ethernet.IPV4, packet.emit()).emit()


def test_a_host_says_that_it_is_there() -> None:
    host = a_host()
    host.start(0.0)
    (frame,) = host.frames_to_send(0.0)
    assert frame == (
        b"\xff" * 6 + AM + b"\x08\x06" + b"\0\1\x08\0\6\4\0\1" + AM + A + bytes(6) + A + bytes(18)
    )


def test_a_request_is_answered_and_the_asker_is_known() -> None:
    host = a_host()
    host.receive_frame(b"\xff" * 6 + BM + b"\x08\x06" + b"\0\1\x08\0\6\4\0\1" + BM + B + bytes(6) + A, 0.0)
    (frame,) = host.frames_to_send(0.0)
    assert frame == BM + AM + b"\x08\x06" + b"\0\1\x08\0\6\4\0\2" + AM + A + BM + B + bytes(18)
    assert host.open(5).send(b"x", (B_IP, 6), 0.0)
    assert host.frames_to_send(0.0)[0][:6] == BM
    assert host.counters == {}


def test_who_only_probes_is_answered_and_not_learnt() -> None:
    host = a_host()
    probe = Arp(arp.REQUEST, BM, bytes(4), bytes(6), A)
    host.receive_frame(Frame(BROADCAST, BM, ethernet.ARP, probe.emit()).emit(), 0.0)
    assert len(host.frames_to_send(0.0)) == 1
    assert host.neighbours.known == {}


def test_requests_between_others_are_not_learnt_but_what_is_known_is_renewed() -> None:
    host = a_host()
    between = Frame(
        BROADCAST, BM, ethernet.ARP, Arp(arp.REQUEST, BM, B, bytes(6), bytes([192, 168, 1, 77])).emit()
    ).emit()
    host.receive_frame(between, 0.0)
    assert host.neighbours.known == {} and host.frames_to_send(0.0) == []
    known(host)
    moved = Arp(arp.REQUEST, b"\2\0\0\0\0\x33", B, bytes(6), B)
    host.receive_frame(Frame(BROADCAST, b"\2\0\0\0\0\x33", ethernet.ARP, moved.emit()).emit(), 1.0)
    assert host.neighbours.known[B].mac == b"\2\0\0\0\0\x33"


@pytest.mark.parametrize(
    "message, reason",
    [
        (Arp(arp.REQUEST, b"\3\0\0\0\0\2", B, bytes(6), A), "arp-sender-a-group"),
        (Arp(arp.REQUEST, BM, GROUP_OCTETS, bytes(6), A), "arp-sender-a-group"),
        (Arp(arp.REQUEST, AM, B, bytes(6), A), "arp-from-ourselves"),
        (Arp(arp.REQUEST, BM, bytes([10, 0, 0, 1]), bytes(6), A), "arp-from-another-network"),
        (Arp(arp.REPLY, BM, A, AM, A), "arp-conflict"),
    ],
)
def test_spoofed_arp_is_dropped_with_its_reason(message: Arp, reason: str) -> None:
    host = a_host()
    host.receive_frame(Frame(AM, BM, ethernet.ARP, message.emit()).emit(), 0.0)
    assert host.counters == {reason: 1}
    assert host.neighbours.known == {} and host.frames_to_send(0.0) == []
    assert host.next_event() == (AddressConflicted(B_MAC) if reason == "arp-conflict" else None)


def test_two_hosts_ping_each_other() -> None:
    one, _, lan = two()
    for size in (0, 1, 56, 1472, 1473, 5000, 65507):
        data = bytes([n & 0xFF for n in range(size)])
        sequence = one.ping(B_IP, lan.now, data)
        lan.run(1.0)
        (event,) = lan.events[A_IP]
        lan.events[A_IP].clear()
        assert isinstance(event, EchoReplied)
        assert (event.address, event.sequence, event.data) == (B_IP, sequence, data)
        assert 0.0001 <= event.seconds < 0.01
    assert one.counters == {}


def test_an_echo_that_is_not_answered_is_lost() -> None:
    host = known(a_host())
    sequence = host.ping(B_IP, 1.0)
    assert host.deadline() == 0.0, "a frame is to be sent"
    assert len(host.frames_to_send(1.0)) == 1 and host.deadline() == 6.0
    host.handle_deadline(6.0)
    assert host.next_event() == EchoLost(B_IP, sequence)
    assert host.deadline() is None


def test_a_reply_that_nobody_asked_for_is_dropped() -> None:
    host = known(a_host())
    host.receive_frame(from_b(ipv4.ICMP, Echo(icmp.ECHO_REPLY, 1, 1).emit()), 0.0)
    assert host.counters == {"icmp-reply-unasked": 1}
    host.receive_frame(from_b(ipv4.ICMP, Echo(icmp.ECHO_REQUEST, 1, 1).emit(), igmp.ALL_HOSTS), 0.0)
    assert host.counters["icmp-to-a-group"] == 1
    assert host.frames_to_send(0.0) == []


def test_an_address_that_nobody_has_is_asked_for_three_times_and_given_up() -> None:
    host = a_host()
    endpoint = host.open(5)
    assert endpoint.send(b"x", ("192.168.1.77", 5), 0.0)
    assert endpoint.send(b"y", ("192.168.1.77", 5), 0.5)
    asked = len(host.frames_to_send(0.5))
    for now in (1.0, 2.0):
        assert host.deadline() == now
        host.handle_deadline(now)
        asked += len(host.frames_to_send(now))
    host.handle_deadline(3.0)
    assert asked == neighbours.TRIES and host.frames_to_send(3.0) == []
    assert host.next_event() == AddressUnanswered("192.168.1.77")
    assert host.counters == {"arp-unanswered": 2} and host.neighbours.known == {}


def test_what_waits_for_an_address_goes_out_in_order_when_it_is_known() -> None:
    host = a_host(limits=Limits(waiting=2))
    endpoint = host.open(5)
    for data in (b"1", b"2", b"3"):
        endpoint.send(data, (B_IP, 6), 0.0)
    host.frames_to_send(0.0)
    known(host)
    frames = host.frames_to_send(0.0)
    assert [frame[42:43] for frame in frames] == [b"1", b"2"]
    assert host.counters == {"arp-waiting-full": 1}


def test_an_address_is_asked_for_again_after_its_lifetime() -> None:
    host = known(a_host())
    endpoint = host.open(5)
    endpoint.send(b"x", (B_IP, 6), neighbours.LIFETIME - 1)
    assert host.frames_to_send(0.0)[0][12:14] == b"\x08\0"
    endpoint.send(b"x", (B_IP, 6), neighbours.LIFETIME + 1)
    assert [frame[12:14] for frame in host.frames_to_send(0.0)] == [b"\x08\x06"]


def test_a_flood_of_arp_takes_no_more_than_its_bound() -> None:
    host = a_host(limits=Limits(neighbours=8))
    for n in range(100):
        ip = bytes([192, 168, 1, 100 + n % 100])
        mac = b"\2\1\0\0\0" + bytes([n])
        host.receive_frame(
            Frame(BROADCAST, mac, ethernet.ARP, Arp(arp.REQUEST, mac, ip, bytes(6), A).emit()).emit(), n
        )
    assert len(host.neighbours.known) == 8
    assert host.counters == {"neighbours-full": 92}


def test_datagrams_of_all_sizes_arrive_whole() -> None:
    one, other, lan = two()
    here, there = one.open(1000), other.open(2000)
    for size in (0, 1, 17, 18, 1472, 1473, 2960, 65507):
        data = bytes([(n * 7) & 0xFF for n in range(size)])
        assert here.send(data, (B_IP, 2000), lan.now)
        lan.run(0.1)
        assert there.receive() == (data, (A_IP, 1000))
        assert there.receive() is None
    assert one.counters == {} and other.counters == {}


def test_large_datagrams_arrive_in_spite_of_duplication_and_disorder() -> None:
    one, other, lan = two(seed=5, twice=0.3)
    here, there = one.open(1000), other.open(2000)
    for _ in range(20):
        here.send(bytes(9000), (B_IP, 2000), lan.now)
        lan.run(1.0)
        got = there.receive()
        assert got is not None and got[0] == bytes(9000)
    assert other.counters["fragment-repeated"] > 10


def test_loss_leaves_nothing_behind() -> None:
    one, other, lan = two(seed=3, loss=0.2)
    here, there = one.open(1000), other.open(2000)
    arrived = 0
    for _ in range(40):
        here.send(bytes(4000), (B_IP, 2000), lan.now)
        lan.run(1.0)
        arrived += there.receive() is not None
    lan.run(reassembly.TIMEOUT + 1)
    assert 5 < arrived < 35
    assert other.reassembly.pending == {}
    assert other.counters["assembly-expired"] + other.counters.get("assemblies-full", 0) > 5


def test_a_datagram_to_a_port_that_is_closed_is_counted() -> None:
    host = a_host()
    host.receive_frame(from_b(ipv4.UDP, Datagram(1, 2, b"x").emit(B, A)), 0.0)
    assert host.counters == {"udp-port-closed": 1}


def test_an_endpoint_holds_no_more_than_its_bounds() -> None:
    for limits, reason in (
        (Limits(datagrams=3), "datagrams-full"),
        (Limits(received_bytes=31), "received-bytes-full"),
    ):
        host = a_host(limits=limits)
        endpoint = host.open(2)
        for _ in range(5):
            host.receive_frame(from_b(ipv4.UDP, Datagram(1, 2, bytes(10)).emit(B, A)), 0.0)
        assert host.counters == {reason: 2}
        while endpoint.receive():
            pass
        host.receive_frame(from_b(ipv4.UDP, Datagram(1, 2, bytes(10)).emit(B, A)), 0.0)
        assert endpoint.receive() is not None


def test_a_group_reaches_who_joined_and_nobody_else() -> None:
    one, other, lan = two()
    here, member, stranger = one.open(7400), other.open(7400), other.open(7401)
    member.join(GROUP, lan.now)
    lan.run(0.1)
    here.send(b"hello", (GROUP, 7400), lan.now)
    here.send(b"hello", (GROUP, 7401), lan.now)
    lan.run(0.1)
    assert member.receive() == (b"hello", (A_IP, 7400))
    assert stranger.receive() is None
    assert other.counters == {"udp-port-closed": 1}
    frame = next(one for one in lan.seen if one[:6] == b"\x01\x00\x5e\x7f\x00\x01" and one[23] == 17)
    assert frame[22] == 1, "multicast stays on the network"
    member.leave(GROUP)
    here.send(b"hello", (GROUP, 7400), lan.now)
    lan.run(0.1)
    assert member.receive() is None
    assert other.counters["ethernet-not-for-us"] == 1


def test_datagrams_to_the_host_itself_make_no_frame() -> None:
    host = a_host()
    here, there = host.open(5), host.open(6)
    here.send(b"x", (A_IP, 6), 0.0)
    assert there.receive() == (b"x", (A_IP, 5))
    there.join(GROUP, 0.0)
    here.join(GROUP, 0.0)
    host.frames_to_send(0.0)
    here.send(b"y", (GROUP, 6), 0.0)
    assert there.receive() == (b"y", (A_IP, 5))
    assert len(host.frames_to_send(0.0)) == 1


def test_broadcasts_reach_everybody() -> None:
    one, other, lan = two()
    here, there = one.open(5), other.open(6)
    for address in ("255.255.255.255", "192.168.1.255"):
        here.send(b"x", (address, 6), lan.now)
        lan.run(0.1)
        assert there.receive() == (b"x", (A_IP, 5))


def test_other_networks_are_reached_by_the_gateway_or_not_at_all() -> None:
    host = a_host()
    assert not host.open(5).send(b"x", ("10.0.0.1", 5), 0.0)
    assert host.counters == {"no-way": 1} and host.frames_to_send(0.0) == []
    host = known(Host(A_MAC, A_IP + "/24", gateway=B_IP))
    assert host.open(5).send(b"x", ("10.0.0.1", 5), 0.0)
    (frame,) = host.frames_to_send(0.0)
    assert frame[:6] == BM and frame[30:34] == bytes([10, 0, 0, 1])


def test_a_member_reports_twice_and_leaves_if_it_was_the_last_to_report() -> None:
    host = a_host()
    endpoint = host.open(5)
    endpoint.join(GROUP, 0.0)
    (frame,) = host.frames_to_send(0.0)
    # 46 c0: an option, and IPv4 as of RFC 2113; 16 00 09fe efff0001 as by hand in tests/wire/net.
    assert frame[:14] == b"\x01\x00\x5e\x7f\x00\x01" + AM + b"\x08\x00"
    assert frame[14] == 0x46 and frame[22:24] == b"\x01\x02" and frame[34:38] == b"\x94\4\0\0"
    assert frame[30:34] == GROUP_OCTETS and frame[38:46] == b"\x16\0\xf9\xfe\xef\xff\0\1"
    due = host.deadline()
    assert due is not None and 0 <= due <= 10.0
    host.handle_deadline(due)
    assert len(host.frames_to_send(due)) == 1 and host.deadline() is None
    endpoint.leave(GROUP)
    (frame,) = host.frames_to_send(due)
    assert frame[30:34] == b"\xe0\0\0\2" and frame[38] == 0x17


def test_queries_are_answered_in_time_and_the_reports_of_others_spare_us_ours() -> None:
    host = a_host()
    host.open(5).join(GROUP, 0.0)
    host.handle_deadline(10.0)
    host.frames_to_send(10.0)
    for group, longest in ((bytes(4), 0), (bytes(4), 100), (GROUP_OCTETS, 10)):
        to = igmp.ALL_HOSTS if group == bytes(4) else group
        host.receive_frame(from_b(ipv4.IGMP, Igmp(igmp.QUERY, longest, group).emit(), to), 20.0)
        due = host.deadline()
        assert due is not None and 20.0 <= due <= 20.0 + (longest or 100) / 10
    host.receive_frame(from_b(ipv4.IGMP, Igmp(igmp.REPORT, 0, GROUP_OCTETS).emit(), GROUP_OCTETS), 20.0)
    assert host.deadline() is None and host.frames_to_send(20.0) == []
    other = Igmp(igmp.QUERY, 100, bytes([239, 1, 1, 1]))
    host.receive_frame(from_b(ipv4.IGMP, other.emit(), igmp.ALL_HOSTS), 20.0)
    assert host.deadline() is None
    host.receive_frame(from_b(ipv4.IGMP, Igmp(0x22, 0, bytes(4)).emit(), igmp.ALL_HOSTS), 20.0)
    assert host.counters == {"igmp-type-unknown": 1}


def test_a_group_is_left_when_the_last_of_its_endpoints_leaves() -> None:
    host = a_host()
    one, other = host.open(5), host.open(6)
    one.join(GROUP, 0.0)
    other.join(GROUP, 0.0)
    one.join(GROUP, 0.0)
    assert len(host.frames_to_send(0.0)) == 1
    one.close()
    one.close()
    assert host.groups.has(GROUP_OCTETS)
    other.close()
    assert not host.groups.has(GROUP_OCTETS)
    assert host.open(5) is not one


@pytest.mark.parametrize(
    "frame, reason",
    [
        (b"", "ethernet-truncated"),
        (AM + BM + b"\0\x2e" + bytes(46), "ethernet-without-type"),
        (AM + BM + b"\x86\xdd" + bytes(46), "ethernet-type-unknown"),
        (BM + AM + b"\x08\0" + bytes(46), "ethernet-not-for-us"),
        (b"\x01\x00\x5e\x01\x01\x01" + BM + b"\x08\0" + bytes(46), "ethernet-not-for-us"),
        (AM + b"\x01\0\0\0\0\1" + b"\x08\0" + bytes(46), "ethernet-source-a-group"),
        (AM + BM + b"\x08\0" + b"\x45" + bytes(10), "ipv4-truncated"),
        (AM + BM + b"\x08\0" + bytes(46), "ipv4-version"),
        (from_b(99, b""), "ipv4-protocol-unknown"),
        (from_b(17, b"", bytes([192, 168, 1, 3])), "ipv4-not-for-us"),
        (from_b(1, bytes(7)), "icmp-truncated"),
        (from_b(2, bytes(7)), "igmp-truncated"),
        (from_b(17, bytes(7)), "udp-truncated"),
    ],
)
def test_what_is_wrong_is_counted_by_its_reason(frame: bytes, reason: str) -> None:
    host = a_host()
    host.receive_frame(frame, 0.0)
    assert host.counters == {reason: 1}
    assert host.frames_to_send(0.0) == [] and host.next_event() is None


def test_a_packet_from_many_is_dropped() -> None:
    for source in (GROUP_OCTETS, b"\xff" * 4, bytes([192, 168, 1, 255])):
        host = a_host()
        packet = Packet(source, A, 17, Datagram(1, 2, b"").emit(source, A))
        host.receive_frame(Frame(AM, BM, ethernet.IPV4, packet.emit()).emit(), 0.0)
        assert host.counters == {"ipv4-source-a-group": 1}


def test_what_waits_for_its_owner_and_for_the_wire_is_bounded() -> None:
    host = known(a_host(limits=Limits(frames=3, events=2)))
    for _ in range(5):
        host.ping(B_IP, 0.0)
    assert len(host.frames_to_send(0.0)) == 3 and host.counters == {"frames-full": 2}
    host.handle_deadline(10.0)
    assert host.counters["events-full"] == 3


def test_local_misuse_raises_a_sentence() -> None:
    host = a_host(limits=Limits(endpoints=2, groups=1, echoes=1))
    endpoint = host.open(5)
    with pytest.raises(ValueError, match="port 5 is taken"):
        host.open(5)
    with pytest.raises(ValueError, match="no port is 65536"):
        host.open(65536)
    with pytest.raises(ValueError, match="no datagram goes to port 0"):
        endpoint.send(b"", (B_IP, 0), 0.0)
    with pytest.raises(ValueError, match="at most 65507 octets, not 65508"):
        endpoint.send(bytes(65508), (B_IP, 1), 0.0)
    with pytest.raises(ValueError, match="no IPv4 address"):
        endpoint.send(b"", ("localhost", 1), 0.0)
    with pytest.raises(ValueError, match="is no multicast group"):
        endpoint.join(B_IP, 0.0)
    endpoint.join(GROUP, 0.0)
    with pytest.raises(ValueError, match="more than 1 groups"):
        endpoint.join("239.255.0.2", 0.0)
    host.open()
    with pytest.raises(ValueError, match="more than 2 ports"):
        host.open()
    for address in (GROUP, "255.255.255.255", "192.168.1.255", "0.0.0.0"):
        with pytest.raises(ValueError, match="not the address of one host"):
            host.ping(address, 0.0)
    with pytest.raises(ValueError, match="an echo holds at most 65507 octets"):
        host.ping(B_IP, 0.0, bytes(65508))
    host.ping(B_IP, 0.0)
    with pytest.raises(ValueError, match="more than 1 echoes under way"):
        host.ping(B_IP, 0.0)
    endpoint.close()
    with pytest.raises(ValueError, match="port 5 is closed"):
        endpoint.send(b"", (B_IP, 1), 0.0)
    for mac, address, fields in (
        ("03:00:00:00:00:01", A_IP, {}),
        (A_MAC, A_IP + "/31", {}),
        (A_MAC, A_IP, {"mtu": 67}),
        (A_MAC, A_IP, {"gateway": "10.0.0.1"}),
    ):
        with pytest.raises(ValueError):
            Host(mac, address, **fields)
    with pytest.raises(ValueError, match="frames must be at least 1"):
        Limits(frames=0)


def test_free_ports_differ_from_each_other() -> None:
    host = a_host()
    ports = [host.open().port for _ in range(40)]
    assert len(set(ports)) == 40 and min(ports) >= 49152 and max(ports) <= 65535
