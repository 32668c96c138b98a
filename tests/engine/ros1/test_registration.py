"""Engines and their master: down, restarted, out of reach, and two nodes of one name."""

import pytest

from engine.ros1.network import Host, linked, world
from roslet.engine.ros1 import engine as engine_module
from roslet.engine.ros1 import registration
from roslet.errors import CallTimeout, Fault, Unreachable

pytestmark = pytest.mark.micropython

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def test_a_master_that_is_down_is_waited_for() -> None:
    network, master, talker, listener = world()
    master.stop()
    publication = talker.publisher("/chatter")
    _, got = listener.subscriber("/chatter")
    network.run(10.0)
    assert talker.notes == [
        "cannot reach the master at http://master:11311 (master:11311: connection refused); waiting for it"
    ]
    master.start()
    assert network.run(2 * registration.RETRY + 0.5, lambda: publication.links)
    assert "the master at http://master:11311 answers" in talker.notes
    talker.publish(publication, b"x")
    assert network.run(1.0, lambda: got == [b"x"])


def test_a_master_whose_host_has_vanished_is_waited_for() -> None:
    network, master, talker, _ = world()
    network.vanished.append("master")
    talker.publisher("/chatter")
    network.run(engine_module.CALL_TIMEOUT + 1)
    assert any("cannot reach the master" in note for note in talker.notes)
    network.vanished.clear()
    assert network.run(20.0, lambda: "/chatter" in master.topics["Publisher"])


def test_after_a_restart_of_the_master_everything_is_registered_again() -> None:
    network, master, talker, listener, publication, subscription, got = linked()
    talker.service("/work", lambda body: body)
    watched: list[Any] = []
    talker.engine.on_parameter = lambda key, value: watched.append((key, value))
    talker.engine.watch_parameter("/p", lambda value, error, now: None, network.now)
    talker.update()
    network.run(3.0)
    master.stop()
    network.run(1.0)
    master.start()
    for index in range(80):  # it publishes on while the master comes back
        talker.publish(publication, b"%d" % index)
        network.run(0.1)
    assert master.topics["Publisher"] == {"/chatter": [talker.engine.uri]}
    assert master.topics["Subscriber"] == {"/chatter": [listener.engine.uri]}
    assert master.services == {"/work": talker.engine.service_uri}
    assert master.watchers == {"/p": [talker.engine.uri]}
    assert got == [b"%d" % index for index in range(80)], "the links have stood all the time"
    assert list(subscription.links) == [talker.engine.uri]
    assert listener.ask_master("setParam", "/p", 5) == []
    assert network.run(1.0, lambda: watched == [("/p", 5)])


def test_a_quick_restart_of_the_master_is_noticed_by_its_ignorance() -> None:
    network, master, talker, _, _, _, _ = linked()
    network.run(3.0)
    master.stop()
    master.start()
    assert network.run(2 * registration.CHECK, lambda: "/chatter" in master.topics["Publisher"])
    assert any("has forgotten this node" in note for note in talker.notes)


def test_a_publisher_that_did_not_survive_the_master_is_dropped_after_the_grace() -> None:
    network, master, talker, _listener, _, subscription, _ = linked()
    network.run(3.0)
    master.stop()
    network.run(1.0)
    network.vanished.append("alpha")  # gone with the master, without a word
    master.start()
    network.run(1.0)
    assert list(subscription.links) == [talker.engine.uri]
    network.run(registration.GRACE + 3.0)
    assert subscription.links == {}


def test_what_was_withdrawn_while_the_master_was_out_of_reach_is_told_later() -> None:
    network, master, talker, _, publication, _, _ = linked()
    network.vanished.append("master")
    talker.engine.unadvertise(publication, network.now)
    talker.update()
    network.run(30.0)
    assert master.topics["Publisher"]["/chatter"] == [talker.engine.uri]
    network.vanished.clear()
    talker.publisher("/else")
    network.run(30.0)
    assert master.topics["Publisher"]["/chatter"] == []


