"""Contexts find each other's nodes and endpoints, in virtual time."""

import pytest

from engine.ros2.members import HASH, RELIABLE, STRING, Member, run
from engine.rtps.network import Network
from roslet.engine.ros2 import context as contexts
from roslet.engine.ros2 import graph
from roslet.engine.ros2.context import Context
from roslet.engine.ros2.graph import EndpointInfo, NodeInfo
from roslet.engine.rtps import events
from roslet.errors import InvalidName, NodeClosed
from roslet.names import REPLY, REQUEST, dds_service_types, dds_topic, dds_type
from roslet.wire import discovery_info
from roslet.wire.discovery_info import GID, OLD_GID, NodeEntities, ParticipantEntities
from roslet.wire.rtps import qos
from roslet.wire.rtps.data import FLAG_D

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


def test_nodes_and_endpoints_are_known_to_others_and_to_ourselves() -> None:
    network = Network()
    one, other = Member(network), Member(network)
    talker = one.context.add_node("talker", "/robot", network.now)
    second = one.context.add_node("second", "/", network.now)
    writer = one.publisher(talker, "/robot/chatter")
    one.publisher(second, "/tf")
    listener = other.context.add_node("listener", "/", network.now)
    reader = other.subscription(listener, "/robot/chatter")
    assert run(network, [one, other], 5, lambda: len(one.graph.nodes()) == len(other.graph.nodes()) == 3)
    for member in (one, other):
        nodes = member.graph.nodes()
        assert NodeInfo("talker", "/robot", "/", one.participant.guid_prefix) in nodes
        assert NodeInfo("second", "/", "/", one.participant.guid_prefix) in nodes
        assert sorted([node.full_name for node in nodes]) == ["/listener", "/robot/talker", "/second"]
        assert member.graph.topics() == {
            "/robot/chatter": ["std_msgs/msg/String"],
            "/tf": ["std_msgs/msg/String"],
        }
        assert member.graph.topics(("talker", "/robot"), True) == {"/robot/chatter": ["std_msgs/msg/String"]}
        assert member.graph.topics(("talker", "/robot"), False) == {}
        [info] = member.graph.endpoints("/robot/chatter", writers=True)
        assert info == EndpointInfo(
            graph.PUBLISHER,
            "/robot/chatter",
            "std_msgs/msg/String",
            HASH,
            writer.data.guid,
            info.qos,
            "talker",
            "/robot",
        )
        assert info.qos.reliable
        [info] = member.graph.endpoints(node=("listener", "/"))
        assert (info.kind, info.gid) == (graph.SUBSCRIPTION, reader.data.guid)
        assert member.graph.count("rt/robot/chatter", True) == 1
        assert member.graph.count("rt/robot/chatter", False) == 1
        assert member.graph.count("rt/nothing", True) == 0
    assert [event.local for event in one.left if isinstance(event, events.EndpointMatched)] == [
        writer.entity_id
    ]
    assert one.participant.counters == other.participant.counters == {}


def test_what_is_removed_is_gone_everywhere() -> None:
    network = Network()
    one, other = Member(network), Member(network)
    first = one.context.add_node("first", "/", network.now)
    second = one.context.add_node("second", "/", network.now)
    writer = one.publisher(first, "/a")
    one.publisher(second, "/b")
    assert run(
        network, [one, other], 5, lambda: len(other.graph.topics()) == 2 and len(other.graph.nodes()) == 2
    )
    before = other.graph.revision
    one.context.delete_writer(first, writer, network.now)
    one.context.delete_writer(first, writer, network.now)
    assert run(network, [one, other], 5, lambda: list(other.graph.topics()) == ["/b"])
    assert other.graph.revision > before
    one.context.remove_node(second, network.now)
    one.context.remove_node(second, network.now)
    assert run(network, [one, other], 1, lambda: other.graph.topics() == {} and len(other.graph.nodes()) == 1)
    with pytest.raises(NodeClosed):
        one.publisher(second, "/c")
    one.participant.close(network.now)
    assert run(network, [one, other], 0.1, lambda: other.graph.nodes() == [])
    assert other.graph.endpoints(channel=None) != []
    assert {info.gid[:12] for info in other.graph.endpoints(channel=None)} == {other.participant.guid_prefix}


def test_a_participant_that_vanishes_is_forgotten_with_all_it_had() -> None:
    network = Network()
    one, other = Member(network, lease=2.0, period=0.5), Member(network)
    one.publisher(one.context.add_node("n", "/", network.now), "/a")
    assert run(network, [one, other], 5, lambda: other.graph.nodes() and other.graph.topics())
    network.remove(one.host)
    assert run(network, [other], 5, lambda: not other.graph.nodes() and not other.graph.topics())


