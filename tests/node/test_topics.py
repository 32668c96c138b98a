"""Publishing and subscribing over loopback and within one node."""

from __future__ import annotations

import asyncio
import threading
import time
from typing import Any

import pytest

import roslet
from nodes import Nodes, Raw, ros1, serve, string_subscriber, wait_until
from roslet.node.ros1 import topics

STRING = "std_msgs/String"


def pair(make: Nodes, **qos: Any) -> tuple[roslet.Node, roslet.Node, roslet.Publisher, list[Any]]:
    a, b = make("a"), make("b")
    publisher = a.publisher("chatter", STRING, qos=roslet.QoS(**qos) if qos else None)
    got: list[Any] = []
    b.subscribe("chatter", STRING, got.append)
    assert publisher.wait_for_subscribers(1, 5)
    return a, b, publisher, got


def test_messages_arrive_whole_and_in_order(make: Nodes) -> None:
    _, b, publisher, got = pair(make)
    sent = ["x" * size for size in (0, 1, 100, 70_000, 5, 3_000_000, 2)]
    for text in sent:
        publisher.publish(data=text)
        assert b.spin_until(lambda text=text: got and got[-1].data == text, 5)  # type: ignore[misc]
    assert [message.data for message in got] == sent
    assert publisher.statistics == {"messages": 7, "dropped": 0, "subscribers": 1}


def test_a_burst_is_lost_only_where_it_is_counted(make: Nodes) -> None:
    a, b, publisher, got = pair(make, depth=5)
    for index in range(2000):
        publisher.publish(data=f"{index} " + "x" * 10_000)
    wait_until(lambda: got and got[-1].data.startswith("1999 "), "the last message arrives")
    numbers = [int(message.data.split()[0]) for message in got]
    assert numbers == sorted(set(numbers))
    dropped = publisher.statistics["dropped"]
    assert dropped > 0 and len(numbers) + dropped == 2000
    assert a.counters == {"send-queue-full": dropped}
    assert b.counters == {}


def test_with_keep_all_nothing_is_lost(make: Nodes) -> None:
    a, _b, publisher, got = pair(make, history="keep_all")

    def publish() -> None:
        for index in range(2000):
            publisher.publish(data=f"{index} " + "x" * 10_000)

    thread = threading.Thread(target=publish)
    thread.start()
    wait_until(lambda: len(got) == 2000, "all messages arrive")
    thread.join()
    assert [int(message.data.split()[0]) for message in got] == list(range(2000))
    assert a.counters == {} and publisher.statistics["dropped"] == 0


