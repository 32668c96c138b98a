"""Datagrams from fragments: any order, repetitions, and every way in which fragments may lie."""

import pytest

from roslet.engine.net.limits import Limits
from roslet.engine.net.reassembly import TIMEOUT, Reassembly
from roslet.wire.net.ipv4 import Packet

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

A, B = bytes([192, 168, 1, 2]), bytes([192, 168, 1, 10])
DATA = bytes([n & 0xFF for n in range(60)])


def part(start: int, end: int, more: "bool | None" = None, identification: int = 7) -> Packet:
    """Octets start to end of DATA; the last one where it ends there."""
    if more is None:
        more = end < len(DATA)
    return Packet(A, B, 17, DATA[start:end], identification, offset=start, more=more)


PARTS = [part(0, 16), part(16, 24), part(24, 48), part(48, 60)]


class Counted:
    def __init__(self, **limits: "Any") -> None:
        self.counters: dict[str, int] = {}
        self.machine = Reassembly(Limits(**limits), self._count)

    def _count(self, reason: str) -> None:
        self.counters[reason] = self.counters.get(reason, 0) + 1

    def feed(self, *parts: Packet) -> "list[Packet]":
        found = [self.machine.add(one, 0.0) for one in parts]
        return [one for one in found if one is not None]


def orders(items: "list[Any]") -> "list[list[Any]]":
    if len(items) < 2:
        return [items]
    found = []
    for at in range(len(items)):
        for rest in orders(items[:at] + items[at + 1 :]):
            found.append(items[at : at + 1] + rest)
    return found


def test_every_order_gives_the_datagram() -> None:
    for order in orders(PARTS):
        counted = Counted()
        (whole,) = counted.feed(*order)
        assert whole.payload == DATA and not whole.is_fragment and whole.identification == 7
        assert counted.counters == {} and counted.machine.pending == {}


def test_repetitions_change_nothing() -> None:
    counted = Counted()
    (whole,) = counted.feed(PARTS[3], PARTS[3], PARTS[0], PARTS[0], PARTS[2], PARTS[1])
    assert whole.payload == DATA
    assert counted.counters == {"fragment-repeated": 2}


@pytest.mark.parametrize(
    "parts, reason",
    [
        ([part(0, 16), part(8, 24)], "fragment-overlaps"),
        ([part(0, 16), part(0, 8)], "fragment-overlaps"),
        ([part(8, 16), part(0, 24)], "fragment-overlaps"),
        ([part(48, 60), part(40, 56)], "fragment-overlaps"),
        ([part(48, 60), part(24, 40, False)], "fragment-beyond-last"),
        ([part(24, 32, False), part(32, 40, True)], "fragment-beyond-last"),
        ([part(40, 48, True), part(16, 24, False)], "fragment-beyond-last"),
    ],
)
def test_fragments_that_contradict_each_other_end_their_datagram(parts: "list[Packet]", reason: str) -> None:
    counted = Counted()
    counted.feed(*parts)
    assert counted.counters == {reason: 1} and counted.machine.pending == {}


def test_the_key_is_source_destination_protocol_and_identification() -> None:
    base = part(0, 16)
    for other in (
        base.replace(source=B),
        base.replace(destination=A),
        base.replace(protocol=1),
        base.replace(identification=8),
    ):
        counted = Counted()
        counted.feed(base, other)
        assert len(counted.machine.pending) == 2 and counted.counters == {}


def test_everything_is_bounded() -> None:
    counted = Counted(assemblies=4)
    counted.feed(*[part(0, 8, True, n) for n in range(10)])
    assert counted.counters == {"assemblies-full": 6} and len(counted.machine.pending) == 4
    counted = Counted(fragments=3)
    counted.feed(*[part(n, n + 8, True) for n in range(0, 48, 8)][:4])
    assert counted.counters == {"fragments-full": 1} and counted.machine.pending == {}
    counted = Counted(assembly_bytes=20)
    counted.feed(part(0, 16, True, 1), part(0, 8, True, 2))
    assert counted.counters == {"assembly-bytes-full": 1}
    counted.machine.handle_deadline(TIMEOUT)
    counted.feed(part(0, 16, True, 3))
    assert counted.counters["assembly-bytes-full"] == 1, "what has expired makes room"


def test_what_does_not_come_in_time_is_given_up() -> None:
    counted = Counted()
    counted.machine.add(PARTS[0], 1.0)
    counted.machine.add(PARTS[1], 20.0)
    assert counted.machine.deadline() == 1.0 + TIMEOUT
    counted.machine.handle_deadline(1.0 + TIMEOUT)
    assert counted.counters == {"assembly-expired": 1}
    assert counted.machine.deadline() is None


def test_no_datagram_grows_beyond_what_a_header_can_say() -> None:
    counted = Counted()
    counted.feed(Packet(A, B, 17, bytes(16), 7, offset=65504))
    assert counted.counters == {"datagram-too-long": 1}