def test_changes_in_a_row_are_told_in_one_sample() -> None:
    network = Network()
    one, other = Member(network), Member(network)
    run(network, [one, other], 1)
    assert one.context._writer is not None
    before = one.context._writer.last
    node = one.context.add_node("n", "/", network.now)
    for number in range(20):
        one.publisher(node, "/t%d" % number)
    at = one.context.deadline()
    assert at is not None
    assert network.now < at <= network.now + contexts.BATCH
    run(network, [one, other], 1)
    assert one.context._writer.last == before + 1
    assert one.context.deadline() is None
    assert len(other.graph.endpoints(node=("n", "/"))) == 20
    one.publisher(node, "/more")
    one.context.flush(network.now)
    assert one.context._writer.last == before + 2


def test_over_a_lossy_network_the_graph_is_complete_in_the_end() -> None:
    network = Network(3, 0.3, 0.1, 0.1)
    members = [Member(network) for _ in range(5)]
    for number, member in enumerate(members):
        node = member.context.add_node("n%d" % number, "/", network.now)
        for topic in range(4):
            member.publisher(node, "/t%d" % topic)
    done = [0]

    def complete() -> bool:
        done[0] = len(
            [one for one in members if len(one.graph.nodes()) == 5 and len(one.graph.endpoints()) == 20]
        )
        return done[0] == 5

    assert run(network, members, 60, complete), done


def test_services_and_clients_are_told_apart() -> None:
    network = Network()
    one, other = Member(network), Member(network)
    server = one.context.add_node("server", "/", network.now)
    client = other.context.add_node("client", "/", network.now)
    request, response = dds_service_types("example_interfaces/srv/AddTwoInts")
    ask, answer = dds_topic(REQUEST, "/add"), dds_topic(REPLY, "/add")
    one.context.create_reader(server, ask, request, RELIABLE, HASH, network.now)
    one.context.create_writer(server, answer, response, RELIABLE, HASH, network.now)
    other.context.create_writer(client, ask, request, RELIABLE, HASH, network.now, b"clientid=1;")
    other.context.create_reader(client, answer, response, RELIABLE, HASH, network.now)
    assert run(
        network,
        [one, other],
        5,
        lambda: one.graph.clients(("client", "/")) and other.graph.services(("server", "/")),
    )
    for member in (one, other):
        assert member.graph.services() == {"/add": ["example_interfaces/srv/AddTwoInts"]}
        assert member.graph.clients() == {"/add": ["example_interfaces/srv/AddTwoInts"]}
        assert member.graph.services(("client", "/")) == {}
        assert member.graph.clients(("server", "/")) == {}
        assert member.graph.topics() == {}
        [info] = member.graph.endpoints("/add", writers=True, channel=REQUEST)
        assert (info.type_hash, info.node_name) == (HASH, "client")
        assert bytes(info.qos.user_data) == b"clientid=1;typehash=" + HASH.encode() + b";"


def test_an_endpoint_whose_node_nobody_told_has_rmws_name_for_it() -> None:
    network = Network()
    one = Member(network)
    ros, bare = network.host(), network.host(user_data=b"")
    for host in (ros, bare):
        host.participant.create_writer("rt/t", dds_type("std_msgs/msg/String"), RELIABLE, network.now)
        host.participant.create_writer("Square", "ShapeType", RELIABLE, network.now)
    assert run(network, [one], 5, lambda: len(one.graph.endpoints("/t")) == 2)
    assert sorted([(info.node_name, info.node_namespace) for info in one.graph.endpoints("/t")]) == [
        (graph.BARE_NAME, graph.BARE_NAME),
        (graph.UNKNOWN_NAME, graph.UNKNOWN_NAMESPACE),
    ]
    assert [info.type_name for info in one.graph.endpoints("Square", channel="")] == ["ShapeType"] * 2
    assert one.graph.topics(mangled=True)["rt/t"] == [STRING]
    assert "Square" in one.graph.topics(mangled=True)


def _teller(network: Network, size: int, user_data: bytes) -> "Any":
    """A participant that speaks ros_discovery_info by itself."""
    host = network.host()
    policies = contexts.WRITER_QOS.replace(user_data=user_data)
    writer = host.participant.create_writer(discovery_info.TOPIC, discovery_info.TYPE, policies, network.now)
    reader = host.participant.create_reader(discovery_info.TOPIC, discovery_info.TYPE, policies, network.now)
    info = ParticipantEntities(host.participant.guid_prefix + b"\0\0\1\xc1", (NodeEntities("/", "peer"),))
    writer.write(info.emit(size), network.now)
    return host, writer, reader


def _told(host: "Any") -> "list[int]":
    return [discovery_info.parse(event.payload)[1] for event in host.of(events.SampleReceived)]


