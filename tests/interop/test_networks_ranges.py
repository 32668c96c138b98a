"""Discovery ranges: who finds whom, as the table in ROS 2's documentation of its "improved dynamic discovery" says.

On one host everybody finds everybody, unless one of them says OFF. Between hosts both must say SUBNET, or one of them names
the other as a static peer.
"""

from __future__ import annotations

import pathlib

import pytest

from interop.namespace import Namespace, connect
from interop.networks import check_heard, check_silence, listen, talk

pytestmark = pytest.mark.beside

FOUND = [
    ("LOCALHOST", "LOCALHOST"),
    ("LOCALHOST", "SUBNET"),
    ("SUBNET", "LOCALHOST"),
    ("SUBNET", "SYSTEM_DEFAULT"),
    ("SYSTEM_DEFAULT", "SUBNET"),
]
OFF = [("OFF", "SUBNET"), ("SUBNET", "OFF"), ("OFF", "OFF"), ("OFF", "LOCALHOST")]


@pytest.mark.parametrize("peer", ["roslet", "kilted"])
@pytest.mark.parametrize(("ours", "theirs"), FOUND)
def test_on_one_host_they_find_each_other(tmp_path: pathlib.Path, peer: str, ours: str, theirs: str) -> None:
    with Namespace(tmp_path, route=False) as here, Namespace(tmp_path) as there:
        connect(here, there, "cable", "10.0.1")
        talk(here, "roslet", ROS_AUTOMATIC_DISCOVERY_RANGE=ours)
        check_heard(listen(here, peer, ROS_AUTOMATIC_DISCOVERY_RANGE=theirs))


@pytest.mark.parametrize("peer", ["roslet", "kilted"])
@pytest.mark.parametrize(("ours", "theirs"), OFF)
def test_who_is_off_finds_nobody(tmp_path: pathlib.Path, peer: str, ours: str, theirs: str) -> None:
    with Namespace(tmp_path) as here:
        talker = talk(here, "roslet", ROS_AUTOMATIC_DISCOVERY_RANGE=ours, ROS_STATIC_PEERS="127.0.0.1")
        check_silence(talker, listen(here, peer, ROS_AUTOMATIC_DISCOVERY_RANGE=theirs))


@pytest.mark.parametrize("peer", ["roslet", "kilted"])
@pytest.mark.parametrize(
    ("ours", "theirs"), [("LOCALHOST", "SUBNET"), ("SUBNET", "LOCALHOST"), ("LOCALHOST", "LOCALHOST")]
)
def test_localhost_ends_at_the_host(tmp_path: pathlib.Path, peer: str, ours: str, theirs: str) -> None:
    with Namespace(tmp_path, route=False) as here, Namespace(tmp_path, route=False) as there:
        connect(here, there, "cable", "10.0.1")
        talker = talk(here, "roslet", ROS_AUTOMATIC_DISCOVERY_RANGE=ours)
        check_silence(talker, listen(there, peer, ROS_AUTOMATIC_DISCOVERY_RANGE=theirs))


@pytest.mark.parametrize("peer", ["roslet", "kilted"])
@pytest.mark.parametrize(("ours", "theirs"), [("", "10.0.1.1"), ("10.0.1.2", "")])
def test_a_static_peer_of_either_side_is_found_beyond_localhost(
    tmp_path: pathlib.Path, peer: str, ours: str, theirs: str
) -> None:
    with Namespace(tmp_path, route=False) as here, Namespace(tmp_path, route=False) as there:
        connect(here, there, "cable", "10.0.1")
        talk(here, "roslet", ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST", ROS_STATIC_PEERS=ours)
        heard = listen(there, peer, ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST", ROS_STATIC_PEERS=theirs)
        check_heard(heard)


def test_localhost_only_puts_static_peers_out_of_force(tmp_path: pathlib.Path) -> None:
    with Namespace(tmp_path, route=False) as here, Namespace(tmp_path, route=False) as there:
        connect(here, there, "cable", "10.0.1")
        talker = talk(here, "roslet", ROS_LOCALHOST_ONLY="1", ROS_STATIC_PEERS="10.0.1.2")
        check_silence(talker, listen(there, "kilted"))


@pytest.mark.parametrize("peer", ["roslet", "kilted", "cyclone"])
def test_domains_do_not_meet(tmp_path: pathlib.Path, peer: str) -> None:
    with Namespace(tmp_path) as here:
        talker = talk(here, "roslet", "ros2://1")
        check_silence(talker, listen(here, peer))


@pytest.mark.parametrize("peer", ["roslet", "kilted", "cyclone"])
def test_a_domain_is_its_number_wherever_it_is_said(tmp_path: pathlib.Path, peer: str) -> None:
    with Namespace(tmp_path) as here:
        talk(here, "roslet", "ros2://42")
        check_heard(listen(here, peer, ROS_DOMAIN_ID="42"))
