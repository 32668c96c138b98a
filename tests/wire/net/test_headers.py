"""Every header against octets written by hand from its RFC, and what is wrong against its named reason."""

import pytest

from roslet.errors import ProtocolError
from roslet.wire.net import arp, checksum, ethernet, icmp, igmp, ipv4, udp
from roslet.wire.net.arp import Arp
from roslet.wire.net.ethernet import Frame
from roslet.wire.net.icmp import Echo
from roslet.wire.net.igmp import Igmp
from roslet.wire.net.ipv4 import Packet
from roslet.wire.net.udp import Datagram

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


def octets(text: str) -> bytes:
    digits = "".join(text.split())
    return bytes([int(digits[at : at + 2], 16) for at in range(0, len(digits), 2)])


A_MAC, B_MAC = octets("020000000001"), octets("020000000002")
A, B = octets("c0a80102"), octets("c0a8010a")

ARP_REQUEST = octets("0001 0800 06 04 0001  020000000001 c0a80102  000000000000 c0a8010a")
# The header of a datagram from 192.168.1.2 to 192.168.1.10, with the sum worked out by hand:
# 4500+0021+1234+0000+4011+0000+c0a8+0102+c0a8+010a = 21ac2, 1ac4; complement e53b
UDP_PACKET = octets("45 00 0021 1234 0000 40 11 e53b c0a80102 c0a8010a") + octets(
    # c0a8+0102+c0a8+010a+0011+000d + 04d2+162e+000d + 6865+6c6c+6f00 = 2e258, e25a; complement 1da5
    "04d2 162e 000d 1da5 6865 6c6c 6f"
)


def sum_by_hand(data: bytes) -> int:
    """RFC 1071, word by word."""
    if len(data) & 1:
        data += b"\0"
    total = 0
    for at in range(0, len(data), 2):
        total += data[at] << 8 | data[at + 1]
        total = (total & 0xFFFF) + (total >> 16)
    return total


def reason(function: "Any", *arguments: "Any") -> str:
    with pytest.raises(ProtocolError) as raised:
        function(*arguments)
    found: str = raised.value.reason
    return found


def test_the_sum_of_rfc_1071_comes_out() -> None:
    assert checksum.total(octets("0001f203f4f5f6f7")) == 0xDDF2
    assert checksum.checksum(octets("0001f203f4f5f6f7")) == 0x220D


@pytest.mark.parametrize("size", [0, 1, 2, 3, 20, 999, 1500])
def test_the_sum_is_that_of_the_words_one_by_one(size: int) -> None:
    for fill in (0, 1, 0x80, 0xFF):
        data = bytes([(n * 7 + fill) & 0xFF if fill not in (0, 0xFF) else fill for n in range(size)])
        assert checksum.total(data) == sum_by_hand(data), fill


def test_a_sum_of_nothing_but_zeros_stays_zero_and_others_end_at_ffff() -> None:
    assert checksum.total(bytes(40)) == 0
    assert checksum.total(octets("ffff")) == 0xFFFF
    assert checksum.total(octets("8000 7fff")) == 0xFFFF
    assert checksum.total(b"", 0xFFFF) == 0xFFFF


def test_a_frame_is_padded_to_60_octets() -> None:
    frame = Frame(ethernet.BROADCAST, A_MAC, ethernet.ARP, ARP_REQUEST).emit()
    assert frame == octets("ffffffffffff 020000000001 0806") + ARP_REQUEST + bytes(18)
    assert len(Frame(B_MAC, A_MAC, 0x0800, bytes(46)).emit()) == 60
    assert len(Frame(B_MAC, A_MAC, 0x0800, bytes(47)).emit()) == 61


def test_a_frame_is_read_with_its_padding() -> None:
    frame = ethernet.parse(octets("ffffffffffff 020000000001 0806 0102"))
    assert frame == Frame(ethernet.BROADCAST, A_MAC, ethernet.ARP, b"\1\2")
    assert reason(ethernet.parse, bytes(13)) == "ethernet-truncated"
    assert reason(ethernet.parse, bytes(12) + octets("05ff")) == "ethernet-without-type"
    assert ethernet.parse(bytes(12) + octets("0600")).kind == 0x600


def test_a_group_address_has_the_first_bit_set() -> None:
    assert ethernet.is_group(ethernet.BROADCAST)
    assert ethernet.is_group(octets("01005e000001"))
    assert not ethernet.is_group(A_MAC)


def test_arp_is_written_and_read() -> None:
    value = Arp(arp.REQUEST, A_MAC, A, bytes(6), B)
    assert bytes(value.emit()) == ARP_REQUEST
    assert arp.parse(ARP_REQUEST + bytes(18)) == value


