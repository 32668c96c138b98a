"""Servers and clients of services, in both dialects, in virtual time. The peers of the dialect HEADER are bytes by hand."""

# ruff: noqa: B023 - every function here is called before its loop goes on

import struct

import pytest

from engine.ros2.members import HASH, RELIABLE, Member, run
from engine.rtps.network import Network
from roslet.engine.ros2 import services
from roslet.engine.ros2.services import HEADER, INLINE, ServiceClient, ServiceServer, TooManyCalls
from roslet.engine.rtps import events
from roslet.wire.rtps import inline_qos
from roslet.wire.rtps.data import Data
from roslet.wire.rtps.guid import VENDORID_CYCLONE, VENDORID_EPROSIMA
from roslet.wire.rtps.inline_qos import InlineQos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

ADD = "example_interfaces/srv/AddTwoInts"
REQUEST, RESPONSE = (
    "example_interfaces::srv::dds_::AddTwoInts_Request_",
    "example_interfaces::srv::dds_::AddTwoInts_Response_",
)
LITTLE, BIG = b"\0\1\0\0", b"\0\0\0\0"


def question(a: int, b: int) -> bytes:
    return LITTLE + struct.pack("<qq", a, b)


class Server:
    """Adds, unless told to be slow: then requests pile up in `asked`."""

    def __init__(self, member: Member, slow: bool = False) -> None:
        self.member = member
        self.asked: list[Any] = []
        self.slow = slow
        node = member.context.add_node("server", "/", member.network.now)
        self.machine = ServiceServer(
            member.context, node, "/add", ADD, RELIABLE, member.network.now, (HASH, HASH), self.sink
        )

    def sink(self, proxy: "Any", value: "Any", time: "int | None") -> None:
        request = self.machine.request(proxy, value, time)
        if request is not None:
            body = bytes(request.payload)
            request.payload = body
            self.asked.append(request)
            if not self.slow:
                self.answer(request)

    def answer(self, request: "Any") -> bool:
        order = "<" if request.payload[1] & 1 else ">"
        a, b = struct.unpack_from(order + "qq", request.payload, 4)
        response = bytes(request.payload[:4]) + struct.pack(order + "q", a + b)
        return self.machine.reply(request, response, self.member.network.now)


class Client:
    def __init__(self, member: Member, name: str = "client") -> None:
        self.member = member
        self.answers: dict[int, int] = {}
        node = member.context.add_node(name, "/", member.network.now)
        self.machine = ServiceClient(
            member.context, node, "/add", ADD, RELIABLE, member.network.now, (HASH, HASH), self.sink, 100
        )

    def sink(self, proxy: "Any", value: "Any", time: "int | None") -> None:
        found = self.machine.response(proxy, value)
        if found is not None:
            self.answers[found[0]] = struct.unpack_from("<q", found[1], 4)[0]

    def ask(self, a: int, b: int) -> int:
        return self.machine.call(question(a, b), self.member.network.now)


class Plain:
    """A participant that speaks a dialect by itself: what it gets is in `heard`, as (payload, inline QoS)."""

    def __init__(self, network: Network, serving: bool, vendor: bytes, user_data: bytes = b"") -> None:
        self.network = network
        self.host = network.host()
        participant = self.host.participant
        participant.spdp.change(participant.spdp.own.replace(vendor_id=vendor), network.now)
        policies = RELIABLE.replace(user_data=user_data)
        asks, answers = ("rq/addRequest", REQUEST), ("rr/addReply", RESPONSE)
        read, write = (asks, answers) if serving else (answers, asks)
        self.reader = participant.create_reader(read[0], read[1], policies, network.now)
        self.writer = participant.create_writer(write[0], write[1], policies, network.now)

    def say(self, payload: bytes, extra: bytes = b"") -> int:
        return self.writer.write(payload, self.network.now, inline_qos=extra)

    @property
    def heard(self) -> "list[tuple[bytes, Any]]":
        found = []
        for event in self.host.of(events.SampleReceived):
            if event.local == self.reader.entity_id:
                found.append((event.payload, inline_qos.parse(event.inline_qos, event.little)))
        return found

    @property
    def matched(self) -> bool:
        return bool(self.reader.proxies and self.writer.proxies)