def test_with_keep_all_a_reader_that_is_stuck_is_waited_for_and_then_dropped_for(
    make: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(topics, "MAX_BLOCKING", 0.3)
    a = make("a")
    publisher = a.publisher("chatter", STRING, qos=roslet.QoS(history="keep_all"))
    with string_subscriber(a, "/chatter") as raw:
        assert raw.read_header()["type"] == STRING
        wait_until(lambda: publisher.subscriber_count == 1, "it is connected")
        begin = time.monotonic()
        for _ in range(4):
            publisher.publish(data="x" * 20_000_000)
        took = time.monotonic() - begin
        assert 1.0 < took < 3.0
        assert a.counters["blocked-too-long"] >= 3
        raw.sock.settimeout(5)
        assert len(raw.read_frame()) == 20_000_004, "a message that has begun ends"
        begin = time.monotonic()
        assert a.call_master("getPid", timeout=1.0), "the loop has not been blocked"
        assert time.monotonic() - begin < 0.5


def test_the_loop_serves_others_while_a_publisher_is_blocked(
    make: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(topics, "MAX_BLOCKING", 1.5)
    a = make("a")
    publisher = a.publisher("chatter", STRING, qos=roslet.QoS(history="keep_all"))
    with string_subscriber(a, "/chatter") as stuck:
        stuck.read_header()
        wait_until(lambda: publisher.subscriber_count == 1, "it is connected")
        thread = threading.Thread(target=publisher.publish, kwargs={"data": "x" * 20_000_000})
        thread.start()
        time.sleep(0.1)
        slowest = 0.0
        with string_subscriber(a, "/chatter") as late:  # its connection waits for the lock; the loop does not
            late.read_header()
            while thread.is_alive():
                begin = time.monotonic()
                a.call_master("getPid")
                slowest = max(slowest, time.monotonic() - begin)
                time.sleep(0.01)
            thread.join()
            assert slowest < 0.5
            wait_until(lambda: publisher.subscriber_count == 2, "the late one is connected in the end")
            publisher.publish(data="later")
            assert late.read_frame() == b"\x05\0\0\0later"


def test_a_late_subscriber_of_a_latched_topic_gets_the_last_message_once(make: Nodes) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("map", STRING, qos=roslet.QoS(durability="transient_local"))
    publisher.publish(data="old")
    publisher.publish(data="new")
    first, second = b.subscribe("map", STRING), a.subscribe("map", STRING)
    for subscription in (first, second):
        message = subscription.take(5)
        assert message is not None and message.data == "new"
        assert subscription.take(0.1) is None


def test_no_latched_message_comes_twice_or_is_missed_while_publishing(make: Nodes) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("map", STRING, qos=roslet.QoS(durability="transient_local", history="keep_all"))
    stop = threading.Event()

    def publish() -> None:
        index = 0
        while not stop.is_set():
            publisher.publish(data=str(index))
            index += 1
            time.sleep(0.0002)

    thread = threading.Thread(target=publish)
    thread.start()
    try:
        for _ in range(10):
            got: list[Any] = []
            subscription = b.subscribe("map", STRING, got.append)
            wait_until(lambda got=got: len(got) >= 5, "messages come")  # type: ignore[misc]
            numbers = [int(message.data) for message in got]
            assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
            subscription.close()
    finally:
        stop.set()
        thread.join()


def test_a_subscription_without_a_type_gets_raw_messages(make: Nodes) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("chatter", STRING)
    raw = b.subscribe("chatter")
    assert publisher.wait_for_subscribers(1, 5)
    publisher.publish(data="hi")
    message = raw.take(5)
    assert isinstance(message, roslet.RawMessage)
    assert (message.data, message.type) == (b"\x02\0\0\0hi", STRING)
    assert message.md5sum == "992ce8a1687cec8c8bd883ec73ca41d1" and "string data" in message.definition


def test_take_waits_gives_the_oldest_and_ends_with_the_subscription(make: Nodes) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("chatter", STRING)
    subscription = b.subscribe("chatter", STRING, qos=3)
    assert publisher.wait_for_subscribers(1, 5)
    begin = time.monotonic()
    assert subscription.take(0.2) is None
    assert 0.15 < time.monotonic() - begin < 1.0
    for index in range(5):
        publisher.publish(data=str(index))
    wait_until(lambda: subscription.messages == 5, "all arrive")
    assert [subscription.take(1).data for _ in range(3)] == ["2", "3", "4"]
    assert subscription.statistics["dropped"] == 2 and b.counters == {"receive-queue-full": 2}
    subscription.close()
    assert subscription.take() is None
    with pytest.raises(TypeError, match="has a callback"):
        b.subscribe("chatter", STRING, print).take()


def test_async_for_gets_every_message_and_ends_when_closed(make: Nodes) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("chatter", STRING)
    subscription = b.subscribe("chatter", STRING, qos=100)
    assert publisher.wait_for_subscribers(1, 5)

    async def consume() -> list[str]:
        got = []
        async for message in subscription:
            got.append(message.data)
            if len(got) == 50:
                subscription.close()
        return got

    async def produce() -> None:
        for index in range(50):
            publisher.publish(data=str(index))
            await asyncio.sleep(0.001)

    async def main() -> list[str]:
        consumer = asyncio.create_task(consume())
        await produce()
        return await asyncio.wait_for(consumer, 5)

    assert asyncio.run(main()) == [str(index) for index in range(50)]


def test_asyncio_loops_come_and_go(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    subscription = a.subscribe("chatter", STRING)

    async def once(text: str) -> str:
        publisher.publish(data=text)
        async for message in subscription:
            return str(message.data)
        return ""

    for index in range(5):
        assert asyncio.run(asyncio.wait_for(once(str(index)), 5)) == str(index)


def test_within_a_node_every_subscription_gets_a_message_of_its_own(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("chatter", "geometry_msgs/PointStamped")
    first, second = a.subscribe("chatter", publisher.type), a.subscribe("chatter", publisher.type)
    message: Any = publisher.type()
    message.point.x = 1.0
    publisher.publish(message)
    message.point.x = 2.0
    one, two = first.take(2), second.take(2)
    one.point.y = 5.0
    assert (one.point.x, two.point.x, two.point.y) == (1.0, 1.0, 0.0)
    assert one is not two and one is not message
    assert publisher.subscriber_count == 2 and first.publisher_count == 1


def test_within_a_node_a_full_queue_drops_its_oldest_and_counts(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    got: list[str] = []
    subscription = a.subscribe("chatter", STRING, lambda message: got.append(message.data), qos=4)
    for index in range(10):
        publisher.publish(data=str(index))
    assert len(a.reactor._user_soon) <= 2, "waiting messages do not fill the loop's own queue"
    a.spin_once()
    a.spin_once()
    assert got == ["6", "7", "8", "9"]
    assert subscription.statistics["dropped"] == 6 and a.counters == {"receive-queue-full": 6}


def test_a_local_subscription_that_closes_gets_nothing_more(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    got: list[Any] = []
    subscription = a.subscribe("chatter", STRING, got.append)
    publisher.publish(data="1")
    subscription.close()
    publisher.publish(data="2")
    a.spin_once()
    assert got == [] and publisher.subscriber_count == 0


def test_no_callback_runs_after_close(make: Nodes) -> None:
    _, b, publisher, got = pair(make)
    subscription = ros1(b)._subscriptions[0]

    def callback(message: Any) -> None:
        got.append(message)
        subscription.close()

    subscription._callback = callback
    for index in range(20):
        publisher.publish(data=str(index))
    serve(0.3)
    assert [message.data for message in got] == ["0"]


def test_an_exception_of_a_callback_comes_out_of_spin_and_loses_nothing(make: Nodes) -> None:
    _, b, publisher, got = pair(make)
    subscription = ros1(b)._subscriptions[0]

    def callback(message: Any) -> None:
        got.append(message.data)
        if message.data == "1":
            raise ValueError("mine")

    subscription._callback = callback
    for index in range(4):
        publisher.publish(data=str(index))
    with pytest.raises(ValueError, match="mine"):
        b.spin(3)
    b.spin_until(lambda: len(got) == 4, 3)
    assert got == ["0", "1", "2", "3"]


def test_ctrl_c_in_a_callback_leaves_the_connection_whole(make: Nodes) -> None:
    _, b, publisher, got = pair(make)

    def callback(message: Any) -> None:
        got.append(message.data)
        if message.data == "1":
            raise KeyboardInterrupt

    ros1(b)._subscriptions[0]._callback = callback
    for index in range(4):
        publisher.publish(data=str(index))
    with pytest.raises(KeyboardInterrupt):
        b.spin(3)
    publisher.publish(data="4")
    b.spin_until(lambda: len(got) == 5, 3)
    assert got == ["0", "1", "2", "3", "4"]


def test_publishing_takes_messages_dicts_and_equal_classes_and_refuses_others(make: Nodes) -> None:
    _a, b, publisher, got = pair(make)
    publisher.publish({"data": "dict"})
    kind: Any = publisher.type
    publisher.publish(kind(data="message"))
    b.spin_until(lambda: len(got) == 2, 3)
    assert [message.data for message in got] == ["dict", "message"]
    from roslet.msgs.ros1.std_msgs.msg import Int32

    with pytest.raises(TypeError, match="/chatter carries std_msgs/String, not std_msgs/Int32"):
        publisher.publish(Int32(data=1))
    with pytest.raises(TypeError, match="not both"):
        publisher.publish(publisher.type(), data="x")
    with pytest.raises(roslet.InvalidMessage, match="data"):
        publisher.publish(data=5)
    assert publisher.statistics["messages"] == 2
    publisher.publish(data="fine")
    b.spin_until(lambda: len(got) == 3, 3)


def test_a_header_gets_consecutive_sequence_numbers(make: Nodes) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("point", "geometry_msgs/PointStamped")
    subscription = b.subscribe("point", publisher.type)
    assert publisher.wait_for_subscribers(1, 5)
    for _ in range(3):
        publisher.publish()
    assert [subscription.take(3).header.seq for _ in range(3)] == [1, 2, 3]


def test_a_topic_is_published_once_and_with_one_type(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    assert a.publisher("/chatter", STRING) is publisher
    with pytest.raises(roslet.RosletError, match="already, as std_msgs/String"):
        a.publisher("chatter", "std_msgs/Int32")
    publisher.close()
    publisher.close()
    with pytest.raises(roslet.NodeClosed):
        publisher.publish(data="x")
    again = a.publisher("chatter", "std_msgs/Int32")
    assert again is not publisher


def test_who_comes_and_goes_is_told(make: Nodes) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("chatter", STRING)
    events: list[tuple[str, str]] = []
    publisher.on_connect(lambda who: events.append(("pub+", who)))
    publisher.on_disconnect(lambda who: events.append(("pub-", who)))
    subscription = b.subscribe("chatter", STRING)
    subscription.on_connect(lambda who: events.append(("sub+", who)))
    subscription.on_disconnect(lambda who: events.append(("sub-", who)))
    wait_until(lambda: len(events) == 2, "both are told")
    assert sorted(events) == [("pub+", "/b"), ("sub+", "/a")]
    assert subscription.wait_for_publishers(1, 1)
    subscription.close()
    wait_until(lambda: len(events) >= 3, "the end is told")
    assert ("pub-", "/b") in events
    assert publisher.subscriber_count == 0


def test_several_threads_may_publish_one_topic(make: Nodes) -> None:
    _, _b, publisher, got = pair(make, history="keep_all")

    def publish(name: str) -> None:
        for index in range(300):
            publisher.publish(data=f"{name} {index} " + "x" * (index * 37 % 20_000))

    threads = [threading.Thread(target=publish, args=(name,)) for name in "pqr"]
    for thread in threads:
        thread.start()
    wait_until(lambda: len(got) == 900, "all arrive")
    for thread in threads:
        thread.join()
    for name in "pqr":
        mine = [int(message.data.split()[1]) for message in got if message.data.startswith(name)]
        assert mine == list(range(300))


def test_a_message_published_just_before_close_arrives_whole(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    with string_subscriber(a, "/chatter") as raw:
        raw.read_header()
        wait_until(lambda: publisher.subscriber_count == 1, "it is connected")
        publisher.publish(data="x" * 10_000_000)
        thread = threading.Thread(target=a.close)
        thread.start()
        assert len(raw.read_frame()) == 10_000_004
        thread.join()
        assert raw.at_end()
    assert a.counters == {}


def test_best_effort_goes_by_datagrams(make: Nodes) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("scan", STRING)
    subscription = b.subscribe("scan", STRING, qos=roslet.QoS(reliability="best_effort"))
    assert publisher.wait_for_subscribers(1, 5)
    rows = [row for row in b.call_node(b.uri, "getBusInfo") if row[4] == "/scan"]
    assert rows[0][3] == "UDPROS"
    for text in ("small", "x" * 20_000):
        publisher.publish(data=text)
        message = subscription.take(3)
        assert message is not None and message.data == text
    assert a.counters == {} and b.counters == {}


def test_raw_peer_sees_nothing_but_its_topic(make: Nodes) -> None:
    a = make("a")
    one, two = a.publisher("one", STRING), a.publisher("two", STRING)
    with string_subscriber(a, "/one") as raw:
        raw.read_header()
        wait_until(lambda: one.subscriber_count == 1, "it is connected")
        two.publish(data="no")
        one.publish(data="yes")
        assert raw.read_frame() == b"\x03\0\0\0yes"
    assert isinstance(raw, Raw)


def test_what_only_ros_2_has_is_unsupported_and_says_so(make: Nodes) -> None:
    node = make("node")
    for endpoint in (node.publisher("t", "std_msgs/String"), node.subscribe("t", "std_msgs/String")):
        with pytest.raises(roslet.Unsupported, match="on_event: the ROS 1 network"):
            endpoint.on_event(print)
        with pytest.raises(roslet.Unsupported, match="gid: the ROS 1 network"):
            _ = endpoint.gid
