"""What a closed node leaves behind: nobody waits for it any more, and who uses it is told."""

from __future__ import annotations

import asyncio
import socket
import threading
from collections.abc import Iterator

import pytest

from roslet import Node, NodeClosed
from roslet.master.server import MasterServer


@pytest.fixture
def node() -> Iterator[Node]:
    with MasterServer(port=0) as master, Node("mortal", network=f"ros1://127.0.0.1:{master.port}") as made:
        yield made


def test_who_waits_for_a_message_goes_on_when_the_node_closes(node: Node) -> None:
    subscription = node.subscribe("silent", "std_msgs/String")
    threading.Timer(0.1, node.close).start()
    assert subscription.take(timeout=10) is None
    assert node.is_shutdown


def test_an_iteration_ends_when_the_node_closes(node: Node) -> None:
    subscription = node.subscribe("silent", "std_msgs/String")
    threading.Timer(0.1, node.close).start()

    async def hear() -> list[object]:
        return [message async for message in subscription]

    assert asyncio.run(asyncio.wait_for(hear(), 10)) == []


def test_what_is_used_after_the_end_says_so(node: Node) -> None:
    publisher = node.publisher("chatter", "std_msgs/String")
    client = node.client("service", "std_srvs/Empty")
    publisher.publish(data="heard by nobody")
    node.close()
    node.close()
    for use in (
        lambda: publisher.publish(data="too late"),
        lambda: node.publisher("other", "std_msgs/String"),
        lambda: node.subscribe("other"),
        lambda: node.get_parameter("other", None),
        lambda: client.call(),
    ):
        with pytest.raises(NodeClosed, match="is closed"):
            use()
    assert publisher.statistics == {"messages": 1, "dropped": 0, "subscribers": 0}


def test_a_call_that_is_under_way_ends_when_the_node_closes(node: Node) -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        threading.Timer(0.2, node.close).start()
        with pytest.raises(NodeClosed, match="/mortal is closed"):
            node.call_node("http://127.0.0.1:%d/" % silent.getsockname()[1], "getPid")