def test_calls_are_answered_each_by_its_number() -> None:
    for loss in (0.0, 0.2):
        network = Network(5, loss)
        one, other = Member(network), Member(network)
        server, client = Server(one), Client(other)
        assert not client.machine.ready()
        assert run(network, [one, other], 20, client.machine.ready)
        expected = {}
        for number in range(50):
            expected[client.ask(number, 1000)] = number + 1000
        assert client.machine.pending() == 50
        assert run(network, [one, other], 20, lambda: client.answers == expected)
        assert client.machine.pending() == 0
        assert len(server.asked) == 50
        assert {request.dialect for request in server.asked} == {INLINE}
        assert client.answers == expected


def test_each_client_gets_its_own_replies_only() -> None:
    network = Network()
    one, other, third = Member(network), Member(network), Member(network)
    Server(one)
    clients = [Client(other, "a"), Client(other, "b"), Client(third, "c")]
    got: list[int] = []
    machine = clients[0].machine
    response = machine.response

    def counted(proxy: "Any", value: "Any") -> "Any":
        got.append(value.sequence)
        return response(proxy, value)

    machine.response = counted  # type: ignore[method-assign]
    members = [one, other, third]
    assert run(network, members, 20, lambda: all(client.machine.ready() for client in clients))
    calls = [client.ask(10, number) for number, client in enumerate(clients)]
    assert run(network, members, 5, lambda: all(client.answers for client in clients))
    assert [client.answers for client in clients] == [{calls[n]: 10 + n} for n in range(3)]
    run(network, members, 1)
    assert len(got) == 1


def test_a_request_and_its_reply_have_the_identities_that_fast_dds_has() -> None:
    network = Network()
    one = Member(network)
    server = Server(one)
    asker = Plain(network, False, VENDORID_EPROSIMA)
    assert run(network, [one], 5, lambda: asker.matched and bool(server.machine.writer.proxies))
    mine = (asker.reader.data.guid, -(1 << 32))
    asker.say(question(1, 2), InlineQos(related=mine).emit())
    asker.say(question(3, 4), InlineQos(custom_related=mine).emit())
    asker.say(question(5, 6))
    assert run(network, [one], 5, lambda: len(asker.heard) == 3)
    numbered = [(asker.reader.data.guid, 1), (asker.reader.data.guid, 2), (asker.writer.data.guid, 3)]
    for (payload, extra), identity, total in zip(asker.heard, numbered, (3, 7, 11)):  # noqa: B905
        assert payload == LITTLE + struct.pack("<q", total)
        assert (extra.related, extra.custom_related) == (identity, identity)


@pytest.mark.parametrize("order", [LITTLE, BIG])
@pytest.mark.parametrize("user_data", [b"", b"clientid= 1.2.3;typehash=x;"])
def test_a_cyclone_client_is_answered_with_its_header(order: bytes, user_data: bytes) -> None:
    network = Network()
    one = Member(network)
    server = Server(one)
    asker = Plain(network, False, VENDORID_CYCLONE, user_data)
    assert run(network, [one], 5, lambda: asker.matched and bool(server.machine.writer.proxies))
    form = "<" if order == LITTLE else ">"
    asker.say(order + struct.pack(form + "Qqqq", 0x1122334455667788, 7, 20, 22))
    assert run(network, [one], 5, lambda: asker.heard)
    [(payload, extra)] = asker.heard
    assert payload == order + struct.pack(form + "Qqq", 0x1122334455667788, 7, 42)
    assert extra == inline_qos.NONE
    assert [request.dialect for request in server.asked] == [HEADER]
    assert server.asked[0].identity() == (0x1122334455667788, 7)


