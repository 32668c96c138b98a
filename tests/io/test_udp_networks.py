"""Interfaces as the kernel tells them, names of static peers, and ports. Netlink messages are written by hand."""

from __future__ import annotations

import random
import socket
import struct
import threading
import time

import pytest

from roslet.errors import Unreachable
from roslet.io import interfaces, resolver, udp
from roslet.io.interfaces import Interface, choose, parse_addresses, require
from roslet.io.resolver import Resolver
from roslet.io.select import Reactor
from roslet.names import OFF, Ros2Network
from roslet.wire.rtps import locator

LO = Interface("lo", 1, "127.0.0.1", 8, True)
ETH = Interface("eth0", 2, "10.0.1.1", 24, True)
TUN = Interface("tun0", 3, "10.8.0.2", 32, False)


def attribute(kind: int, value: bytes) -> bytes:
    return struct.pack("=HH", 4 + len(value), kind) + value + bytes(-len(value) % 4)


def message(kind: int, body: bytes) -> bytes:
    return struct.pack("=IHHII", 16 + len(body), kind, 2, 1, 0) + body


def address(index: int, bits: int, *attributes: bytes, family: int = socket.AF_INET) -> bytes:
    return message(20, struct.pack("=BBBBI", family, bits, 0, 0, index) + b"".join(attributes))


DONE = message(3, bytes(4))
ADDRESS, LOCAL, LABEL = 1, 2, 3


def test_addresses_are_read_from_netlink() -> None:
    data = (
        address(
            1,
            8,
            attribute(ADDRESS, b"\x7f\0\0\1"),
            attribute(LOCAL, b"\x7f\0\0\1"),
            attribute(LABEL, b"lo\0"),
        )
        + address(2, 24, attribute(LOCAL, b"\x0a\0\1\1"))
        + address(9, 64, attribute(ADDRESS, bytes(16)), family=socket.AF_INET6)
        + address(4, 32, attribute(LOCAL, b"\x0a\x08\0\2"), attribute(ADDRESS, b"\x0a\x08\0\1"))
        + DONE
    )
    expected = [(1, "127.0.0.1", 8), (2, "10.0.1.1", 24), (4, "10.8.0.2", 32)]
    assert parse_addresses(data) == (expected, True)
    assert parse_addresses(data[: -len(DONE)]) == (expected, False)


def test_no_netlink_message_does_harm() -> None:
    whole = address(2, 24, attribute(LOCAL, b"\x0a\0\1\1")) + address(3, 24, attribute(LOCAL, b"\x0a\0\2\1"))
    for cut in range(len(whole)):
        found, _ = parse_addresses(whole[:cut])
        assert len(found) <= 1
    dice = random.Random(1)
    for _ in range(5000):
        data = bytearray(whole)
        for _ in range(dice.randrange(1, 5)):
            data[dice.randrange(len(data))] = dice.randrange(256)
        found, _ = parse_addresses(bytes(data))
        assert len(found) <= 2
        assert all(bits <= 32 for _, _, bits in found)
    assert parse_addresses(message(2, bytes(4))) == ([], True)
    assert parse_addresses(struct.pack("=IHHII", 0, 20, 0, 0, 0)) == ([], True)


def test_loopback_is_among_the_interfaces_and_last() -> None:
    found = interfaces.interfaces()
    assert any(one.address == "127.0.0.1" and one.name == "lo" for one in found)
    assert [one.loopback for one in found] == sorted(one.loopback for one in found)


