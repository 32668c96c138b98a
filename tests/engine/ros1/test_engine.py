"""Engines that meet in virtual time: no sockets, every stream cut at odd places."""

from struct import pack

import pytest

from engine.ros1.network import MASTER, Host, Intruder, Network, header_bytes, linked, world
from roslet.engine.ros1 import engine as engine_module
from roslet.engine.ros1 import graph, links

pytestmark = pytest.mark.micropython

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


@pytest.mark.parametrize("piece", [1, 2, 3, 7, 50, 1000])
def test_messages_arrive_in_order_however_streams_are_cut(piece: int) -> None:
    network, _, talker, _, publication, _, got = linked(piece)
    sent = [b"%d" % index * (index % 40) for index in range(30)]
    for body in sent:
        talker.publish(publication, body)
        network.run(0.2)
    assert network.run(10.0, lambda: len(got) == len(sent))
    assert got == sent


def test_the_order_of_publisher_and_subscriber_does_not_matter() -> None:
    network, _, talker, listener = world()
    _, got = listener.subscriber("/chatter")
    network.run(1.0)
    publication = talker.publisher("/chatter")
    assert network.run(1.0, lambda: publication.links)
    talker.publish(publication, b"x")
    assert network.run(1.0, lambda: got == [b"x"])


def test_headers_say_what_the_protocol_asks_for() -> None:
    _, _, _, _, publication, subscription, _ = linked()
    (at_publisher,) = publication.links
    assert at_publisher.peer_header == {
        "callerid": "/listener",
        "md5sum": "m",
        "message_definition": "text",
        "tcp_nodelay": "1",
        "topic": "/chatter",
        "type": "t/T",
    }
    (at_subscriber,) = subscription.links.values()
    assert at_subscriber.peer_header == {
        "callerid": "/talker",
        "latching": "0",
        "md5sum": "m",
        "message_definition": "text",
        "topic": "/chatter",
        "type": "t/T",
    }


def test_a_node_does_not_connect_to_itself() -> None:
    network, master, talker, _ = world()
    publication = talker.publisher("/chatter")
    subscription, _ = talker.subscriber("/chatter")
    network.run(5.0)
    assert (
        master.topics["Publisher"]["/chatter"]
        == master.topics["Subscriber"]["/chatter"]
        == [talker.engine.uri]
    )
    assert not publication.links and not subscription.links


def test_several_subscriptions_of_one_topic_have_a_connection_each_and_one_registration() -> None:
    network, master, talker, listener, publication, first, got = linked()
    second, also = listener.subscriber("/chatter")
    assert network.run(1.0, lambda: len(publication.links) == 2)
    talker.publish(publication, b"x")
    assert network.run(1.0, lambda: got == also == [b"x"])
    listener.engine.unsubscribe(first, network.now)
    listener.update()
    network.run(1.0)
    assert len(publication.links) == 1
    assert master.topics["Subscriber"]["/chatter"] == [listener.engine.uri]
    listener.engine.unsubscribe(second, network.now)
    listener.update()
    network.run(1.0)
    assert master.topics["Subscriber"]["/chatter"] == [] and publication.links == ()


def test_nothing_reaches_the_sink_after_unsubscribing() -> None:
    network, _, talker, listener, publication, subscription, got = linked()
    for index in range(20):
        talker.publish(publication, b"%d" % index)
    network.run(1.0, lambda: len(got) >= 3)
    listener.engine.unsubscribe(subscription, network.now)
    listener.update()
    seen = len(got)
    network.run(2.0)
    assert len(got) == seen


def test_an_unadvertised_topic_disconnects_its_subscribers() -> None:
    network, master, talker, _, publication, subscription, _ = linked()
    talker.engine.unadvertise(publication, network.now)
    talker.update()
    network.run(1.0)
    assert subscription.links == {} and master.topics["Publisher"]["/chatter"] == []


# -- refusals


