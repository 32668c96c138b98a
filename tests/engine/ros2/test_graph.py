"""The graph knows when something is missing in it."""

import pytest

from roslet.engine.ros2.graph import Graph
from roslet.wire.discovery_info import NodeEntities, ParticipantEntities
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.guid import ENTITYID_PARTICIPANT
from roslet.wire.rtps.participant_data import ParticipantData
from roslet.wire.rtps.qos import Qos

pytestmark = pytest.mark.micropython

PREFIX = b"\x01\x0f" + bytes(9) + b"\x07"
WRITER = PREFIX + b"\x00\x00\x01\x03"


def participant(user_data: bytes) -> ParticipantData:
    return ParticipantData(PREFIX + ENTITYID_PARTICIPANT, user_data=user_data)


def test_a_graph_is_complete_once_all_that_was_told_of_is_known() -> None:
    graph = Graph()
    assert graph.complete()
    graph.participant_discovered(participant(b"enclave=/;"))
    assert not graph.complete()  # which nodes it has, it has not said
    node = NodeEntities("/", "talker", (), (WRITER,))
    graph.nodes_told(PREFIX, ParticipantEntities(PREFIX + ENTITYID_PARTICIPANT, (node,)))
    assert not graph.complete()  # the endpoint that it told of is not known
    endpoint = EndpointData(WRITER, "rt/chatter", "std_msgs::msg::dds_::String_")
    graph.endpoint_discovered(endpoint)
    assert graph.complete()
    assert graph.endpoint_data() == [endpoint]
    graph.participant_lost(PREFIX)
    assert graph.complete()
    assert graph.endpoint_data() == []


def test_a_participant_that_is_not_of_ros_has_nothing_to_tell() -> None:
    graph = Graph()
    graph.participant_discovered(participant(b""))
    assert graph.complete()


def test_the_hash_of_an_endpoint_is_what_it_announced() -> None:
    graph = Graph()
    assert graph.hash_of(WRITER) == ""
    policies = Qos(user_data=b"typehash=RIHS01_00;")
    graph.endpoint_discovered(EndpointData(WRITER, "rt/chatter", "std_msgs::msg::dds_::String_", policies))
    assert graph.hash_of(WRITER) == "RIHS01_00"
    graph.endpoint_lost(WRITER)
    assert graph.hash_of(WRITER) == ""