def test_clients_of_both_dialects_are_served_at_once_and_hear_nothing_of_each_other() -> None:
    network = Network(9, 0.1)
    one, other = Member(network), Member(network)
    server, client = Server(one), Client(other)
    cyclone = Plain(network, False, VENDORID_CYCLONE)
    fast = Plain(network, False, VENDORID_EPROSIMA)
    members = [one, other]
    assert run(
        network,
        members,
        20,
        lambda: (
            client.machine.ready()
            and cyclone.matched
            and fast.matched
            and len(server.machine.writer.proxies) == 3
        ),
    )
    expected = {}
    for number in range(10):
        cyclone.say(LITTLE + struct.pack("<Qqqq", 5, number, number, 1))
        fast.say(question(number, 2), InlineQos(related=(fast.reader.data.guid, -(1 << 32))).emit())
        expected[client.ask(number, 3)] = number + 3
        run(network, members, 0.02)
    assert run(
        network,
        members,
        30,
        lambda: len(cyclone.heard) == len(fast.heard) == 10 and client.answers == expected,
    )
    run(network, members, 1)
    assert [payload for payload, _ in cyclone.heard] == [
        LITTLE + struct.pack("<Qqq", 5, number, number + 1) for number in range(10)
    ]
    assert [payload for payload, _ in fast.heard] == [
        LITTLE + struct.pack("<q", number + 2) for number in range(10)
    ]


def test_a_cyclone_server_is_asked_with_a_header() -> None:
    network = Network()
    one = Member(network)
    client = Client(one)
    replier = Plain(network, True, VENDORID_CYCLONE, b"serviceid=1.2;")
    assert run(network, [one], 5, client.machine.ready)
    call = client.ask(1, 2)
    assert run(network, [one], 5, lambda: replier.heard)
    [(payload, extra)] = replier.heard
    guid, number, a, b = struct.unpack("<Qqqq", payload[4:])
    assert (payload[:4], number, a, b, extra) == (LITTLE, call, 1, 2, inline_qos.NONE)
    replier.say(LITTLE + struct.pack("<Qqq", guid + 1, number, 99))
    replier.say(LITTLE + struct.pack("<Qqq", guid, number, 3))
    assert run(network, [one], 5, lambda: client.answers == {call: 3})
    replier.say(LITTLE + struct.pack("<Qqq", guid, number, 3))
    replier.say(LITTLE + bytes(15))
    run(network, [one], 1)
    assert one.participant.counters == {"reply-without-call": 1, "service-header-truncated": 1}


def test_servers_of_both_dialects_are_each_asked_in_their_own() -> None:
    network = Network()
    one, other = Member(network), Member(network)
    client, server = Client(one), Server(other, slow=True)
    replier = Plain(network, True, VENDORID_CYCLONE)
    assert run(network, [one, other], 5, lambda: len(client.machine.writer.proxies) == 2 and replier.matched)
    calls = [client.ask(1, 2), client.ask(3, 4)]
    assert run(network, [one, other], 5, lambda: len(replier.heard) == 2 and len(server.asked) == 2)
    assert [request.payload for request in server.asked] == [question(1, 2), question(3, 4)]
    assert [payload[20:] for payload, _ in replier.heard] == [question(1, 2)[4:], question(3, 4)[4:]]
    assert client.machine.pending() == 2
    for request in server.asked:
        assert server.answer(request)
    assert run(network, [one, other], 5, lambda: client.answers == {calls[0]: 3, calls[1]: 7})
    assert client.machine._calls == {}
    guid, number = struct.unpack_from("<Qq", replier.heard[0][0], 4)
    replier.say(LITTLE + struct.pack("<Qqq", guid, number, 3))
    assert run(network, [one, other], 5, lambda: "reply-without-call" in one.participant.counters)


def test_a_client_is_ready_only_when_both_ends_of_one_server_are_matched() -> None:
    network = Network()
    one = Member(network)
    client = Client(one)
    half, rest = network.host(), network.host()
    half.participant.create_reader("rq/addRequest", REQUEST, RELIABLE, network.now)
    rest.participant.create_writer("rr/addReply", RESPONSE, RELIABLE, network.now)
    machine = client.machine
    assert run(network, [one], 5, lambda: machine.writer.proxies and machine.reader.proxies)
    assert not machine.ready()
    half.participant.create_writer("rr/addReply", RESPONSE, RELIABLE, network.now)
    assert run(network, [one], 5, machine.ready)