def test_a_wrong_md5sum_is_refused_counted_and_told_once() -> None:
    network, _, talker, listener = world()
    publication = talker.publisher("/chatter", md5sum="ours")
    subscription, got = listener.subscriber("/chatter", md5sum="theirs")
    network.run(20.0)
    assert not publication.links and not subscription.links and not got
    assert talker.engine.counters["md5sum-mismatch"] >= 2  # it is tried again, with growing pauses
    assert talker.engine.counters["md5sum-mismatch"] <= 12
    assert listener.engine.counters["refused-by-peer"] >= 2
    (note,) = [note for note in talker.notes if "md5sum" in note]
    assert "/listener expects t/T with md5sum theirs" in note
    assert len([note for note in listener.notes if "md5sum theirs" in note]) == 1


def test_a_publisher_with_another_md5sum_is_refused_by_us() -> None:
    network, _, talker, listener = world()
    publication = talker.publisher("/chatter")
    subscription, _ = listener.subscriber("/chatter", md5sum="m")
    assert network.run(2.0, lambda: publication.links)
    publication.md5sum = "other"
    publication.check = lambda fields: None  # a publisher that does not look
    publication.links[0].channel.lost("cut")
    network.run(2.0)
    assert subscription.links == {}
    assert listener.engine.counters["md5sum-mismatch"] >= 1
    assert any("the publisher sends t/T with md5sum other" in note for note in listener.notes)


def test_a_wrong_type_is_refused_where_the_md5sum_is_any() -> None:
    network, _, talker, listener = world()
    publication = talker.publisher("/chatter", kind="t/Other")
    listener.subscriber("/chatter", md5sum="*")
    network.run(2.0)
    assert not publication.links
    assert talker.engine.counters["type-mismatch"] >= 1


def test_any_type_and_any_md5sum_are_taken() -> None:
    network, _, talker, listener = world()
    publication = talker.publisher("/chatter")
    got: list[bytes] = []
    listener.engine.subscribe(
        "/chatter",
        "*",
        "*",
        "",
        lambda view, start, end, link: got.append(bytes(view[start:end])),
        network.now,
    )
    listener.update()
    assert network.run(2.0, lambda: publication.links)
    talker.publish(publication, b"raw")
    assert network.run(1.0, lambda: got == [b"raw"])


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (header_bytes(callerid="/x", md5sum="m", topic="/nothing", type="t/T"), "unknown-topic"),
        (header_bytes(callerid="/x", md5sum="m", service="/nothing"), "unknown-service"),
        (header_bytes(callerid="/x", md5sum="m"), "header-field-missing"),
        (header_bytes(md5sum="m", topic="/chatter"), "header-field-missing"),
        (header_bytes(callerid="/x", topic="/chatter"), "header-field-missing"),
        (header_bytes(callerid="/\x01", md5sum="m", topic="/chatter"), "bad-callerid"),
        (header_bytes(callerid="/" + "x" * 5000, md5sum="m", topic="/chatter"), "bad-callerid"),
        (b"\x03\x00\x00\x00abc", "header-truncated"),
        (b"\x05\x00\x00\x00\x01\x00\x00\x00a", "header-field-without-equals"),
        (b"\x07\x00\x00\x00\x03\x00\x00\x00a=\xff", "header-not-utf-8"),
        (pack("<I", 1 << 30), "header-too-large"),
        (b"GET / HTTP/1.1\r\n\r\n", "header-too-large"),
        (b"", "closed-before-header"),
        (b"\x03\x00", "closed-before-header"),
    ],
)
def test_what_is_no_header_of_a_peer_is_refused_under_its_name(data: bytes, reason: str) -> None:
    network, _, talker, _ = world()
    talker.publisher("/chatter")
    network.run(1.0)
    intruder = Intruder(network, ("alpha", 5001), data)
    network.run(0.5)
    intruder.end.close()
    network.run(0.5)
    assert talker.engine.counters == {reason: 1}
    if not reason.startswith("closed"):
        assert b"error=" in intruder.heard


def test_a_silent_connection_is_given_up() -> None:
    network, _, talker, _ = world()
    intruder = Intruder(network, ("alpha", 5001), b"\x10")
    network.run(links.HANDSHAKE_TIMEOUT - 1)
    assert intruder.end.alive
    network.run(2.0)
    assert not intruder.end.alive
    assert talker.engine.counters == {"handshake-timeout": 1}