def test_peers_up_to_humble_and_since_iron_each_get_the_gids_they_know() -> None:
    network = Network()
    one = Member(network)
    one.context.add_node("n", "/", network.now)
    new, _, _ = _teller(network, GID, contexts.WRITER_QOS.user_data)
    run(network, [one], 2)
    assert one.context._old_writer is None
    old, _, _ = _teller(network, OLD_GID, b"")
    late, _, _ = _teller(network, OLD_GID, b"")
    run(network, [one], 2)
    assert sorted([node.name for node in one.graph.nodes()]) == ["n", "peer", "peer", "peer"]
    one.context.add_node("m", "/", network.now)
    run(network, [one], 2)
    # The tellers hear each other as well: what we said is counted by whose it is.
    for host, size in ((new, GID), (old, OLD_GID), (late, OLD_GID)):
        ours = [
            discovery_info.parse(event.payload)
            for event in host.of(events.SampleReceived)
            if event.writer[:12] == one.participant.guid_prefix
        ]
        assert {found for _, found in ours} == {size}
        assert [node.name for node in ours[-1][0].nodes] == ["n", "m"]


def test_an_info_about_others_or_of_nonsense_is_dropped_and_counted() -> None:
    network = Network()
    one = Member(network)
    _, writer, _ = _teller(network, GID, contexts.WRITER_QOS.user_data)
    assert run(network, [one], 5, lambda: len(one.graph.nodes()) == 1)
    writer.write(ParticipantEntities(b"\7" * 16, (NodeEntities("/", "liar"),)).emit(), network.now)
    writer.write(b"\0\1\0\0nonsense", network.now)
    foreign = one.participant.guid_prefix + b"\0\0\1\3"
    stolen = ParticipantEntities(writer.data.guid, (NodeEntities("/", "thief", (), (foreign,)),))
    run(network, [one], 1)
    assert one.participant.counters == {
        "discovery-info-of-another-participant": 1,
        "discovery-info-truncated": 1,
    }
    writer.write(stolen.emit(), network.now)
    assert run(network, [one], 1, lambda: one.graph.nodes()[0].name == "thief")
    assert one.graph.node_of(foreign)[0] == graph.UNKNOWN_NAME


def test_bad_names_and_too_many_are_refused() -> None:
    network = Network()
    context = Context(network.host().participant, max_nodes=1, max_endpoints=1)
    context.start(network.now)
    with pytest.raises(InvalidName):
        context.add_node("a-b", "/", network.now)
    with pytest.raises(InvalidName):
        context.add_node("a", "no", network.now)
    node = context.add_node("a", "/", network.now)
    with pytest.raises(ValueError, match="at most 1 nodes"):
        context.add_node("b", "/", network.now)
    writer = context.create_writer(node, "rt/a", STRING, RELIABLE, "", network.now)
    assert writer.qos.user_data == b""
    with pytest.raises(ValueError, match="at most 1 endpoints"):
        context.create_writer(node, "rt/b", STRING, RELIABLE, "", network.now)
    context.delete_writer(node, writer, network.now)
    context.create_writer(node, "rt/b", STRING, RELIABLE, "", network.now)


def test_a_sink_is_handed_on() -> None:
    network = Network()
    one, other = Member(network), Member(network)
    got: list[bytes] = []
    reader = other.subscription(
        other.context.add_node("b", "/", network.now),
        "/t",
        sink=lambda proxy, value, time: got.append(bytes(value.payload)),
    )
    writer = one.publisher(one.context.add_node("a", "/", network.now), "/t")
    assert run(network, [one, other], 5, lambda: bool(writer.proxies and reader.proxies))
    writer.write(b"\0\1\0\0abcd", network.now)
    run(network, [one, other], 0.1)
    assert got == [b"\0\1\0\0abcd"]


def test_a_closed_context_has_told_that_its_nodes_are_gone() -> None:
    network = Network()
    one, other = Member(network), Member(network)
    one.context.add_node("n", "/", network.now)
    assert run(network, [one, other], 5, lambda: other.graph.nodes())
    one.context.close(network.now)
    network.run(0.01)
    assert run(network, [other], 0.01, lambda: not other.graph.nodes())


def test_an_info_of_one_who_has_just_gone_is_dropped_and_counted() -> None:
    network = Network()
    one = Member(network)
    peer, _, _ = _teller(network, GID, contexts.WRITER_QOS.user_data)
    assert run(network, [one], 5, lambda: len(one.graph.nodes()) == 1)
    prefix = peer.participant.guid_prefix
    one.graph.participant_lost(prefix)
    info = ParticipantEntities(prefix + b"\0\0\1\xc1", (NodeEntities("/", "late"),)).emit()
    reader = one.context._reader
    assert reader is not None
    sample = events.SampleReceived(reader.entity_id, prefix + b"\0\0\1\3", 9, info, None, FLAG_D, b"", True)
    assert one.context.handle_event(sample, network.now)
    assert one.participant.counters == {"discovery-info-of-unknown-participant": 1}


def test_one_who_offers_it_with_another_qos_is_counted() -> None:
    network = Network()
    one = Member(network)
    best = contexts.WRITER_QOS.replace(reliability=(qos.BEST_EFFORT, qos.DEFAULT_BLOCKING))
    other = network.host().participant
    other.create_writer(discovery_info.TOPIC, discovery_info.TYPE, best, network.now)
    counters = one.participant.counters
    assert run(network, [one], 5, lambda: counters.get("discovery-info-incompatible") == 1)
