"""UDPROS links: blocks in any order, every drop under its name, and what a peer can make us send."""

from struct import pack

import pytest

from engine.ros1.network import Host, Network, linked
from roslet.engine.ros1 import udp
from roslet.engine.ros1.udp import MAX_SENDERS, UdpReceiver
from roslet.errors import ProtocolError
from roslet.wire.tcpros import emit_header
from roslet.wire.udpros import DATA0, DATAN, ERR, PING, emit

pytestmark = pytest.mark.micropython

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

SOURCE = ("10.0.0.1", 7000)


class Port:
    """The shell's datagram ports, as far as an engine sees them."""

    def __init__(self) -> None:
        self.open_now: list[UdpReceiver] = []
        self.next = 9000

    def open(self, receiver: UdpReceiver) -> int:
        self.open_now.append(receiver)
        self.next += 1
        return self.next

    def close(self, receiver: UdpReceiver) -> None:
        if receiver in self.open_now:
            self.open_now.remove(receiver)


def receiving(max_frame: int = 1000) -> "tuple[Host, UdpReceiver, list[bytes]]":
    host = Host(Network(), "/listener", "beta")
    host.engine.udp = Port()
    subscription, got = host.subscriber("/chatter", max_frame=max_frame, transport="udp")
    receiver = host.engine.udp_receiver(subscription, "http://alpha:1/")
    assert receiver is not None
    receiver.accepted(["UDPROS", "alpha", 7000, 77, 1500, emit_header({"md5sum": "m"})[4:]])
    return host, receiver, got


def framed(body: bytes) -> memoryview:
    return memoryview(pack("<I", len(body)) + body)


def feed(receiver: UdpReceiver, datagrams: "list[bytes]", source: "tuple[str, int]" = SOURCE) -> None:
    for datagram in datagrams:
        receiver.receive_datagram(memoryview(datagram), source, 0.0)


def block(operation: int, message: int, number: int, data: bytes = b"", connection: int = 77) -> bytes:
    return pack("<IBBH", connection, operation, message, number) + data


def test_a_message_of_one_datagram_arrives() -> None:
    host, receiver, got = receiving()
    feed(receiver, emit(77, 1, framed(b"hello"), 1500))
    assert got == [b"hello"] and host.engine.counters == {}
    assert (receiver.messages, receiver.bytes) == (1, 5)


def test_blocks_may_come_in_any_order_within_a_message() -> None:
    host, receiver, got = receiving()
    datagrams = emit(77, 1, framed(b"0123456789"), 8 + 4)
    assert len(datagrams) == 4
    feed(receiver, datagrams[::-1])
    feed(receiver, emit(77, 2, framed(b"next"), 8 + 3))
    assert got == [b"0123456789", b"next"] and host.engine.counters == {}


@pytest.mark.parametrize("missing", range(4))
def test_a_message_with_a_missing_block_is_dropped_when_the_next_begins(missing: int) -> None:
    host, receiver, got = receiving()
    datagrams = emit(77, 1, framed(b"0123456789"), 8 + 4)
    del datagrams[missing]
    feed(receiver, datagrams)
    feed(receiver, emit(77, 2, framed(b"next"), 8 + 4))
    assert got == [b"next"] and host.engine.counters == {"udp-incomplete": 1}


@pytest.mark.parametrize(
    ("datagrams", "reason"),
    [
        ([b"", b"1234567"], "udp-too-short"),
        ([block(9, 1, 1)], "udp-unknown-operation"),
        ([block(PING, 1, 1), block(ERR, 1, 1)], "udp-ignored-operation"),
        ([block(DATA0, 1, 1, b"", 78)], "udp-unknown-connection"),
        ([block(DATA0, 1, 0)], "udp-no-blocks"),
        ([block(DATA0, 1, 2, b"a"), block(DATA0, 1, 2, b"a")], "udp-duplicate-block"),
        ([block(DATA0, 1, 2, b"a"), block(DATAN, 1, 7, b"a")], "udp-block-beyond-count"),
        ([block(DATA0, 1, 1, b"abc")], "udp-length-mismatch"),
        ([block(DATA0, 1, 1, pack("<I", 4) + b"abc")], "udp-length-mismatch"),
        ([block(DATA0, 1, 1, pack("<I", 2) + b"abc")], "udp-length-mismatch"),
        ([block(DATA0, 1, 1, bytes(1005))], "frame-too-large"),
    ],
)
def test_what_is_wrong_is_dropped_under_its_name(datagrams: "list[bytes]", reason: str) -> None:
    host, receiver, got = receiving()
    feed(receiver, datagrams)
    assert got == []
    counters = host.engine.counters
    assert list(counters) == [reason] and 1 <= counters[reason] <= 2
    feed(receiver, emit(77, 200, framed(b"fine"), 1500))
    assert got == [b"fine"]