def test_what_a_subscriber_sends_to_a_publisher_is_dropped_and_counted() -> None:
    network, _, talker, _ = world()
    publication = talker.publisher("/chatter")
    network.run(1.0)
    header = header_bytes(callerid="/x", md5sum="m", topic="/chatter")
    intruder = Intruder(network, ("alpha", 5001), header + b"junk" * 500)
    network.run(1.0)
    assert talker.engine.counters["data-from-subscriber"] >= 1
    talker.publish(publication, b"fine")
    network.run(1.0)
    assert intruder.heard.endswith(b"\x04\x00\x00\x00fine")


def test_an_echo_of_what_a_peer_said_is_short() -> None:
    network, _, talker, _ = world(piece=100000)
    talker.publisher("/chatter")
    network.run(1.0)
    header = header_bytes(callerid="/x", md5sum="m" * 100000, topic="/chatter", type="t" * 100000)
    intruder = Intruder(network, ("alpha", 5001), header)
    network.run(1.0)
    assert b"error=" in intruder.heard and len(intruder.heard) < 1500
    assert all(len(note) < 1500 for note in talker.notes)


def test_a_frame_beyond_the_bound_ends_the_link_and_is_tried_with_growing_pauses() -> None:
    network, _, talker, listener, publication, _subscription, got = linked(max_frame=100)
    for _ in range(200):
        talker.publish(publication, bytes(101))
        network.run(0.1)
    count = listener.engine.counters["frame-too-large"]
    assert 3 <= count <= 12
    assert got == []
    assert len([note for note in listener.notes if "at most 100 are accepted" in note]) == 1
    network.run(5.0, lambda: publication.links)
    talker.publish(publication, bytes(100))
    assert network.run(5.0, lambda: len(got) == 1)


def test_a_slow_reader_loses_its_oldest_messages_and_nobody_else_does() -> None:
    network, _, talker, _, publication, _, got = linked()
    third = Host(network, "/slow", "gamma")
    _, slowly = third.subscriber("/chatter")
    assert network.run(2.0, lambda: len(publication.links) == 2)
    (slow,) = [link for link in publication.links if link.callerid == "/slow"]
    slow.channel.peer.reading = False
    for index in range(100):
        talker.publish(publication, b"%d" % index)
        network.run(0.01)
    assert len(got) == 100
    assert len(slow.queue) == publication.depth and slow.queue.dropped == 90
    slow.channel.peer.reading = True
    talker.publish(publication, b"last")
    network.run(1.0)
    assert slowly == [b"%d" % index for index in range(91, 100)] + [b"last"]


# -- comings and goings


def test_a_publisher_that_dies_and_returns_is_found_again() -> None:
    network, _, talker, listener, _, subscription, got = linked()
    talker.crash()
    network.run(2.0)
    assert subscription.links == {}
    assert listener.engine.counters["publisher-lost"] == 1
    again = Host(network, "/talker", "alpha", 6000)
    publication = again.publisher("/chatter")
    assert network.run(5.0, lambda: publication.links)
    again.publish(publication, b"back")
    assert network.run(1.0, lambda: got == [b"back"])


def test_a_publisher_that_is_gone_is_asked_with_growing_pauses() -> None:
    network, _, talker, listener, _, _subscription, _ = linked()
    talker.crash()
    attempts = []
    plain = network.connect

    def connect(owner: "Any", machine: "Any", address: "tuple[str, int]") -> "Any":
        if address[0] == "alpha":
            attempts.append(network.now)
        return plain(owner, machine, address)

    network.connect = connect  # type: ignore[method-assign]
    network.run(30.0)
    pauses = [later - earlier for earlier, later in zip(attempts, attempts[1:])]  # noqa: B905, RUF007 - MicroPython
    assert len(attempts) <= 14
    assert pauses == sorted(pauses) and pauses[-1] == pytest.approx(graph.RETRY_LAST, 0.01)
    assert len([note for note in listener.notes if "no connection to" in note]) == 1


def test_a_peer_killed_within_a_message_is_counted_and_nothing_is_delivered() -> None:
    network, _, talker, listener, publication, _, got = linked(piece=10)
    talker.publish(publication, bytes(1000))
    network.run(0.02)
    talker.crash()
    network.run(1.0)
    assert got == []
    assert listener.engine.counters["frame-truncated"] == 1