def test_a_thousand_registrations_do_not_flood_a_master_that_comes_back() -> None:
    network, master, talker, _ = world(piece=100000, delay=0.0001)
    master.stop()
    for index in range(1500):
        talker.publisher("/t%d" % index)
    network.run(1.0)
    most = [0]
    plain = talker.engine._master.call

    def call(*given: "Any") -> int:
        most[0] = max(most[0], talker.engine._master.pending + 1)
        return plain(*given)

    talker.engine._master.call = call  # type: ignore[method-assign, assignment]
    master.start()
    assert network.run(30.0, lambda: len(master.topics["Publisher"]) == 1500)
    assert network.run(1.0, lambda: talker.engine.registrations.settled)
    assert most[0] <= registration.IN_FLIGHT + 2


def test_a_registration_that_the_master_refuses_is_told_and_not_repeated() -> None:
    network, master, talker, _ = world()
    refused: list[Any] = [-1, "no, thank you", 0]
    master.register_publisher = lambda *given: refused  # type: ignore[method-assign]
    talker.publisher("/chatter")
    network.run(10.0)
    assert (
        1 <= talker.engine.counters["registration-refused"] < 6
    )  # the checks find it unknown, and it tries again
    assert any("the master refuses publisher /chatter: no, thank you" in note for note in talker.notes)


def test_a_second_node_of_the_same_name_shuts_the_first_down() -> None:
    network, master, talker, _ = world()
    asked: list[str] = []
    talker.engine.on_shutdown = asked.append
    talker.publisher("/chatter")
    network.run(1.0)
    twin = Host(network, "/talker", "gamma")
    twin.publisher("/chatter")
    network.run(1.0)
    assert len(asked) == 1 and "new node registered with same name" in asked[0]
    assert talker.engine.shutdown_reason == asked[0]
    for method, arguments in talker.engine.begin_close(network.now):
        talker.engine.call_master(method, arguments, lambda value, error, now: None, network.now)
    talker.update()
    network.run(1.0)
    assert master.topics["Publisher"]["/chatter"] == [twin.engine.uri], "the first takes only its own back"


def test_closing_fails_what_is_under_way() -> None:
    network, _master, talker, _ = world()
    network.vanished.append("master")
    results = talker.ask_master("getParam", "/x")
    slave: list[Any] = []
    for index in range(50):
        talker.engine.call_slave(
            "http://beta:%d/" % (7000 + index),
            "getPid",
            ["/talker"],
            lambda *given: slave.append(given[1]),
            network.now,
        )
    talker.engine.close(network.now)
    assert isinstance(results[0], Unreachable)
    assert len(slave) == 50 and all(isinstance(error, Unreachable) for error in slave)


def test_a_call_that_the_master_does_not_answer_times_out() -> None:
    network, _master, talker, _ = world()
    network.run(0.1)
    results = talker.ask_master("getParam", "/x")
    network.run(1.0)
    assert isinstance(results[0], Fault)
    network.vanished.append("master")
    results = talker.ask_master("getParam", "/x")
    network.run(engine_module.CALL_TIMEOUT + 1)
    assert isinstance(results[0], CallTimeout)


def test_a_node_that_closes_seeks_no_publisher_any_more() -> None:
    network, _master, listener, _ = world()
    subscription, _ = listener.subscriber("/chatter")
    network.run(1.0)
    subscription.update(["http://gamma:%d/" % (7000 + index) for index in range(500)], network.now)
    listener.update()
    network.run(0.1)
    assert subscription._retry or subscription._asking
    calls = listener.engine.begin_close(network.now)
    assert [method for method, _ in calls] == ["unregisterSubscriber"]
    assert subscription.deadline() is None
    network.run(10.0)
    assert not subscription._asking and not subscription._retry and subscription.deadline() is None
