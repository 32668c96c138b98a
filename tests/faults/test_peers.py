"""What peers do wrong to a node, over real sockets. Every refusal and every drop has a name, which is counted."""

from __future__ import annotations

import random
import struct
import time
from typing import Any

import pytest

import roslet
from nodes import Nodes, Raw, descriptors, ports, ros1, serve, string_subscriber, wait_until
from roslet.io.select import reactor
from roslet.wire.tcpros import MAX_FRAME, MAX_HEADER, emit_header

STRING = "std_msgs/String"
MD5 = "992ce8a1687cec8c8bd883ec73ca41d1"


def healthy(node: roslet.Node, publisher: roslet.Publisher) -> None:
    """The node still serves: its slave API answers, and a new subscriber gets a message."""
    assert node.call_node(node.uri, "getPid", timeout=3) > 0
    with string_subscriber(node, publisher.topic) as raw:
        assert raw.read_header()["md5sum"] == MD5
        count = publisher.subscriber_count
        wait_until(lambda: publisher.subscriber_count >= max(1, count), "it is connected")
        publisher.publish(data="well")
        assert raw.read_frame() == b"\x04\0\0\0well"


@pytest.mark.parametrize(
    ("fields", "reason", "text"),
    [
        ({"md5sum": "0" * 32}, "md5sum-mismatch", "expects std_msgs/String with md5sum 000"),
        ({"md5sum": "*", "type": "std_msgs/Int32"}, "type-mismatch", "expects type std_msgs/Int32"),
        ({"topic": "/nothing"}, "unknown-topic", "does not publish /nothing"),
        ({"service": "/nothing"}, "unknown-service", "does not offer /nothing"),
        ({"callerid": "/\x07"}, "bad-callerid", "control characters"),
    ],
)
def test_a_subscriber_that_does_not_fit_is_told_why(
    make: Nodes, fields: dict[str, str], reason: str, text: str
) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    with string_subscriber(a, "/chatter", **fields) as raw:
        answer = raw.read_header()
        assert text in answer["error"] and answer["error"].startswith(reason)
        assert raw.at_end()
    assert a.counters == {reason: 1}
    healthy(a, publisher)


@pytest.mark.parametrize("missing", ["callerid", "md5sum", "topic"])
def test_a_header_without_a_field_is_refused_with_its_name(make: Nodes, missing: str) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    fields = {"callerid": "/raw", "md5sum": MD5, "topic": "/chatter", "type": STRING}
    del fields[missing]
    with Raw(ports(a)[1]) as raw:
        raw.send_header(**fields)
        assert raw.read_header()["error"] == f"header-field-missing: {missing}"
    assert a.counters == {"header-field-missing": 1}
    healthy(a, publisher)


def test_a_caller_may_say_any_name(make: Nodes) -> None:
    """ROS 1 proves nothing: the name is shown, it gives nothing."""
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    with string_subscriber(a, "/chatter", callerid="/a") as raw:
        raw.read_header()
        wait_until(lambda: publisher.subscriber_count == 1, "it is connected")
        rows = a.call_node(a.uri, "getBusInfo")
        assert [row[1] for row in rows if row[4] == "/chatter"] == ["/a"]
    healthy(a, publisher)