def test_arp_that_is_wrong_has_a_reason() -> None:
    for size in range(28):
        assert reason(arp.parse, ARP_REQUEST[:size]) == "arp-truncated"
    for at in (0, 1, 2, 3, 4, 5):
        broken = bytearray(ARP_REQUEST)
        broken[at] ^= 1
        assert reason(arp.parse, broken) == "arp-not-ipv4", at
    assert reason(arp.parse, ARP_REQUEST[:7] + b"\3" + ARP_REQUEST[8:]) == "arp-operation-unknown"


def test_an_ipv4_header_is_written_and_read() -> None:
    packet = Packet(A, B, ipv4.UDP, UDP_PACKET[20:], 0x1234)
    assert bytes(packet.emit()) == UDP_PACKET
    assert ipv4.parse(UDP_PACKET) == packet
    assert ipv4.parse(UDP_PACKET + b"padding") == packet


def test_options_are_skipped_and_kept() -> None:
    front = octets("46 00 001c 0000 4000 01 02 0000 c0a80102 e0000001 94040000")
    value = sum_by_hand(front) ^ 0xFFFF
    expected = front[:10] + bytes([value >> 8, value & 0xFF]) + front[12:] + b"data"
    packet = Packet(A, octets("e0000001"), 2, b"data", ttl=1, dont_fragment=True, options=octets("94040000"))
    assert bytes(packet.emit()) == expected
    assert ipv4.parse(expected) == packet


def test_ipv4_that_is_wrong_has_a_reason() -> None:
    def changed(**at: int) -> bytes:
        """The header with octets changed, and its sum made right."""
        found = bytearray(UDP_PACKET)
        for name in at:
            found[int(name[1:])] = at[name]
        found[10] = found[11] = 0
        value = sum_by_hand(bytes(found[: (found[0] & 15) * 4])) ^ 0xFFFF
        found[10], found[11] = value >> 8, value & 0xFF
        return bytes(found)

    assert ipv4.parse(changed()) == ipv4.parse(UDP_PACKET)
    for size in range(20):
        assert reason(ipv4.parse, UDP_PACKET[:size]) == "ipv4-truncated"
    for size in range(20, 33):
        assert reason(ipv4.parse, UDP_PACKET[:size]) == "ipv4-total-length"
    assert reason(ipv4.parse, changed(_0=0x65)) == "ipv4-version"
    for words in range(5):
        assert reason(ipv4.parse, changed(_0=0x40 | words)) == "ipv4-header-length"
    assert reason(ipv4.parse, changed(_0=0x4F)) == "ipv4-total-length"
    assert reason(ipv4.parse, changed(_2=0, _3=19)) == "ipv4-total-length"
    assert reason(ipv4.parse, changed(_6=0x20)) == "ipv4-fragment-length"
    assert reason(ipv4.parse, changed(_6=0x20, _3=20)) == "ipv4-fragment-length"
    assert reason(ipv4.parse, changed(_6=0x1F, _7=0xFF)) == "ipv4-fragment-beyond-end"
    for at in range(160):
        broken = bytearray(UDP_PACKET)
        broken[at >> 3] ^= 1 << (at & 7)
        if at >> 3 in (0, 2, 3):
            reason(ipv4.parse, broken)
        else:
            assert reason(ipv4.parse, broken) == "ipv4-checksum", at


def test_what_no_header_can_say_is_a_value_error() -> None:
    for packet in (
        Packet(A, B, 17, bytes(65516)),
        Packet(A, B, 17, b"", options=bytes(3)),
        Packet(A, B, 17, b"", options=bytes(44)),
        Packet(A, B, 17, b"", offset=4),
        Packet(A, B, 17, b"", offset=65536),
    ):
        with pytest.raises(ValueError):
            packet.emit()


def test_fragments_hold_everything_once_in_multiples_of_eight() -> None:
    payload = bytes([n & 0xFF for n in range(4000)])
    packet = Packet(A, B, 17, payload, 7)
    parts = ipv4.fragments(packet, 1500)
    assert [(part.offset, len(part.payload), part.more) for part in parts] == [
        (0, 1480, True),
        (1480, 1480, True),
        (2960, 1040, False),
    ]
    assert b"".join([bytes(part.payload) for part in parts]) == payload
    assert [ipv4.parse(part.emit()).offset for part in parts] == [0, 1480, 2960]
    assert ipv4.fragments(packet, 4020) == [packet]
    assert not packet.is_fragment and parts[0].is_fragment and parts[2].is_fragment


def test_a_fragment_is_divided_again_in_its_place() -> None:
    part = Packet(A, B, 17, bytes(64), 7, offset=800, more=True)
    again = ipv4.fragments(part, 60)
    assert [(one.offset, len(one.payload), one.more) for one in again] == [(800, 40, True), (840, 24, True)]


def test_what_may_not_be_divided_is_a_value_error() -> None:
    for packet, mtu in (
        (Packet(A, B, 17, bytes(100), dont_fragment=True), 100),
        (Packet(A, B, 17, bytes(100), options=bytes(4)), 100),
        (Packet(A, B, 17, bytes(100)), 27),
    ):
        with pytest.raises(ValueError):
            ipv4.fragments(packet, mtu)