def test_frames_queued_for_a_subscriber_that_dies_are_counted() -> None:
    network, _, talker, listener, publication, _, _ = linked()
    publication.links[0].channel.peer.reading = False
    for _ in range(5):
        talker.publish(publication, b"x")
    listener.crash()
    network.run(1.0)
    assert talker.engine.counters == {"queued-for-lost-subscriber": 5}
    assert publication.links == () and publication.dropped == 5


def test_publisher_update_carries_the_whole_list() -> None:
    network, master, _talker, listener, _, subscription, _ = linked()
    other = Host(network, "/other", "gamma")
    second = other.publisher("/chatter")
    assert network.run(1.0, lambda: len(subscription.links) == 2)
    master.tell(listener.engine.uri, "publisherUpdate", "/chatter", [other.engine.uri])
    network.run(1.0)
    assert list(subscription.links) == [other.engine.uri] and len(second.links) == 1
    master.tell(listener.engine.uri, "publisherUpdate", "/chatter", [])
    network.run(1.0)
    assert subscription.links == {} and second.links == ()


def test_a_list_of_publishers_with_garbage_is_bounded_and_counted() -> None:
    network, master, _, listener, publication, subscription, _ = linked()
    talker_uri = publication.engine.uri
    garbage: list[Any] = [
        1,
        [],
        "",
        "nonsense",
        "http://x:99999",
        "http://x:\u00b2/",
        talker_uri,
        talker_uri,
        {},
    ]
    master.tell(listener.engine.uri, "publisherUpdate", "/chatter", garbage)
    master.tell(listener.engine.uri, "publisherUpdate", "/unknown", ["http://x:1/"])
    master.tell(listener.engine.uri, "publisherUpdate", 5, ["http://x:1/"])
    master.tell(listener.engine.uri, "publisherUpdate", "/chatter", "no list")
    network.run(1.0)
    assert list(subscription.links) == [talker_uri]
    assert listener.engine.counters == {"bad-publisher-uri": 7, "update-of-unknown-topic": 1}


def test_a_list_of_thousands_of_publishers_costs_a_bounded_number_of_connections() -> None:
    network, master, _, listener, _, subscription, _ = linked()
    network.vanished.append("nowhere")
    uris = ["http://nowhere:%d/" % (1000 + index) for index in range(graph.MAX_PUBLISHERS + 500)]
    master.tell(listener.engine.uri, "publisherUpdate", "/chatter", uris)
    network.run(2.0)
    open_now = [end for end in network.ends if end.owner is listener and end.alive and not end.connected]
    assert 0 < len(open_now) <= engine_module.MAX_SLAVE_CALLS
    assert listener.engine.counters["too-many-publishers"] == 1
    assert len(subscription.publishers) == graph.MAX_PUBLISHERS


def test_a_publisher_that_answers_nonsense_is_refused_under_its_name() -> None:
    network, master, _, listener = world()
    fake = Host(network, "/fake", "fake")
    answers: list[Any] = [
        ([1, "", ["TCPROS", "fake", 0]], "bad-publisher-uri"),
        ([1, "", ["TCPROS", "fake", True]], "no-common-transport"),
        ([1, "", ["TCPROS", "fake"]], "no-common-transport"),
        ([1, "", []], "no-common-transport"),
        ([1, "", "TCPROS"], "no-common-transport"),
        ([1, "", ["UDPROS", "fake", 1, 1, 1500, b""]], "no-common-transport"),
        ([1, "", ["X" * 10000]], "no-common-transport"),
    ]
    for index, (answer, reason) in enumerate(answers):
        topic = "/t%d" % index
        fake.engine.slave.methods["requestTopic"] = (lambda *given, answer=answer: answer, 3, 3)
        subscription, _ = listener.subscriber(topic)
        network.run(0.2)
        master.tell(listener.engine.uri, "publisherUpdate", topic, [fake.engine.uri])
        network.run(0.1)
        assert listener.engine.counters == {reason: 1}, answer
        assert not subscription.links
        listener.engine.unsubscribe(subscription, network.now)
        listener.update()
        network.run(0.5)
        listener.engine.counters.clear()
    assert all(len(note) < 1000 for note in listener.notes)


