"""Topics of ROS 2 nodes without any peer: within one process, and between two participants of it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import roslet
from nodes import wait_until
from ros2_nodes import DOMAIN, Ros2Nodes
from roslet.engine.rtps import events as facts
from roslet.gen.runtime import message_class
from roslet.io.select import reactor
from roslet.node import events
from roslet.node.ros2.topics import MAX_EARLY

STRING, UINT32 = "std_msgs/msg/String", "std_msgs/msg/UInt32"


@pytest.fixture
def serialised(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Every std_msgs/msg/UInt32 that is serialised from now on."""
    kind: Any = message_class("ros2", UINT32)
    kind().serialize()  # methods are compiled at their first use
    made: list[Any] = []
    for method in ("serialize_into", "serialize"):
        original = getattr(kind, method)

        def counting(self: Any, *arguments: Any, original: Callable[..., Any] = original) -> Any:
            made.append(self)
            return original(self, *arguments)

        monkeypatch.setattr(kind, method, counting)
    return made


def kinds(told: list[events.Event]) -> list[type]:
    return [type(one) for one in told]


def test_within_one_process_nothing_is_serialised(make2: Ros2Nodes, serialised: list[Any]) -> None:
    """Whether it is one node or two; each subscription has a copy of its own."""
    talker, listener = make2("talker"), make2("listener")
    publisher = talker.publisher("/chatter", UINT32)
    heard: list[Any] = []
    talker.subscribe("/chatter", UINT32, heard.append)
    listener.subscribe("/chatter", UINT32, heard.append)
    kind: Any = message_class("ros2", UINT32)
    message = kind(data=7)
    publisher.publish(message)
    wait_until(lambda: len(heard) == 2, "both hear it")
    assert serialised == []
    assert [one.data for one in heard] == [7, 7]
    assert len({id(one) for one in (message, *heard)}) == 3
    assert publisher.subscriber_count == 2
    assert publisher.statistics["messages"] == 1


def test_for_another_participant_it_is_serialised_once(make2: Ros2Nodes, serialised: list[Any]) -> None:
    talker = make2("talker")
    others = [make2(f"listener{k}", "--enclave", f"/k{k}") for k in range(2)]
    publisher = talker.publisher("/chatter", UINT32)
    heard: list[Any] = []
    for node in (talker, *others):
        node.subscribe("/chatter", UINT32, heard.append)
    assert publisher.wait_for_subscribers(3, timeout=8)
    publisher.publish(data=9)
    wait_until(lambda: len(heard) == 3, "all hear it")
    assert len(serialised) == 1


def test_a_late_subscription_of_the_process_gets_the_last_messages_where_both_are_transient_local(
    make2: Ros2Nodes,
) -> None:
    node = make2("node")
    kept = roslet.QoS(depth=3, durability="transient_local")
    recent = roslet.QoS(depth=10, durability="transient_local")
    publisher = node.publisher("/kept", UINT32, qos=kept)
    for number in range(5):
        publisher.publish(data=number)
    late: list[int] = []
    volatile: list[int] = []
    node.subscribe("/kept", UINT32, lambda message: volatile.append(message.data))
    node.subscribe("/kept", UINT32, lambda message: late.append(message.data), qos=recent)
    publisher.publish(data=5)
    wait_until(lambda: 5 in late and 5 in volatile, "both hear the last")
    assert late == [2, 3, 4, 5]
    assert volatile == [5]