def test_a_reply_waits_for_its_reader_and_is_given_up_in_time() -> None:
    network = Network()
    one = Member(network)
    server = Server(one)
    half = network.host().participant
    writer = half.create_writer("rq/addRequest", REQUEST, RELIABLE, network.now)
    # The reader's GUID is known beforehand: the next number.
    reader_guid = half.guid_prefix + b"\0\0\2\4"
    assert run(network, [one], 5, lambda: bool(writer.proxies and server.machine.reader.proxies))
    extra = InlineQos(related=(reader_guid, -(1 << 32))).emit()
    writer.write(question(1, 2), network.now, inline_qos=extra)
    assert run(network, [one], 1, lambda: server.asked)
    assert one.context.deadline() is not None
    run(network, [one], 0.3)
    reader = half.create_reader("rr/addReply", RESPONSE, RELIABLE, network.now)
    assert reader.data.guid == reader_guid
    host = network.hosts[-1]
    assert run(network, [one], 1, lambda: host.of(events.SampleReceived))
    assert host.of(events.SampleReceived)[0].payload == LITTLE + struct.pack("<q", 3)
    assert one.context.deadline() is None
    writer.write(
        question(1, 2), network.now, inline_qos=InlineQos(related=(half.guid_prefix + b"\0\0\7\4", 0)).emit()
    )
    run(network, [one], services.PATIENCE + 0.5)
    assert one.participant.counters == {"reply-reader-unmatched": 1}
    assert one.context.deadline() is None


def test_what_waits_is_bounded_and_a_client_that_is_gone_is_not_waited_for() -> None:
    network = Network()
    one = Member(network)
    server = Server(one, slow=True)
    half = network.host().participant
    writer = half.create_writer("rq/addRequest", REQUEST, RELIABLE, network.now)
    assert run(network, [one], 5, lambda: bool(writer.proxies and server.machine.reader.proxies))
    writer.write(question(1, 2), network.now)
    assert run(network, [one], 1, lambda: server.asked)
    for _ in range(services.MAX_WAITING + 1):
        assert not server.answer(server.asked[0])
    assert one.participant.counters == {"replies-waiting-full": 1}
    half.close(network.now)
    run(network, [one], 0.5)
    assert not server.answer(server.asked[0])
    assert one.participant.counters["reply-client-gone"] == 1
    server.machine.close(network.now)
    assert one.context.deadline() is not None
    run(network, [one], 0.5)
    assert one.context.deadline() is None
    assert one.graph.services() == {}


def test_a_client_cannot_have_others_answered() -> None:
    network = Network()
    one, victim = Member(network), Member(network)
    server, client = Server(one), Client(victim)
    liar = Plain(network, False, VENDORID_EPROSIMA)
    assert run(network, [one, victim], 5, lambda: client.machine.ready() and liar.matched)
    run(network, [one, victim], 0.5)
    liar.say(question(1, 2), InlineQos(related=(client.machine.reader.data.guid, -(1 << 32))).emit())
    assert run(network, [one, victim], 5, lambda: liar.heard)
    assert len(server.asked) == 1
    assert client.answers == {}
    assert "reply-without-call" not in victim.participant.counters


def test_unanswered_calls_are_bounded_and_can_be_given_up() -> None:
    network = Network()
    one = Member(network)
    client = Client(one)
    calls = [client.ask(1, 1) for _ in range(100)]
    with pytest.raises(TooManyCalls, match="100 calls of /add"):
        client.ask(1, 1)
    client.machine.forget(calls[0])
    client.machine.forget(calls[0])
    client.machine.forget(-5)
    client.ask(1, 1)
    assert client.machine.pending() == 100


def test_requests_and_replies_that_are_none_are_dropped_and_counted() -> None:
    network = Network()
    one, other = Member(network), Member(network)
    server, client = Server(one), Client(other)
    asker = Plain(network, False, VENDORID_CYCLONE)
    assert run(network, [one, other], 5, lambda: asker.matched and client.machine.ready())
    asker.say(LITTLE + bytes(15))
    asker.say(LITTLE + bytes(12))
    run(network, [one, other], 1)
    assert one.participant.counters == {"service-header-truncated": 2}
    assert server.asked == []
    [proxy] = [one for one in client.machine.reader.proxies.values()]  # noqa: C416
    assert client.machine.response(proxy, Data(b"\0\0\0\0", b"\0\0\0\3", 1, LITTLE)) is None
    assert client.machine.response(proxy, Data(b"\0\0\0\0", b"\0\0\0\3", 1, LITTLE, b"\x83\0\2\0")) is None
    assert other.participant.counters == {"reply-without-identity": 1, "parameter-truncated": 1}