def test_a_vanished_publisher_host_is_given_up_in_time() -> None:
    network, master, _, listener = world()
    network.vanished.append("nowhere")
    subscription, _ = listener.subscriber("/chatter")
    network.run(1.0)
    master.tell(listener.engine.uri, "publisherUpdate", "/chatter", ["http://nowhere:5/"])
    network.run(engine_module.CALL_TIMEOUT + 1)
    assert len(subscription._retry) == 1, "it is asked again"
    network.run(60.0)
    assert len([end for end in network.ends if end.owner is listener and end.alive]) <= 3


# -- parameters


def test_a_watched_parameter_is_told_and_kept() -> None:
    network, master, talker, listener = world()
    seen: list[Any] = []
    talker.engine.on_parameter = lambda key, value: seen.append((key, value))
    first: list[Any] = []
    talker.engine.watch_parameter("/ns", lambda value, error, now: first.append(value), network.now)
    talker.update()
    network.run(1.0)
    assert first == [{}]
    listener.ask_master("setParam", "/ns", 1)
    network.run(0.5)
    listener.ask_master("setParam", "/ns/deep", "x")
    network.run(0.5)
    assert seen == [("/ns", 1), ("/ns", {"deep": "x"})]
    assert talker.engine.parameters == {"/ns": {"deep": "x"}}
    master.tell(talker.engine.uri, "paramUpdate", "/ns/", 2)  # rosmaster puts a slash at the end
    master.tell(talker.engine.uri, "paramUpdate", "/nsx", 3)
    master.tell(talker.engine.uri, "paramUpdate", 4, 4)
    network.run(0.5)
    assert talker.engine.parameters == {"/ns": 2}
    assert talker.engine.counters == {"parameter-not-subscribed": 1}
    talker.engine.unwatch_parameter("/ns", network.now)
    talker.update()
    network.run(0.5)
    assert master.watchers == {"/ns": []}


def test_a_master_uri_must_be_one() -> None:
    assert MASTER == "http://master:11311"
    network = Network()
    host = Host(network, "/x", "alpha")
    failed: list[Any] = []
    host.engine.call_slave("nonsense", "getPid", [], lambda *given: failed.append(given[1]), network.now)
    assert "no URI" in str(failed[0])


# -- the slave API


def test_the_slave_api_tells_what_the_node_has() -> None:
    _, _, talker, listener, _publication, _, _ = linked()
    slave: Any = talker.engine.slave
    other: Any = listener.engine.slave
    assert slave.get_pid("/x") == [1, "process id", 42]
    assert slave.get_name("/x")[2] == "/talker"
    assert slave.get_master_uri("/x")[2] == MASTER
    assert slave.get_publications("/x")[2] == [["/chatter", "t/T"]]
    assert other.get_subscriptions("/x")[2] == [["/chatter", "t/T"]]
    (row,) = slave.get_bus_info("/x")[2]
    assert row == [1, "/listener", "o", "TCPROS", "/chatter", True, "simulated"]
    (row,) = other.get_bus_info("/x")[2]
    assert row[1:6] == [talker.engine.uri, "i", "TCPROS", "/chatter", True]
    published, subscribed, services = slave.get_bus_stats("/x")[2]
    assert published == [["/chatter", 0, [[1, 0, 0, True]]]] and subscribed == [] and services == [0, 0, 0]


@pytest.mark.parametrize(
    "protocols", [[], [["X"]], "TCPROS", [[]], [5], [["UDPROS"]], [["UDPROS", 1, 2, 3, 4]], {}]
)
def test_a_request_for_no_transport_of_ours_fails(protocols: "Any") -> None:
    _network, _, talker, _ = world()
    talker.publisher("/chatter")
    assert talker.engine.slave.request_topic("/x", "/chatter", protocols)[0] != 1
    assert talker.engine.slave.request_topic("/x", "/nothing", [["TCPROS"]])[0] == 0
    assert talker.engine.counters["unknown-topic"] == 1


def test_reasons_have_a_bound() -> None:
    engine = Host(Network(), "/x", "alpha").engine
    for index in range(1000):
        engine.count("reason-%d" % index)
        engine.note_once(str(index), "text")
    assert len(engine.counters) == engine_module.MAX_REASONS
    engine.count("reason-0", 5)
    assert engine.counters["reason-0"] == 6