@pytest.mark.parametrize(
    ("offered", "requested", "policies"),
    [
        ({"reliability": "best_effort"}, {}, ("reliability",)),
        ({}, {"durability": "transient_local"}, ("durability",)),
        ({}, {"deadline": 1.0}, ("deadline",)),
        ({}, {"liveliness": "manual_by_topic"}, ("liveliness",)),
        (
            {"reliability": "best_effort"},
            {"durability": "transient_local", "liveliness_lease": 2.0},
            ("reliability", "durability", "liveliness"),
        ),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_what_is_incompatible_within_one_process_is_told_at_both_ends(
    make2: Ros2Nodes, offered: dict[str, Any], requested: dict[str, Any], policies: tuple[str, ...]
) -> None:
    talker, listener = make2("talker"), make2("listener")
    heard: list[Any] = []
    subscription = listener.subscribe("/t", UINT32, heard.append, qos=roslet.QoS(**requested))
    publisher = talker.publisher("/t", UINT32, qos=roslet.QoS(**offered))
    there: list[events.Event] = []
    here: list[events.Event] = []
    publisher.on_event(there.append)
    subscription.on_event(here.append)
    wait_until(lambda: there and here, "both are told")
    for told, peer in ((there, "/listener"), (here, "/talker")):
        assert kinds(told) == [events.QosIncompatible]
        assert (told[0].peer, told[0].policies) == (peer, policies)  # type: ignore[attr-defined]
    assert there[0].gid == subscription.gid
    publisher.publish(data=1)
    talker.spin(0.05)
    assert heard == []
    assert publisher.subscriber_count == subscription.publisher_count == 0


def test_another_type_on_the_topic_is_not_heard(make2: Ros2Nodes) -> None:
    node = make2("node")
    heard: list[Any] = []
    subscription = node.subscribe("/t", STRING, heard.append)
    node.publisher("/t", UINT32).publish(data=1)
    node.spin(0.05)
    assert heard == []
    assert subscription.publisher_count == 0


def test_events_before_anybody_listens_are_told_to_the_first_listener(make2: Ros2Nodes) -> None:
    """The last of them; a second listener is told what comes."""
    node = make2("node")
    subscription = node.subscribe("/t", UINT32, lambda message: None)
    for _ in range(MAX_EARLY):
        node.publisher("/t", UINT32).close()
    first: list[events.Event] = []
    second: list[events.Event] = []
    subscription.on_event(first.append)
    subscription.on_event(second.append)
    wait_until(lambda: len(first) == MAX_EARLY, "what came before is told")
    assert kinds(first) == [events.Matched, events.Unmatched] * (MAX_EARLY // 2)
    node.publisher("/t", UINT32)
    wait_until(lambda: len(second) == 1, "what comes is told")
    assert kinds(second) == [events.Matched]
    assert len(first) == MAX_EARLY + 1


def test_nodes_of_one_network_share_a_participant_and_those_of_two_do_not(make2: Ros2Nodes) -> None:
    """Two URLs of one domain are two participants, which find each other like any others; two domains do not."""
    one, same = make2("one"), make2("same")
    other = make2("other", network=f"ros2://{DOMAIN}?range=localhost&interface=lo")
    elsewhere = make2("elsewhere", network=f"ros2://{DOMAIN + 1}?range=localhost")
    participants = [node._network.shell.participant for node in (one, same, other, elsewhere)]  # type: ignore[attr-defined]
    assert len({id(one) for one in participants}) == 3
    assert participants[0] is participants[1]
    inboxes: dict[str, list[tuple[Any, Any]]] = {}

    def listen(node: roslet.Node) -> None:
        inbox = inboxes[node.name] = []

        def heard(message: Any, link: Any = None) -> None:
            inbox.append((message.data, link))

        node.subscribe("/t", UINT32, heard, with_link=True)

    for node in (same, other, elsewhere):
        listen(node)
    publisher = one.publisher("/t", UINT32)
    assert publisher.wait_for_subscribers(2, timeout=8)
    publisher.publish(data=3)
    wait_until(lambda: inboxes["/same"] and inboxes["/other"], "both of the domain hear it")
    one.spin(0.1)
    assert inboxes["/same"] == [(3, None)]
    assert inboxes["/elsewhere"] == []
    # What came by the network has a sender.
    ((number, link),) = inboxes["/other"]
    assert number == 3
    assert link.publisher_gid == publisher.gid
    assert link.sequence_number == 1
    assert 0 <= link.received_timestamp - link.source_timestamp < 10**10
    wait_until(lambda: one.nodes() == ["/one", "/other", "/same"], "the nodes of the domain are known")


def test_keep_all_keeps_all_for_whoever_does_not_spin(make2: Ros2Nodes) -> None:
    talker, listener = make2("talker"), make2("listener", "--enclave", "/k")
    everything = roslet.QoS(history="keep_all")
    near = talker.subscribe("/t", UINT32, qos=everything)
    far = listener.subscribe("/t", UINT32, qos=everything)
    short = talker.subscribe("/t", UINT32, qos=5)
    publisher = talker.publisher("/t", UINT32, qos=everything)
    assert publisher.wait_for_subscribers(3, timeout=8)
    for number in range(500):
        publisher.publish(data=number)
    for subscription in (near, far):
        assert [subscription.take(5.0).data for _ in range(500)] == list(range(500))
    assert short.take(5.0).data == 495
    assert short.statistics["dropped"] == 495


def test_what_is_closed_says_so_and_its_peers_are_told(make2: Ros2Nodes) -> None:
    node = make2("node")
    publisher = node.publisher("/t", UINT32)
    subscription = node.subscribe("/t", UINT32, lambda message: None)
    told: list[events.Event] = []
    subscription.on_event(told.append)
    assert subscription.publisher_count == 1
    publisher.close()
    publisher.close()
    assert subscription.publisher_count == 0
    wait_until(lambda: kinds(told) == [events.Matched, events.Unmatched], "the subscription is told")
    with pytest.raises(roslet.NodeClosed):
        publisher.publish(data=1)
    with pytest.raises(roslet.NodeClosed):
        _ = publisher.gid
    subscription.close()
    subscription.close()
    with pytest.raises(roslet.NodeClosed):
        _ = subscription.gid


def test_a_subscription_of_any_type_gets_the_bytes(make2: Ros2Nodes) -> None:
    talker, listener = make2("talker"), make2("listener", "--enclave", "/k")
    publisher = talker.publisher("/t", UINT32)
    wait_until(lambda: "/t" in listener.topics(), "the topic is known")
    heard: list[Any] = []
    for node in (talker, listener):
        node.subscribe("/t", "*", heard.append)
    assert publisher.wait_for_subscribers(2, timeout=8)
    publisher.publish(data=0x01020304)
    wait_until(lambda: len(heard) == 2, "both hear it")
    kind = message_class("ros2", UINT32)
    for one in heard:
        assert (one.type, one.data) == (UINT32, b"\0\1\0\0\4\3\2\1")
        assert one.md5sum == kind._type_hash
    with pytest.raises(roslet.Unsupported, match="nobody publishes it yet"):
        talker.subscribe("/nothing", "*", heard.append)


@pytest.mark.parametrize("size", [100, 8_191, 59_990, 60_010, 64_990, 65_010, 65_530, 65_540, 200_000])
def test_what_waits_for_a_spin_is_not_overwritten_by_what_comes_behind_it(
    make2: Ros2Nodes, size: int
) -> None:
    """Around each size at which a sample takes another way: buffers, datagrams, fragments."""
    talker, listener = make2("talker"), make2("listener", "--enclave", "/other")
    publisher = talker.publisher("/chatter", STRING, qos=roslet.QoS(30))
    heard: list[Any] = []
    subscription = listener.subscribe("/chatter", STRING, heard.append, qos=roslet.QoS(30))
    assert publisher.wait_for_subscribers(1, timeout=8) and subscription.wait_for_publishers(1, timeout=8)
    texts = [chr(97 + k) * size for k in range(20)]
    for text in texts:
        publisher.publish(data=text)
    # The background thread receives them all; nobody spins meanwhile.
    assert reactor().run_until(lambda: len(subscription._arrived) == 20, 8.0, user=False)
    assert heard == []
    wait_until(lambda: len(heard) == 20, "all are delivered")
    assert [message.data for message in heard] == texts


def test_a_deadline_within_one_process_is_missed_as_between_two(make2: Ros2Nodes) -> None:
    node = make2("node")
    qos = roslet.QoS(1, deadline=0.1)
    publisher = node.publisher("/chatter", UINT32, qos=qos)
    subscription = node.subscribe("/chatter", UINT32, lambda message: None, qos=qos)
    told: list[tuple[str, type]] = []
    publisher.on_event(lambda event: told.append(("publisher", type(event))))
    subscription.on_event(lambda event: told.append(("subscription", type(event))))
    publisher.publish(data=1)
    for end in ("publisher", "subscription"):
        wait_until(lambda end=end: (end, events.DeadlineMissed) in told, end)  # type: ignore[misc]


def test_what_has_outlived_its_lifespan_is_not_given_to_a_late_subscription(make2: Ros2Nodes) -> None:
    node = make2("node")
    for topic, lifespan, expected in (("/short", 0.05, []), ("/long", 60.0, [7])):
        qos = roslet.QoS(5, durability="transient_local", lifespan=lifespan)
        node.publisher(topic, UINT32, qos=qos).publish(data=7)
        node.sleep(0.1)
        heard: list[Any] = []
        node.subscribe(topic, UINT32, heard.append, qos=roslet.QoS(5, durability="transient_local"))
        node.sleep(0.1)
        assert [message.data for message in heard] == expected


def test_a_message_longer_than_the_subscription_allows_is_dropped_and_counted(make2: Ros2Nodes) -> None:
    talker, listener = make2("talker"), make2("listener", "--enclave", "/k")
    publisher = talker.publisher("/t", STRING)
    heard: list[Any] = []
    listener.subscribe("/t", STRING, heard.append, max_message=100)
    assert publisher.wait_for_subscribers(1, timeout=8)
    publisher.publish(data="x" * 100)
    publisher.publish(data="short")
    wait_until(lambda: heard, "the short one comes")
    assert [one.data for one in heard] == ["short"]
    assert listener.counters["message-too-large"] == 1


def test_messages_that_will_never_come_are_told_and_counted(make2: Ros2Nodes) -> None:
    node = make2("node")
    subscription: Any = node.subscribe("/t", UINT32, lambda message: None)
    told: list[Any] = []
    subscription.on_event(told.append)
    subscription._happened(facts.SamplesLost(b"\0\0\1\4", bytes(16), 3))
    wait_until(lambda: told, "it is told")
    assert kinds(told) == [events.MessagesLost] and told[0].count == 3
    assert node.counters["messages-lost"] == 1


def test_datagrams_that_the_kernel_does_not_take_are_counted(make2: Ros2Nodes) -> None:
    node: Any = make2("node")
    with node.reactor.lock:
        node._network.shell.domain._send((b"x",), [("255.255.255.255", 9)])  # SO_BROADCAST is not set
    assert node.counters["datagram-not-sent"] == 1


def test_a_node_beyond_the_bound_leaves_nothing_behind(make2: Ros2Nodes) -> None:
    first: Any = make2("first")
    process = first._network.process
    process.shell.context._max_nodes = 1
    with pytest.raises(ValueError, match="at most 1 nodes"):
        make2("second")
    assert process.users == 1
    first.close()
    assert process.users == 0 and process.shell._closed
