"""Several peers of several kinds at once on one topic and on one service."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from interop import ros2_exchange as exchange
from interop.ros2_peers import Host, Peer, wait_until

KINDS = ("roslet", "kilted", "jazzy", "cyclone")


@pytest.fixture(scope="module")
def everybody(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Peer]]:
    with Host(tmp_path_factory.mktemp("several")) as host:
        yield {kind: host.peer(kind, kind) for kind in KINDS}


def test_everybody_hears_everybody_on_one_topic_each_in_order(everybody: dict[str, Peer]) -> None:
    topic = exchange.name()
    for peer in everybody.values():
        peer.ask("subscription", "in", topic, exchange.UINT32, 0, {"depth": 200})
    for peer in everybody.values():
        peer.ask("publisher", "out", topic, exchange.UINT32, {"depth": 200})
    for peer in everybody.values():
        peer.wait(len(KINDS), "matched", "in")
        peer.wait(len(KINDS), "matched", "out")
    for k, peer in enumerate(everybody.values()):
        peer.tell("publish", "out", 1000 * k, 50, 0, 0.005)
    for peer in everybody.values():
        peer.answer()
    everything = [1000 * k + i for k in range(len(KINDS)) for i in range(50)]
    for kind, peer in everybody.items():

        def sorted_by_talker(peer: Peer = peer) -> list[int]:
            heard: list[int] = peer.ask("heard", "in")[0]
            return [one for k in range(len(KINDS)) for one in heard if one // 1000 == k]

        wait_until(lambda: len(sorted_by_talker()) >= len(everything), f"{kind} hears all")
        assert sorted_by_talker() == everything, kind


@pytest.mark.parametrize("server", ["roslet", "kilted"])
def test_one_server_answers_several_clients_each_its_own(everybody: dict[str, Peer], server: str) -> None:
    service = exchange.name()
    kind = "sensor_msgs/srv/SetCameraInfo"
    # The dialect of Cyclone is not that of Fast DDS: between those two nobody is served.
    clients = [
        everybody[one]
        for one in (KINDS if server == "roslet" else ("roslet", "kilted", "jazzy"))
        if one != server
    ]
    everybody[server].ask("service", service, service, kind)
    for peer in clients:
        peer.ask("client", service, service, kind)
    for peer in clients:
        peer.wait(True, "ready", service)
    for _ in range(3):
        for k, peer in enumerate(clients):
            # As many as the history of a server of rclpy holds, 10, together.
            peer.tell("call", service, 100 * k, 3, 800, 10.0)
        for peer in clients:
            assert peer.answer(30.0) == []


def test_a_client_that_finds_two_servers_gets_one_answer_to_each_call(everybody: dict[str, Peer]) -> None:
    service = exchange.name()
    for server in ("kilted", "jazzy"):
        everybody[server].ask("service", service, service, "std_srvs/srv/SetBool")
    client = everybody["roslet"]
    client.ask("client", service, service, "std_srvs/srv/SetBool")
    client.wait(True, "ready", service)
    for i in range(5):
        assert client.ask("call", service, i, 5, 0, 5.0) == []


def test_a_call_that_nobody_serves_ends_with_its_timeout_and_says_so(everybody: dict[str, Peer]) -> None:
    service = exchange.name()
    client = everybody["roslet"]
    client.ask("client", service, service, "std_srvs/srv/SetBool")
    kind, text, took = client.ask("impatient", service, 0.5)
    assert kind == "CallTimeout"
    assert text == f"service {service}: no response within 0.5 s"
    assert 0.4 < took < 3
    # And a server that comes later is called.
    client.tell("call", service, 0, 1, 0, 10.0)
    everybody["kilted"].ask("service", service, service, "std_srvs/srv/SetBool")
    assert client.answer() == []