def test_the_first_datagram_decides_whom_we_listen_to() -> None:
    host, receiver, got = receiving()
    feed(receiver, emit(77, 1, framed(b"one"), 1500))
    feed(receiver, emit(77, 2, framed(b"spoofed"), 1500), ("10.0.0.66", 7000))
    feed(receiver, emit(77, 2, framed(b"two"), 1500))
    assert got == [b"one", b"two"] and host.engine.counters == {"udp-foreign-source": 1}


def test_what_is_held_of_a_message_is_bounded() -> None:
    host, receiver, _ = receiving(max_frame=100)
    for number in range(1, 2000):
        feed(receiver, [block(DATAN, 1, number, b"x" * 10)])
        assert receiver._held_bytes <= 104
    assert host.engine.counters["frame-too-large"] > 10


@pytest.mark.parametrize(
    ("answer", "reason"),
    [
        (["UDPROS"], "udp-answer"),
        (["UDPROS", "h", 1, "x", 1500, b""], "udp-answer"),
        (["UDPROS", "h", 1, 1, 1500, emit_header({"md5sum": "other"})[4:]], "md5sum-mismatch"),
        (["UDPROS", "h", 1, 1, 1500, b"\x09\x00"], "header-truncated"),
    ],
)
def test_an_answer_that_is_none_is_refused(answer: "list[Any]", reason: str) -> None:
    host = Host(Network(), "/listener", "beta")
    host.engine.udp = Port()
    subscription, _ = host.subscriber("/chatter", transport="udp")
    receiver = UdpReceiver(host.engine, subscription, "http://alpha:1/")
    with pytest.raises(ProtocolError) as raised:
        receiver.accepted(answer)
    assert raised.value.reason == reason


def test_two_publishers_with_the_same_connection_id_do_not_mix() -> None:
    network, _, talker, listener, _, _, _ = linked()
    other = Host(network, "/other", "gamma")
    for host in (talker, other, listener):
        host.engine.udp = Port()
    first, second = talker.publisher("/u"), other.publisher("/u")
    talker.engine._ids = other.engine._ids = 500
    subscription, got = listener.subscriber("/u", transport="udp")
    assert network.run(3.0, lambda: len(subscription.links) == 2)
    for publication, body in ((first, b"first"), (second, b"second")):
        (sender,) = publication.senders
        assert sender.connection_id == 501 and sender.address[0] == "beta"
        (receiver,) = [one for one in listener.engine.udp.open_now if one.port == sender.address[1]]  # type: ignore[union-attr]
        feed(receiver, sender.datagrams(framed(body)), (sender.callerid, 1))
    assert sorted(got) == [b"first", b"second"] and listener.engine.counters == {}
    listener.engine.unsubscribe(subscription, network.now)
    assert listener.engine.udp.open_now == []  # type: ignore[union-attr]


def test_a_publisher_without_udpros_is_taken_over_tcpros_and_the_port_given_back() -> None:
    network, _, talker, listener, _, _, _ = linked()
    listener.engine.udp = Port()
    publication = talker.publisher("/u")
    listener.subscriber("/u", transport="udp")
    assert network.run(3.0, lambda: publication.links)
    assert listener.engine.udp.open_now == []