def test_a_header_announced_too_long_is_refused_before_it_is_held(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    with Raw(ports(a)[1]) as raw:
        raw.send(struct.pack("<I", MAX_HEADER + 1))
        assert raw.read_header()["error"].startswith("header-too-large")
    healthy(a, publisher)


class FakePublisher:
    """A publisher made of raw sockets: its slave API answers as a master and a node would expect."""

    def __init__(self, make: Nodes, topic: str) -> None:
        import socket

        self.node = make("fake")  # only for its slave API and registration
        self.publisher = self.node.publisher(topic, STRING)
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.listener.settimeout(5)
        ros1(self.node).engine.tcpros_port = self.listener.getsockname()[1]

    def take(self) -> Raw:
        """The next subscriber's connection, when its header has come."""
        raw = Raw.__new__(Raw)
        raw.sock, _ = self.listener.accept()
        raw.sock.settimeout(5)
        raw.read_header()
        return raw

    def accept(self, **header: str) -> Raw:
        """Take the next subscriber's connection and its header, and answer with this one."""
        raw = self.take()
        fields = {
            "callerid": "/fake",
            "md5sum": MD5,
            "type": STRING,
            "latching": "0",
            "message_definition": "string data\n",
        }
        fields.update(header)
        raw.send_header(**fields)
        return raw

    def close(self) -> None:
        self.listener.close()


@pytest.fixture
def fake(make: Nodes) -> Any:
    made = FakePublisher(make, "chatter")
    yield made
    made.close()


def string_frame(text: bytes) -> bytes:
    return struct.pack("<II", len(text) + 4, len(text)) + text


def test_a_stream_cut_at_every_byte_delivers_what_was_whole_and_names_the_rest(
    make: Nodes, fake: FakePublisher
) -> None:
    header = emit_header({"callerid": "/fake", "md5sum": MD5, "type": STRING})
    session = header + string_frame(b"one") + string_frame(b"") + string_frame(b"three")
    ends = [len(header) + 11, len(header) + 19, len(session)]
    b = make("b")
    for cut in range(len(session) + 1):
        got: list[str] = []
        before = b.counters
        subscription = b.subscribe("chatter", STRING, lambda message, got=got: got.append(message.data))  # type: ignore[misc]
        raw = fake.take()
        raw.send(session[:cut])
        raw.close()
        wait_until(lambda before=before: b.counters != before, f"cut after {cut} bytes: it is counted")  # type: ignore[misc]
        subscription.close()
        assert got == ["one", "", "three"][: sum(end <= cut for end in ends)]
        counted = {name: count - before.get(name, 0) for name, count in b.counters.items()}
        if cut < len(header):
            expected = {"closed-before-header"}
        elif cut in (len(header), *ends):
            expected = {"publisher-lost"}
        else:
            expected = {"publisher-lost", "frame-truncated"}
        assert {name for name, count in counted.items() if count} == expected, cut
    assert b.get_parameter("/nothing", 0) == 0, "the node still works"


def test_a_publisher_killed_within_a_message_is_found_again(make: Nodes, fake: FakePublisher) -> None:
    b = make("b")
    got: list[str] = []
    subscription = b.subscribe("chatter", STRING, lambda message: got.append(message.data))
    raw = fake.accept()
    raw.send(string_frame(b"one") + string_frame(b"x" * 100)[:50])
    wait_until(lambda: got == ["one"], "the first arrives")
    raw.close()
    wait_until(lambda: b.counters.get("frame-truncated") == 1, "the cut is counted")
    assert subscription.publisher_count == 0
    begin = time.monotonic()
    raw = fake_accept_while_serving(fake)
    assert time.monotonic() - begin < 2
    raw.send(string_frame(b"two"))
    wait_until(lambda: got == ["one", "two"], "the second connection works")
    raw.close()


def fake_accept_while_serving(fake: FakePublisher) -> Raw:
    import threading

    made: list[Raw] = []

    def accept() -> None:
        made.append(fake.accept())
        reactor().wake()  # it has looked at `made` already, when the header came

    thread = threading.Thread(target=accept)
    thread.start()
    wait_until(lambda: made, "the subscriber connects again")
    thread.join()
    return made[0]


def test_an_oversized_frame_ends_the_link_and_the_bound_is_the_subscriptions(
    make: Nodes, fake: FakePublisher
) -> None:
    assert MAX_FRAME == 256 << 20, "the default that the documentation states"
    b = make("b")
    notes: list[str] = []
    ros1(b).engine.on_note = notes.append
    got: list[Any] = []
    b.subscribe("chatter", STRING, got.append, max_message=1000)
    raw = fake.accept()
    raw.send(string_frame(b"x" * 996) + string_frame(b"x" * 997))
    wait_until(lambda: b.counters.get("frame-too-large"), "it is refused")
    assert len(got) == 1
    assert any("1001 bytes; at most 1000 are accepted" in note for note in notes)
    assert raw.at_end()


def test_a_length_of_four_gigabytes_costs_nothing(make: Nodes, fake: FakePublisher) -> None:
    b = make("b")
    b.subscribe("chatter", STRING, print)
    raw = fake.accept()
    raw.send(b"\xff\xff\xff\xff" + b"x" * 100)
    wait_until(lambda: b.counters.get("frame-too-large"), "it is refused")
    raw.close()


def test_malformed_messages_are_dropped_counted_and_reported_once(make: Nodes, fake: FakePublisher) -> None:
    b = make("b")
    got: list[str] = []
    subscription = b.subscribe("chatter", STRING, lambda message: got.append(message.data))
    raw = fake.accept()
    bodies = [b"", b"abc", b"\x05\0\0\0abc", b"\xff\xff\xff\xff", b"\x01\0\0\0ab"]
    for body in bodies:
        raw.send(struct.pack("<I", len(body)) + body)
    raw.send(string_frame(b"fine"))
    wait_until(lambda: got == ["fine"], "the good one arrives")
    assert subscription.statistics["malformed"] == 5 and b.counters == {"malformed-message": 5}
    raw.close()


def test_a_publisher_with_another_md5sum_is_refused_by_the_subscriber(
    make: Nodes, fake: FakePublisher
) -> None:
    b = make("b")
    notes: list[str] = []
    ros1(b).engine.on_note = notes.append
    subscription = b.subscribe("chatter", STRING, print)
    fake.accept(md5sum="1" * 32, type="x/Y").close()
    wait_until(lambda: b.counters.get("md5sum-mismatch"), "it is refused")
    assert any("the publisher sends x/Y with md5sum 1111" in note for note in notes)
    assert subscription.publisher_count == 0


def test_what_a_subscriber_sends_is_dropped_and_counted(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    with string_subscriber(a, "/chatter") as raw:
        raw.read_header()
        wait_until(lambda: publisher.subscriber_count == 1, "it is connected")
        for _ in range(50):
            raw.send(b"junk" * 1000)
        publisher.publish(data="fine")
        assert raw.read_frame() == b"\x04\0\0\0fine"
        wait_until(lambda: a.counters.get("data-from-subscriber", 0) > 0, "it is counted")


@pytest.mark.parametrize("seed", range(3))
def test_random_bytes_on_every_port_leave_the_node_well(make: Nodes, seed: int) -> None:
    import socket

    source = random.Random(seed)
    a, b = make("a"), make("b")
    publisher = a.publisher("chatter", STRING)
    a.service("empty", "std_srvs/Empty", lambda request: None)
    a.start()
    b.publisher("scan", STRING)
    a.subscribe("scan", STRING, print, qos=roslet.QoS(reliability="best_effort"))
    udp = [sock.getsockname() for sock in ros1(a).shell._datagrams._receiving.values()]
    assert len(udp) == 1
    before = descriptors()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for _ in range(60):
            data = source.randbytes(source.choice([0, 1, 3, 4, 7, 8, 100, 5000]))
            start = source.choice(
                [b"", b"POST / HTTP/1.1\r\n", b"\x10\0\0\0", b"\x08\0\0\0\x04\0\0\0a=b", b"<?xml"]
            )
            for port in ports(a):
                with Raw(port) as raw:
                    raw.send(start + data)
            sender.sendto(data[:1400], udp[0])
    with Raw(ports(a)[1]) as raw:  # a service's client that talks nonsense after its header
        raw.send_header(callerid="/raw", md5sum="*", service="/empty", persistent="1")
        raw.read_header()
        raw.send(source.randbytes(5000))
    healthy(a, publisher)
    wait_until(lambda: descriptors() <= before + 2, "no descriptor is left")
    names = set(a.counters)
    assert names & {"closed-before-header", "header-too-large", "header-truncated"}
    assert names & {"bad-start-line", "bad-header", "request-truncated"}
    assert names & {"udp-too-short", "udp-unknown-operation", "udp-unknown-connection"}


def call(method: str, body: bytes = b"") -> bytes:
    xml = b"<?xml version='1.0'?><methodCall><methodName>%s</methodName><params>%s</params></methodCall>" % (
        method.encode(),
        body,
    )
    return b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n%s" % (len(xml), xml)


BOMB = (
    b'<?xml version="1.0"?><!DOCTYPE l [<!ENTITY a "' + b"x" * 100 + b'">'
    b'<!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]><methodCall><methodName>&b;</methodName></methodCall>'
)


@pytest.mark.parametrize(
    ("data", "answer", "reason"),
    [
        (b"GET / HTTP/1.1\r\n\r\n", b"405", "not-post"),
        (b"nonsense\r\n\r\n", b"400", "bad-start-line"),
        (b"POST / HTTP/9.9\r\n\r\n", b"505", "unsupported-version"),
        (b"POST / HTTP/1.1\r\nContent-Length: -5\r\n\r\n", b"400", "bad-content-length"),
        (b"POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n", b"413", "body-too-large"),
        (
            b"POST / HTTP/1.1\r\nContent-Encoding: gzip\r\nContent-Length: 1\r\n\r\nx",
            b"501",
            "unsupported-encoding",
        ),
        (b"POST / HTTP/1.1\r\n" + b"X: y\r\n" * 10000, b"431", "header-too-large"),
        (
            b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n%s" % (len(BOMB), BOMB),
            b"no XML-RPC call",
            "forbidden-markup",
        ),
        (call("getPid", b"<param><value>" + b"<array><data><value>" * 1000), b"no XML-RPC call", "too-deep"),
        (call("getPid", b"<param><value><i4>x</i4></value></param>"), b"no XML-RPC call", "bad-int"),
        (call("getPid", b"<param><value>&bomb;</value></param>"), b"no XML-RPC call", "bad-entity"),
    ],
)
def test_http_and_xml_garbage_is_answered_and_counted(
    make: Nodes, data: bytes, answer: bytes, reason: str
) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    with Raw(ports(a)[0]) as raw:
        raw.sock.sendall(data)
        heard = b""
        while answer not in heard:
            piece = raw.sock.recv(10_000)
            assert piece, heard
            heard += piece
    wait_until(lambda: a.counters == {reason: 1}, "it is counted")
    healthy(a, publisher)


def test_calls_of_wrong_shape_are_answered_with_a_status(make: Nodes) -> None:
    a, b = make("a"), make("b")
    for method, arguments in (
        ("getPid", [1]),
        ("publisherUpdate", [1, 2, 3]),
        ("publisherUpdate", ["/t", 5]),
        ("publisherUpdate", [{}, []]),
        ("paramUpdate", [[], 1]),
        ("requestTopic", [[], []]),
        ("requestTopic", ["/x", {}]),
        ("getBusInfo", []),
    ):
        try:
            b.call_node(a.uri, method, *arguments, timeout=3)
        except (roslet.Fault, roslet.ProtocolError):
            continue
    assert b.call_node(a.uri, "getPid") > 0
    assert a.is_shutdown is False


def test_a_client_that_dies_within_its_request_is_counted(make: Nodes) -> None:
    a = make("a")
    with Raw(ports(a)[0]) as raw:
        raw.send(b"POST / HTTP/1.1\r\nContent-Length: 1000\r\n\r\nhalf")
        serve(0.05)
    wait_until(lambda: a.counters == {"request-truncated": 1}, "it is counted")


def test_requests_for_datagrams_send_nothing_to_third_parties(make: Nodes) -> None:
    import socket

    a, b = make("a"), make("b")
    publisher = a.publisher("scan", STRING)
    header = emit_header({"callerid": "/evil", "md5sum": MD5, "topic": "/scan", "type": STRING})[4:]
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as victim,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own,
    ):
        victim.bind(("127.0.0.2", 0))
        own.bind(("127.0.0.1", victim.getsockname()[1]))
        for sock in (victim, own):
            sock.settimeout(0.3)
        port = victim.getsockname()[1]
        answer = b.call_node(a.uri, "requestTopic", "/scan", [["UDPROS", header, "127.0.0.2", port, 1500]])
        assert answer[0] == "UDPROS"
        publisher.publish(data="x")
        assert own.recv(100).endswith(b"\x05\0\0\0\x01\0\0\0x"), "it goes to who asked"
        with pytest.raises(TimeoutError):
            victim.recv(100)
        for number in range(200):
            try:
                b.call_node(
                    a.uri, "requestTopic", "/scan", [["UDPROS", header, "127.0.0.2", 2000 + number, 1500]]
                )
            except roslet.Fault as refused:
                assert "64 UDPROS subscribers" in str(refused)
        assert publisher.subscriber_count == 64
        assert a.counters["udp-too-many-subscribers"] == 137
    with pytest.raises(roslet.Fault):
        b.call_node(a.uri, "requestTopic", "/scan", [["UDPROS", header, "h", 5, 10]])
    assert a.counters["udp-parameters"] == 1


# -- services


def service_client(node: roslet.Node, service: str) -> Raw:
    raw = Raw(ports(node)[1])
    raw.send_header(callerid="/raw", md5sum="*", service=service, persistent="1")
    assert "error" not in raw.read_header()
    return raw


def test_a_malformed_request_is_answered_and_the_service_goes_on(make: Nodes) -> None:
    a = make("a")
    a.service("add", "rospy_tutorials/AddTwoInts", lambda request: {"sum": request.a + request.b})
    a.start()
    with service_client(a, "/add") as raw:
        for body in (b"", b"short", bytes(15), bytes(17), bytes(1000)):
            raw.send(struct.pack("<I", len(body)) + body)
            assert raw.read(1) == b"\x00"
            assert b"/add: malformed request" in raw.read_frame()
        raw.send(struct.pack("<Iqq", 16, 3, 4))
        assert raw.read(1) == b"\x01" and raw.read_frame() == struct.pack("<q", 7)
    assert a.counters == {"malformed-request": 5}


def test_a_request_beyond_the_bound_ends_the_connection(make: Nodes) -> None:
    a = make("a")
    a.service("add", "rospy_tutorials/AddTwoInts", lambda request: {"sum": 0})
    a.start()
    with service_client(a, "/add") as raw:
        raw.send(b"\xff\xff\xff\x7f" + b"x" * 100_000)
        assert raw.at_end()
    assert a.counters == {"frame-too-large": 1}


@pytest.mark.parametrize(
    ("reply", "reason", "error"),
    [
        (b"\x01\x03\0\0\0abc", "malformed-response", roslet.MalformedMessage),
        (b"\x01\xff\xff\xff\xff", "frame-too-large", roslet.ServiceFailed),
        (b"\x01\x08\0\0\0abc", "frame-truncated", roslet.ServiceFailed),
        (b"", "", roslet.ServiceFailed),
        (b"\x00\x02\0\0\0no", "", roslet.ServiceFailed),
        (b"\x01\x08\0\0\0" + bytes(8) + b"\x01\x08\0\0\0" + bytes(8), "reply-without-call", None),
    ],
)
def test_a_server_that_answers_nonsense_fails_its_call_only(
    make: Nodes, master: Any, reply: bytes, reason: str, error: type[Exception] | None
) -> None:
    import socket
    import threading

    with socket.create_server(("127.0.0.1", 0)) as listener:
        uri = f"rosrpc://127.0.0.1:{listener.getsockname()[1]}"
        master.call("registerService", "/fake", "/add", uri, "http://127.0.0.1:9/")

        def answer() -> None:
            raw = Raw.__new__(Raw)
            raw.sock, _ = listener.accept()
            raw.sock.settimeout(5)
            raw.read_header()
            raw.send_header(callerid="/fake", md5sum="*", type="x/Y")
            raw.read_frame()
            raw.send(reply)
            raw.close()

        thread = threading.Thread(target=answer)
        thread.start()
        node = make("b")
        client = node.client("add", "rospy_tutorials/AddTwoInts", persistent=True)
        if error is None:
            assert client.call(a=1, b=2, timeout=3).sum == 0
        else:
            with pytest.raises(error):
                client.call(a=1, b=2, timeout=3)
        thread.join()
        if reason:
            wait_until(lambda: node.counters.get(reason) == 1, "it is counted")
        assert set(node.counters) <= {reason}


def test_a_service_that_refuses_the_header_is_told_by_its_own_words(make: Nodes, master: Any) -> None:
    import socket
    import threading

    with socket.create_server(("127.0.0.1", 0)) as listener:
        master.call(
            "registerService",
            "/fake",
            "/add",
            f"rosrpc://127.0.0.1:{listener.getsockname()[1]}",
            "http://h:9/",
        )

        def refuse() -> None:
            raw = Raw.__new__(Raw)
            raw.sock, _ = listener.accept()
            raw.send_header(error="not today")
            raw.at_end()
            raw.close()

        thread = threading.Thread(target=refuse)
        thread.start()
        with pytest.raises(roslet.HandshakeRefused, match="not today"):
            make("b").client("add", "rospy_tutorials/AddTwoInts").call(timeout=3)
        thread.join()


# -- what the machine itself refuses


def test_datagrams_that_cannot_be_sent_or_received_are_counted(
    make: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("scan", STRING)
    subscription = b.subscribe("scan", STRING, qos=roslet.QoS(reliability="best_effort"))
    assert publisher.wait_for_subscribers(1, 3)

    def full(*given: Any) -> Any:
        raise OSError("no")

    monkeypatch.setattr(type(ros1(a).shell._datagrams), "_socket", full)
    ros1(a).shell._datagrams._sending = None
    publisher.publish(data="x")
    assert a.counters == {"udp-not-sent": 1}
    subscription.close()
    again = b.subscribe("scan", STRING, qos=roslet.QoS(reliability="best_effort"))
    wait_until(lambda: again.publisher_count == 1, "TCPROS takes its place")
    assert b.counters == {"udp-no-port": 1}


def test_a_client_of_the_slave_api_that_does_not_read_is_cut_off(
    make: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    from roslet.engine.ros1.rpc import RpcServer

    monkeypatch.setattr(RpcServer, "max_unsent", 100_000)
    a = make("a")
    for index in range(10_000):  # an answer of a megabyte
        ros1(a).engine.publications[f"/t{index}"] = ros1(a).engine.publications["/rosout"]
    request = call("getPublications", b"<param><value>/x</value></param>")
    with Raw(ports(a)[0]) as raw:
        raw.sock.setblocking(False)
        end = time.monotonic() + 8
        while "unread-answers" not in a.counters:
            assert time.monotonic() < end, a.counters
            try:
                raw.sock.send(request)
            except BlockingIOError:
                pass
            except OSError:
                break  # cut off
            serve(0.05)
    serve(0.2)
    assert a.counters == {"unread-answers": 1}


def test_messages_that_wait_when_the_node_closes_are_counted(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    with string_subscriber(a, "/chatter") as stuck:
        stuck.read_header()
        wait_until(lambda: publisher.subscriber_count == 1, "it is connected")
        for _ in range(4):
            publisher.publish(data="x" * 10_000_000)
        begin = time.monotonic()
        a.close()
        assert time.monotonic() - begin < 0.9
        assert a.counters == {"queued-at-close": 4}


def test_a_name_that_another_node_has_taken_is_counted(make: Nodes, master: Any) -> None:
    a = make("a")
    ros1(a).engine.registrations.check = 0.05
    wait_until(lambda: ros1(a).engine.registrations.settled, "it is registered")
    # A master that does not tell the first node.
    monkey = master.master
    monkey._apis["/a"] = "http://127.0.0.1:9/"
    wait_until(lambda: a.counters.get("name-taken", 0) >= 1, "it is counted")
