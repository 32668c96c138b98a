"""The fuzz target runs without a fuzzer; random values survive the wire; random bytes raise nothing but ProtocolError."""

from __future__ import annotations

import contextlib
import subprocess
import sys
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

import peers
from roslet.errors import ProtocolError
from roslet.wire.rtps import endpoint_data, message, number_set, participant_data, qos, times
from roslet.wire.rtps.ack_nack import AckNack
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.gap import Gap
from roslet.wire.rtps.heartbeat import Heartbeat
from roslet.wire.rtps.info_ts import InfoTimestamp
from roslet.wire.rtps.locator import Locator

HEADER = b"RTPS\2\3\1\x52" + bytes(12)
ENTITY = st.binary(min_size=4, max_size=4)
SEQUENCE = st.integers(1, 2**63 - 300)
COUNT = st.integers(0, 2**32 - 1)
TEXT = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), min_size=1, max_size=20)
DURATION = st.one_of(st.integers(0, 2**31 * 10**9 - 10**9 - 1), st.just(times.INFINITE))
LOCATOR = st.builds(Locator, st.integers(-(2**31), 2**31 - 1), COUNT, st.binary(min_size=16, max_size=16))
LOCATORS = st.lists(LOCATOR, max_size=3).map(tuple)
QOS = st.builds(
    qos.Qos,
    reliability=st.tuples(st.integers(1, 2), DURATION),
    durability=st.integers(0, 3),
    history=st.tuples(st.integers(0, 1), st.integers(1, 1000)),
    deadline=DURATION,
    liveliness=st.tuples(st.integers(0, 2), DURATION),
    presentation=st.tuples(st.integers(0, 2), st.booleans(), st.booleans()),
    partition=st.lists(TEXT, max_size=4).map(tuple),
    representation=st.lists(st.integers(-1, 5), max_size=4).map(tuple),
    user_data=st.binary(max_size=30),
)


def test_the_fuzz_target_runs_without_a_fuzzer() -> None:
    command = [sys.executable, str(peers.ROOT / "fuzz/fuzz_rtps.py"), "--smoke", "3000"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "3000 inputs, no finding\n", done.stderr


@st.composite
def submessages(draw: st.DrawFn) -> Any:
    kind = draw(st.integers(0, 3))
    if kind == 0:
        first = draw(SEQUENCE)
        last = draw(st.integers(first - 1, 2**63 - 1))
        return Heartbeat(draw(ENTITY), draw(ENTITY), first, last, draw(COUNT), draw(st.booleans()))
    base = draw(SEQUENCE)
    members = number_set.of(base, [base + at for at in draw(st.lists(st.integers(0, 255)))])
    if kind == 1:
        return AckNack(draw(ENTITY), draw(ENTITY), members, draw(COUNT), draw(st.booleans()))
    if kind == 2:
        return Gap(draw(ENTITY), draw(ENTITY), draw(st.integers(1, base)), members)
    return InfoTimestamp(draw(st.one_of(st.none(), st.integers(0, 2**32 * 10**9 - 1))))


@settings(max_examples=150, deadline=None)
@given(st.lists(submessages(), max_size=5), st.booleans())
def test_a_message_of_any_submessages_is_read_back(values: list[Any], little: bool) -> None:
    datagram = HEADER + b"".join([bytes(value.emit(little)) for value in values])
    assert message.parse(datagram)[1] == values


@settings(max_examples=100, deadline=None)
@given(TEXT, TEXT, QOS, LOCATORS, st.sampled_from([b"\0\0\1\3", b"\0\0\1\4", b"\0\0\1\2"]), st.booleans())
def test_any_endpoint_is_read_back(
    topic: str, kind: str, policies: qos.Qos, locators: tuple[Locator, ...], entity: bytes, little: bool
) -> None:
    value = EndpointData(bytes(range(12)) + entity, topic, kind, policies, locators)
    assert endpoint_data.parse(value.emit(little)) == value


@settings(max_examples=100, deadline=None)
@given(LOCATORS, LOCATORS, DURATION, st.binary(max_size=40), TEXT, st.booleans())
def test_any_participant_is_read_back(
    one: tuple[Locator, ...], two: tuple[Locator, ...], lease: int, data: bytes, text: str, little: bool
) -> None:
    value = participant_data.own(
        bytes(range(12)),
        metatraffic_unicast=one,
        default_multicast=two,
        lease=lease,
        user_data=data,
        entity_name=text,
        properties=((text, "x"),),
    )
    assert participant_data.parse(value.emit(little)) == value


@settings(max_examples=300, deadline=None)
@given(st.sampled_from([1, 6, 7, 8, 9, 12, 13, 14, 15, 0x12, 0x13, 0x15, 0x16]), st.binary(max_size=80))
def test_random_bodies_raise_nothing_but_a_named_fault(kind: int, body: bytes) -> None:
    for flags in range(16):
        front = bytes((kind, flags)) + len(body).to_bytes(2, "little" if flags & 1 else "big")
        with contextlib.suppress(ProtocolError):
            message.parse(HEADER + front + body)
    for encapsulation in (b"\0\2\0\0", b"\0\3\0\0"):
        for read in (participant_data.parse, endpoint_data.parse):
            with contextlib.suppress(ProtocolError):
                read(encapsulation + body)