def test_a_udp_datagram_is_written_and_read() -> None:
    data = UDP_PACKET[20:]
    assert bytes(Datagram(1234, 5678, b"hello").emit(A, B)) == data
    assert udp.parse(data + b"\0\0", A, B) == Datagram(1234, 5678, b"hello")
    without = data[:6] + b"\0\0" + data[8:]
    assert udp.parse(without, A, B) == Datagram(1234, 5678, b"hello")


def test_a_sum_of_zero_is_sent_as_ffff() -> None:
    # ports 0, length 10 and the payload make the complement of the pseudo header and the rest
    front = sum_by_hand(A + B + octets("0011 000a") + octets("0000 0000 000a"))
    payload = bytes([(front ^ 0xFFFF) >> 8, (front ^ 0xFFFF) & 0xFF])
    data = bytes(Datagram(0, 0, payload).emit(A, B))
    assert data[6:8] == b"\xff\xff"
    assert udp.parse(data, A, B).payload == payload


def test_udp_that_is_wrong_has_a_reason() -> None:
    data = UDP_PACKET[20:]
    for size in range(8):
        assert reason(udp.parse, data[:size], A, B) == "udp-truncated"
    for size in range(8, len(data)):
        assert reason(udp.parse, data[:size], A, B) == "udp-length"
    assert reason(udp.parse, data[:4] + octets("0007") + data[6:], A, B) == "udp-length"
    assert reason(udp.parse, data, A, A) == "udp-checksum"
    for at in range(8 * len(data)):
        broken = bytearray(data)
        broken[at >> 3] ^= 1 << (at & 7)
        if at >> 3 not in (4, 5):
            assert reason(udp.parse, broken, A, B) == "udp-checksum", at


def test_an_echo_is_written_and_read() -> None:
    # 0800+1234+0001+6162 = 7b97; complement 8468
    data = octets("08 00 8468 1234 0001 6162")
    assert bytes(Echo(icmp.ECHO_REQUEST, 0x1234, 1, b"ab").emit()) == data
    assert icmp.parse(data) == Echo(icmp.ECHO_REQUEST, 0x1234, 1, b"ab")


def test_icmp_that_is_wrong_has_a_reason() -> None:
    data = octets("08 00 8468 1234 0001 6162")
    for size in range(8):
        assert reason(icmp.parse, data[:size]) == "icmp-truncated"
    assert reason(icmp.parse, data[:9]) == "icmp-checksum"
    # 0301+...: type 3 (unreachable), code 1
    assert reason(icmp.parse, octets("03 01 fcfe 0000 0000")) == "icmp-not-echo"
    assert reason(icmp.parse, octets("08 01 f7fe 0000 0000")) == "icmp-not-echo"


def test_igmp_is_written_and_read() -> None:
    # 1600+efff+0001 = 10600, 0601; complement f9fe
    data = octets("16 00 f9fe efff0001")
    assert bytes(Igmp(igmp.REPORT, 0, octets("efff0001")).emit()) == data
    assert igmp.parse(data) == Igmp(igmp.REPORT, 0, octets("efff0001"))


def test_a_longer_query_is_read_as_far_as_it_is_known() -> None:
    # a general query of IGMPv3: 1164+0000+0000+0000+027d+0000 = 13e1; complement ec1e
    assert igmp.parse(octets("11 64 ec1e 00000000 02 7d 0000")) == Igmp(igmp.QUERY, 100, bytes(4))


def test_igmp_that_is_wrong_has_a_reason() -> None:
    data = octets("16 00 f9fe efff0001")
    for size in range(8):
        assert reason(igmp.parse, data[:size]) == "igmp-truncated"
    assert reason(igmp.parse, data[:7] + b"\2") == "igmp-checksum"


def test_addresses_are_read_and_written() -> None:
    assert ipv4.octets_of("192.168.1.2") == A
    assert ipv4.text_of(A) == "192.168.1.2"
    assert ethernet.octets_of("02:00:00:00:00:01") == A_MAC
    assert ethernet.text_of(A_MAC) == "02:00:00:00:00:01"
    for text in ("", "1.2.3", "1.2.3.4.5", "1.2.3.256", "1.2.3.x", "1.2.3.-1"):
        with pytest.raises(ValueError):
            ipv4.octets_of(text)
    for text in ("", "02:00:00:00:00", "02:00:00:00:00:100", "02:00:00:00:00:xx"):
        with pytest.raises(ValueError):
            ethernet.octets_of(text)


def test_a_group_maps_to_its_low_23_bits() -> None:
    assert ipv4.multicast_mac(octets("efff0001")) == octets("01005e7f0001")
    assert ipv4.multicast_mac(octets("e0800102")) == octets("01005e000102")
    assert ipv4.is_multicast(octets("e0000001")) and ipv4.is_multicast(octets("efffffff"))
    assert not ipv4.is_multicast(octets("f0000001")) and not ipv4.is_multicast(octets("dfffffff"))