def offer(host: str = "beta", port: "Any" = 9000, size: "Any" = 1500, **fields: str) -> "list[Any]":
    header = {"callerid": "/listener", "md5sum": "m", "topic": "/chatter", "type": "t/T"}
    header.update(fields)
    return ["UDPROS", emit_header(header)[4:], host, port, size]


def publishing() -> "tuple[Any, Any, Any]":
    network, _master, talker, _listener, publication, _, _ = linked()
    talker.engine.udp = Port()
    talker.engine.slave.peer = "10.0.0.5"
    talker.engine.slave.now = network.now
    return network, talker, publication


def test_datagrams_go_to_who_asks_and_to_nobody_else() -> None:
    _, talker, publication = publishing()
    reply = talker.engine.slave.request_topic("/x", "/chatter", [offer(host="victim")])
    assert reply[0] == 1 and reply[2][0] == "UDPROS" and len(reply[2]) == 6
    (sender,) = publication.senders
    assert sender.address == ("10.0.0.5", 9000)


def test_who_asks_twice_is_served_once() -> None:
    _, talker, publication = publishing()
    for _ in range(10):
        assert talker.engine.slave.request_topic("/x", "/chatter", [offer()])[0] == 1
    assert len(publication.senders) == 1


def test_subscribers_by_datagrams_have_a_bound() -> None:
    _, talker, publication = publishing()
    for index in range(MAX_SENDERS + 5):
        reply = talker.engine.slave.request_topic("/x", "/chatter", [offer(port=1000 + index)])
    assert reply[0] == 0 and "64 UDPROS subscribers" in reply[1]
    assert len(publication.senders) == MAX_SENDERS
    assert talker.engine.counters["udp-too-many-subscribers"] == 5


@pytest.mark.parametrize(
    "protocol",
    [
        ["UDPROS"],
        offer(port=0),
        offer(port=70000),
        offer(port=True),
        offer(port="1"),
        offer(size=63),
        offer(size=-1),
        ["UDPROS", "text", "h", 1, 1500],
        ["UDPROS", b"\x09", "h", 1, 1500],
        offer(callerid="/\x00"),
    ],
)
def test_an_offer_of_wrong_parameters_is_refused(protocol: "list[Any]") -> None:
    _, talker, publication = publishing()
    reply = talker.engine.slave.request_topic("/x", "/chatter", [protocol])
    assert reply[0] != 1 and publication.senders == ()
    assert talker.engine.counters in ({"udp-parameters": 1}, {"bad-callerid": 1})


def test_an_offer_with_another_md5sum_is_refused() -> None:
    _, talker, publication = publishing()
    reply = talker.engine.slave.request_topic("/x", "/chatter", [offer(md5sum="other")])
    assert reply[0] == 0 and "md5sum" in reply[1] and publication.senders == ()


def test_a_datagram_size_is_cut_to_what_exists() -> None:
    _, talker, publication = publishing()
    reply = talker.engine.slave.request_topic("/x", "/chatter", [offer(size=1 << 40)])
    assert reply[2][4] == 65507 == publication.senders[0].datagram_size


def test_a_subscriber_that_no_longer_subscribes_is_let_go() -> None:
    network, talker, publication = publishing()
    gone = []
    publication.on_link = lambda link, opened: gone.append((link.callerid, opened))
    talker.engine.slave.request_topic("/x", "/chatter", [offer()])
    talker.engine.slave.request_topic("/x", "/chatter", [offer(callerid="/nobody")])
    assert gone == [("/listener", True), ("/nobody", True)]
    network.run(3 * udp.CHECK)
    assert [sender.callerid for sender in publication.senders] == ["/listener"]
    assert gone[2:] == [("/nobody", False)]
    assert talker.engine.counters == {"udp-subscriber-gone": 1}


def test_a_message_too_large_for_datagrams_is_refused_by_name() -> None:
    _, talker, publication = publishing()
    talker.engine.slave.request_topic("/x", "/chatter", [offer(size=64)])
    with pytest.raises(ProtocolError, match="udp-message-too-large"):
        publication.senders[0].datagrams(memoryview(bytes(65536 * 56)))