def test_without_netlink_there_is_still_loopback(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> list[Interface]:
        raise PermissionError

    monkeypatch.setattr(interfaces, "_from_netlink", refuse)
    assert "127.0.0.1" in [one.address for one in interfaces.interfaces()]


def test_loopback_is_used_only_where_there_is_nothing_else() -> None:
    assert choose([ETH, TUN, LO], ()) == [ETH, TUN]
    assert choose([LO], ()) == [LO]
    assert choose([ETH, TUN, LO], ("10.8.0.2", "lo")) == [TUN, LO]
    assert len(choose([ETH] * 99, ())) == interfaces.MAX_ADDRESSES


def test_an_interface_that_is_not_there_is_named() -> None:
    require([ETH, LO], ("eth0", "127.0.0.1"))
    with pytest.raises(Unreachable, match=r"no interface wlan0 .* is up; there are: eth0 \(10.0.1.1\), lo"):
        require([ETH, LO], ("eth0", "wlan0"))


def test_more_participants_than_ports_is_said_plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(udp, "MAX_PARTICIPANT_ID", 1)
    taken = []
    try:
        for number in range(2):
            one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            taken.append(one)
            one.bind(("", locator.metatraffic_unicast_port(77, number)))
        with pytest.raises(
            Unreachable, match=r"domain 77 has no room for another participant .* all 2 are taken"
        ):
            udp.Domain._bind(77)
    finally:
        for one in taken:
            one.close()


def test_the_last_domain_has_fewer_ports() -> None:
    number, meta, user = udp.Domain._bind(232)
    assert user.getsockname()[1] == 65411 + 2 * number
    meta.close()
    user.close()


def test_a_domain_that_is_off_neither_speaks_nor_listens_to_the_group() -> None:
    reactor = Reactor()
    domain = udp.Domain(reactor, lambda event: None, Ros2Network(78, ("lo",), (), OFF))
    try:
        assert domain._announce_to() == ()
        assert domain._group is None
        assert domain.participant.limits.participants == 0
    finally:
        domain.close()
        reactor.close()


def test_names_of_peers_are_resolved_beside_the_loop_and_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """One name is known at once, one on the second try, one never: each is told once."""
    tries: dict[str, int] = {}
    threads = set()

    def ask(name: str, *_: object) -> list[tuple[int, int, int, str, tuple[str, int]]]:
        threads.add(threading.current_thread().name)
        tries[name] = tries.get(name, 0) + 1
        if name == "never" or (name == "late" and tries[name] == 1):
            raise socket.gaierror(-2, "Name or service not known")
        return [(2, 2, 17, "", (f"10.0.0.{i}", 0)) for i in range(9)]

    monkeypatch.setattr(socket, "getaddrinfo", ask)
    monkeypatch.setattr(resolver, "AGAIN", 0.05)
    reactor = Reactor()
    found: dict[str, tuple[str, ...]] = {}
    failed: list[str] = []
    asked = Resolver(
        reactor, ["early", "late", "never"], found.__setitem__, lambda name, reason: failed.append(name)
    )
    assert reactor.run_until(lambda: tries.get("never", 0) >= 4, 20.0)
    asked.close()
    assert failed == ["late", "never"]
    assert found == dict.fromkeys(("early", "late"), ("10.0.0.0", "10.0.0.1", "10.0.0.2", "10.0.0.3"))
    assert tries["early"] == 1
    assert threads == {"roslet resolver"}
    reactor.close()


def test_a_static_peer_by_name_is_announced_to_once_it_has_an_address(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    released = threading.Event()

    def ask(name: str, *_: object) -> list[tuple[int, int, int, str, tuple[str, int]]]:
        assert released.wait(10)
        if name == "robot":
            return [(2, 2, 17, "", ("127.0.0.9", 0))]
        raise socket.gaierror(-2, "Name or service not known")

    monkeypatch.setattr(socket, "getaddrinfo", ask)
    reactor = Reactor()
    warnings: list[str] = []
    begin = time.monotonic()
    network = Ros2Network(79, ("lo",), (("robot", 7412), ("ghost", None)))
    domain = udp.Domain(reactor, lambda event: None, network, warnings.append)
    try:
        assert time.monotonic() - begin < 5.0
        assert ("127.0.0.9", 7412) not in domain._announce_to()
        released.set()
        assert reactor.run_until(lambda: warnings and ("127.0.0.9", 7412) in domain._announce_to(), 10.0)
        assert warnings == [
            "the static peer ghost has no address ([Errno -2] Name or service not known); asking again every 30 s"
        ]
    finally:
        domain.close()
        reactor.close()
