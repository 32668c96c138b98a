"""Hosts of one, of several, and of changing interfaces; routers. Each host is a namespace."""

from __future__ import annotations

import pathlib

import pytest

from interop import rtps
from interop.namespace import Namespace, connect, lay, route
from interop.networks import LEASE, check_heard, listen, talk

pytestmark = pytest.mark.beside

PEERS = ["roslet", "kilted", "cyclone"]


@pytest.mark.parametrize("peer", PEERS)
@pytest.mark.parametrize("multicast", [True, False], ids=["multicast", "nothing-but-loopback"])
def test_loopback_is_enough(tmp_path: pathlib.Path, peer: str, multicast: bool) -> None:
    with Namespace(tmp_path, route=multicast) as here:
        talk(here, "roslet")
        check_heard(listen(here, peer))


@pytest.mark.parametrize("peer", PEERS)
def test_two_hosts_find_each_other_by_a_cable(tmp_path: pathlib.Path, peer: str) -> None:
    with Namespace(tmp_path, route=False) as here, Namespace(tmp_path, route=False) as there:
        connect(here, there, "cable", "10.0.1")
        talk(here, peer)
        check_heard(listen(there, "roslet"))


@pytest.mark.parametrize("peer", PEERS)
def test_a_host_with_several_interfaces_is_in_several_networks(tmp_path: pathlib.Path, peer: str) -> None:
    with (
        Namespace(tmp_path, route=False) as first,
        Namespace(tmp_path, route=False) as here,
        Namespace(tmp_path, route=False) as second,
    ):
        connect(here, first, "one", "10.0.1")
        connect(here, second, "two", "10.0.2")
        heard = [
            at.start(*rtps.command(peer, "listener", 5), name=name)
            for at, name in ((first, "first"), (second, "second"))
        ]
        for one in heard:
            one.wait_for("ready")
        talk(here, "roslet", count=100)
        for one in heard:
            assert len(one.finish()) >= 6


@pytest.mark.parametrize("peer", ["roslet", "kilted"])
def test_a_chosen_interface_is_the_only_one(tmp_path: pathlib.Path, peer: str) -> None:
    with (
        Namespace(tmp_path, route=False) as first,
        Namespace(tmp_path, route=False) as here,
        Namespace(tmp_path, route=False) as second,
    ):
        connect(here, first, "one", "10.0.1")
        connect(here, second, "two", "10.0.2")
        talk(here, "roslet", "ros2://?interface=two", count=3)
        left = first.start(*rtps.command(peer, "listener", 5), name="left")
        left.wait_for("ready")
        check_heard(listen(second, peer))
        assert left.lines() == ["ready"]


@pytest.mark.parametrize("peer", PEERS)
@pytest.mark.parametrize("url", ["ros2://?interface=cable", "ros2://?interface=10.0.1.1"])
def test_an_interface_is_chosen_by_name_or_address(tmp_path: pathlib.Path, peer: str, url: str) -> None:
    with Namespace(tmp_path, route=False) as here, Namespace(tmp_path, route=False) as there:
        connect(here, there, "cable", "10.0.1")
        talk(here, "roslet", url)
        check_heard(listen(there, peer))


@pytest.mark.parametrize("peer", ["roslet", "kilted"])
def test_an_interface_that_comes_later_is_used(tmp_path: pathlib.Path, peer: str) -> None:
    """The peer has its interface from the start; ours is plugged in when both have looked in vain."""
    with (
        Namespace(tmp_path, route=False) as here,
        Namespace(tmp_path, route=False) as switch,
        Namespace(tmp_path, route=False) as there,
    ):
        lay(there, switch, "right")
        there.run("ip address add 10.0.1.2/24 dev right && ip link set dev right up")
        switch.run("ip link add name br0 type bridge && ip link set dev br0 up")
        switch.run("ip link set dev right master br0 && ip link set dev right up")
        there.wait_for_link("right")
        heard = listen(there, peer)
        talker = talk(here, "roslet")
        lay(here, switch, "late")
        switch.run("ip link set dev late master br0 && ip link set dev late up")
        here.run("ip address add 10.0.1.1/24 dev late && ip link set dev late up")
        check_heard(heard)
        talker.finish()


@pytest.mark.parametrize("peer", ["roslet", "kilted"])
def test_when_an_interface_goes_samples_take_another(tmp_path: pathlib.Path, peer: str) -> None:
    with Namespace(tmp_path, route=False) as here, Namespace(tmp_path, route=False) as there:
        connect(here, there, "one", "10.0.1")
        connect(here, there, "two", "10.0.2")
        talk(here, "roslet", count=400)
        heard = listen(there, peer, count=80)
        heard.wait_until(lambda lines: len(lines) > 20, 20, "the first samples")
        here.run("ip link delete one")
        lines = heard.finish()
        found = [int(line.split()[-1]) for line in lines[1:]]
        assert len(found) >= 80
        assert found == sorted(set(found))


@pytest.mark.parametrize("peer", ["roslet", "kilted"])
@pytest.mark.parametrize("named_by", ["us", "peer"])
def test_static_peers_are_found_through_a_router(tmp_path: pathlib.Path, peer: str, named_by: str) -> None:
    """Only one side names the other, and samples still go on when the first lease would have run out."""
    with (
        Namespace(tmp_path, route=False) as here,
        Namespace(tmp_path, route=False) as router,
        Namespace(tmp_path, route=False) as there,
    ):
        route(here, router, there)
        count = round(1.5 * LEASE / rtps.PAUSE)
        talk(here, "roslet", count=count, ROS_STATIC_PEERS="10.0.2.1" if named_by == "us" else "")
        heard = listen(there, peer, count=count, ROS_STATIC_PEERS="10.0.1.1" if named_by == "peer" else "")
        check_heard(heard, count)
