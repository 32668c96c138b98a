"""Invariant: whatever discovery infos, USER_DATA, requests and replies come, no exception leaves a Context and its services,
what they hold stays within their bounds, and what they drop has a reason that is explained.

    python fuzz/fuzz_ros2.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_ros2.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import collections
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.engine.ros2 import context as contexts
from roslet.engine.ros2 import services
from roslet.engine.ros2.context import Context
from roslet.engine.ros2.reasons import REASONS
from roslet.engine.ros2.services import ServiceClient, ServiceServer
from roslet.engine.rtps import events
from roslet.engine.rtps import reasons as rtps
from roslet.engine.rtps.participant import Participant
from roslet.engine.rtps.reader import WriterProxy
from roslet.wire import discovery_info
from roslet.wire.discovery_info import NodeEntities, ParticipantEntities
from roslet.wire.rtps import participant_data, qos
from roslet.wire.rtps.data import FLAG_D, Data
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.guid import VENDORID_CYCLONE, VENDORID_EPROSIMA
from roslet.wire.rtps.inline_qos import InlineQos
from roslet.wire.rtps.qos import Qos

PEER = b"\1\x0f\7\7\7\7\7\7\0\0\0\0"
RELIABLE = Qos((qos.RELIABLE, 10**8), history=(qos.KEEP_LAST, 10))
TOPICS = ("rt/a", "rq/addRequest", "rr/addReply", discovery_info.TOPIC, "rt/", "rq/x", "Square", "")
TYPES = (
    "std_msgs::msg::dds_::String_",
    "p::srv::dds_::Add_Request_",
    "p::srv::dds_::Add_Response_",
    "x",
    "::::",
    "",
)
USER_DATA = (
    b"",
    b"typehash=RIHS01_00;",
    b"clientid=1.2;typehash=x;",
    b"serviceid=1.2;",
    b"enclave=/;",
    b"\xff=\xff;==;;",
)
COUNTED: collections.Counter[str] = collections.Counter()


def spoil(source: random.Random, data: bytes) -> bytes:
    """The same, with some octets changed, cut off or added."""
    broken = bytearray(data)
    for _ in range(source.choice((0, 1, 1, 3))):
        if broken:
            broken[source.randrange(len(broken))] = source.choice((0, 1, 0x7F, 0xFF, source.randrange(256)))
    if source.random() < 0.2:
        del broken[source.randrange(len(broken) + 1) :]
    return bytes(broken) + source.randbytes(source.choice((0, 0, 3, 20)))


def info(source: random.Random) -> bytes:
    guids = tuple(
        PEER + bytes((0, 0, source.randrange(9), source.choice((3, 4)))) for _ in range(source.randrange(4))
    )
    nodes = tuple(NodeEntities("/", f"n{number}", guids, guids) for number in range(source.randrange(4)))
    value = ParticipantEntities(PEER + b"\0\0\1\xc1", nodes)
    return spoil(source, value.emit(source.choice((16, 24)), source.random() < 0.5))


def endpoint(source: random.Random) -> EndpointData:
    guid = PEER + bytes((0, 0, source.randrange(9), source.choice((2, 3, 4, 7))))
    policies = RELIABLE.replace(user_data=spoil(source, source.choice(USER_DATA)))
    return EndpointData(guid, source.choice(TOPICS), source.choice(TYPES), policies)


def sample(source: random.Random) -> Data:
    who = source.choice((PEER + b"\0\0\1\4", PEER + b"\0\0\1\3", bytes(16)))
    extra = source.choice(
        (b"", InlineQos(related=(who, 3)).emit(), InlineQos(custom_related=(who, -1)).emit())
    )
    payload = spoil(source, b"\0\1\0\0" + source.randbytes(source.choice((0, 8, 16, 40))))
    return Data(
        bytes(4),
        bytes(4),
        source.randrange(1, 9),
        payload,
        spoil(source, extra),
        FLAG_D,
        source.random() < 0.5,
    )


def check(data: bytes) -> None:
    """The octets choose what comes; raises if the invariant does not hold."""
    source = random.Random(data)
    participant = Participant(b"\1\x52" + bytes(10), 0, (), (), ())
    context = Context(participant)
    context.start(0.0)
    node = context.add_node("n", "/", 0.0)
    server = ServiceServer(context, node, "/add", "p/srv/Add", RELIABLE, 0.0)
    client = ServiceClient(context, node, "/add", "p/srv/Add", RELIABLE, 0.0)
    vendor = source.choice((VENDORID_CYCLONE, VENDORID_EPROSIMA))
    peer = participant_data.ParticipantData(
        PEER + b"\0\0\1\xc1", vendor_id=vendor, user_data=source.choice(USER_DATA)
    )
    context.vendor_of = lambda guid: vendor  # type: ignore[method-assign]
    assert context._reader is not None
    now = 0.0
    for _ in range(len(data)):
        now += source.choice((0.0, 0.01, 1.5))
        what = source.randrange(8)
        if what == 0:
            context.handle_event(events.ParticipantDiscovered(peer), now)
        elif what == 1:
            local = context._reader.entity_id
            event = events.SampleReceived(local, PEER + b"\0\0\1\3", 1, info(source), None, FLAG_D, b"", True)
            context.handle_event(event, now)
        elif what == 2:
            one = endpoint(source)
            context.handle_event(events.EndpointDiscovered(one), now)
            context.handle_event(events.EndpointMatched(server.writer.entity_id, one), now)
        elif what == 3:
            context.handle_event(events.EndpointLost(endpoint(source)), now)
        elif what in (4, 5):
            proxy = WriterProxy(endpoint(source), (), True, now)
            server.reader.proxies[proxy.guid] = proxy
            request = server.request(proxy, sample(source), None)
            if request is not None:
                server.reply(request, b"\0\1\0\0", now)
        elif what == 6:
            if client.pending() < 5:
                client.call(b"\0\1\0\0", now)
            client.response(WriterProxy(endpoint(source), (), True, now), sample(source))
        elif source.random() < 0.2:
            context.handle_event(events.ParticipantLost(peer, True), now)
        context.handle_deadline(now)
        if len(server._waiting) > services.MAX_WAITING or server._waiting_bytes > services.MAX_WAITING_BYTES:
            raise AssertionError("waiting replies")
        graph = context.graph
        graph.endpoints(channel=None)
        graph.topics(mangled=True)
        if (
            len(graph.nodes()) > discovery_info.MAX_NODES + 1
            or len(graph.services()) + len(graph.clients()) > 20
        ):
            raise AssertionError("graph")
        at = context.deadline()
        if at is not None and at > now + max(contexts.BATCH, services.PATIENCE):
            raise AssertionError("deadline")
    unknown = set(participant.counters) - set(REASONS) - set(rtps.REASONS)
    if unknown:
        raise AssertionError(f"unexplained reasons {unknown}")
    COUNTED.update(participant.counters)


def smoke(count: int) -> None:
    """`count` random inputs, always the same."""
    source = random.Random(0)
    for _ in range(count):
        check(source.randbytes(source.randrange(1, 100)))
    print(f"{count} inputs, no finding")


def main() -> None:
    """The command."""
    if sys.argv[1:2] == ["--smoke"]:
        smoke(int(sys.argv[2]))
        return
    import atheris

    atheris.instrument_all()
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
