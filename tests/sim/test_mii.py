"""Frames at MII and GMII pins, against nibbles written by hand and a design that sends back what it gets."""

from __future__ import annotations

import random

import pytest

from roslet.sim import mii
from roslet.sim.mii import ERROR, VALID, read, symbols_of
from sim.echo import plugged

# 60 octets of which the FCS was made by two other programs (Ethernet's CRC-32 of zeros: 0x04128908).
ZEROS = bytes(60)
ZEROS_FCS = bytes((0x08, 0x89, 0x12, 0x04))


def nibbles(text: str) -> list[int]:
    """Data nibbles as they go over the wire."""
    return [VALID | int(digit, 16) for digit in text if digit != " "]


GOOD = nibbles("55555555555555 5d" + "00" * 60 + "80 98 21 40")


def test_the_check_value_of_the_published_catalogue_comes_out() -> None:
    assert mii.fcs(b"123456789") == bytes((0x26, 0x39, 0xF4, 0xCB))
    assert mii.fcs(ZEROS) == ZEROS_FCS


def test_nibbles_go_with_the_lower_one_first() -> None:
    assert symbols_of(b"\x12\xd5", 4) == nibbles("21 5d")
    assert symbols_of(b"\x12\xd5", 8) == [0x112, 0x1D5]


def test_a_good_frame_has_no_faults() -> None:
    assert read(GOOD, 4) == (ZEROS, ())
    assert read(symbols_of(b"\x55" * 7 + b"\xd5" + ZEROS + ZEROS_FCS, 8), 8) == (ZEROS, ())
    assert read(nibbles("5") + GOOD, 4) == (ZEROS, ()), "more preamble than needed does no harm"


@pytest.mark.parametrize(
    ("symbols", "faults"),
    [
        (GOOD[1:], ("preamble-short",)),
        (GOOD[15:], ("preamble-short",)),
        (GOOD[16:], ("sfd-missing",)),
        (GOOD[:15], ("sfd-missing",)),
        ([], ("sfd-missing",)),
        (GOOD[:16], ("fcs-wrong", "too-short")),
        (GOOD[:-2], ("fcs-wrong", "too-short")),
        (GOOD[:-1], ("nibbles-odd", "fcs-wrong", "too-short")),
        (GOOD + nibbles("0"), ("nibbles-odd",)),
        ([*GOOD[:-1], VALID | 1], ("fcs-wrong",)),
        ([*GOOD[:40], VALID | ERROR, *GOOD[41:]], ("error-raised",)),
    ],
)
def test_every_fault_is_named(symbols: list[int], faults: tuple[str, ...]) -> None:
    assert read(symbols, 4)[1] == faults
    assert set(faults) <= set(mii.FAULTS)


def test_sizes_and_gaps_have_limits() -> None:
    def sent(size: int, gap: int = 96) -> tuple[str, ...]:
        frame = random.Random(size).randbytes(size)
        return read(symbols_of(b"\x55" * 7 + b"\xd5" + frame + mii.fcs(frame), 8), 8, gap)[1]

    assert sent(59) == ("too-short",)
    assert sent(60) == sent(1514) == ()
    assert sent(1515) == ("too-long",)
    assert sent(60, 95) == ("gap-short",)


@pytest.mark.parametrize("width", [4, 8])
@pytest.mark.parametrize("phases", [(0.0, 0.0), (0.1, 0.6), (0.5, 0.25)])
def test_frames_go_through_a_design_and_come_back(width: int, phases: tuple[float, float]) -> None:
    model, port = plugged(width, *phases, core=50e6 if width == 4 else 140e6)
    dice = random.Random(width)
    frames = [dice.randbytes(size) for size in (60, 61, 64, 333, 1514, 60)]
    with model:
        for frame in frames:
            port.send(frame)
        assert port.waiting == len(frames)
        model.run(2e-4 if width == 4 else 2.4e-5)
        got = port.receive()
        assert [one.frame for one in got] == frames
        # The echo waits for a level that it sees late, by a symbol or two where the core is hardly faster than the pins.
        jitter = 0 if width == 4 else 16
        assert {fault for one in got for fault in one.faults} <= ({"gap-short"} if jitter else set())
        assert all(abs(one.gap - 96) <= jitter for one in got[1:]), "they went in at line rate"
        assert model.get("frames") == len(frames) and port.waiting == 0
        length = (8 + 60 + 4) * 8 * (10e-9 if width == 4 else 1e-9)
        assert got[0].end - got[0].start == pytest.approx(length)


def test_a_short_frame_is_padded() -> None:
    model, port = plugged()
    with model:
        port.send(b"short")
        model.run(2e-5)
        assert port.receive()[0].frame == b"short".ljust(60, b"\0")


def test_what_is_wrong_goes_in_as_it_is_said() -> None:
    model, port = plugged()
    with model:
        port.send(ZEROS, check=bytes(4))
        port.send(ZEROS, preamble=2)
        port.send(ZEROS, errors=(5,))
        port.send_symbols(GOOD[:-1])
        port.send_symbols(nibbles("0123456789abcdef" * 2))
        model.run(5e-5)
        got = port.receive()
    assert [one.faults for one in got] == [
        ("fcs-wrong",),
        ("preamble-short",),
        ("error-raised",),
        ("nibbles-odd", "fcs-wrong", "too-short"),
        ("sfd-missing",),
    ]
    errors = [at for at, symbol in enumerate(got[2].symbols) if symbol & ERROR]
    assert errors == [16 + 10, 16 + 11]
    assert [symbol & 15 for symbol in got[4].symbols] == list(range(16)) * 2


def test_a_pause_within_a_frame_makes_two() -> None:
    model, port = plugged()
    with model:
        port.send_symbols(GOOD + [0] * 30 + GOOD)
        model.run(5e-5)
        got = port.receive()
    assert [(one.frame, one.faults) for one in got] == [(ZEROS, ()), (ZEROS, ())]
    assert got[1].gap == 120


def test_a_run_can_end_with_a_frame() -> None:
    model, port = plugged()
    with model:
        port.send(ZEROS)
        model.run(1.0, stop_at_frame=True)
        assert model.now < 1e-5
        assert len(port.receive()) == 1


def test_a_frame_without_end_is_cut() -> None:
    model, port = plugged()
    with model:
        port.send_symbols([VALID | 5] * 40_000)
        model.run(2e-3)
        (one,) = port.receive()
    assert len(one.symbols) == mii.MAX_OCTETS * 2


def test_pins_must_be_there() -> None:
    model, _ = plugged()
    with model:
        with pytest.raises(ValueError, match="no clock 'nothing' was started"):
            mii.Mii(model, mii.Pins(rx_clk="nothing"))
        with pytest.raises(ValueError, match="must have 4 bits"):
            mii.Mii(model, mii.Pins(rxd="wide"))
        with pytest.raises(ValueError, match="the design has no nothing"):
            mii.Mii(model, mii.Pins(rx_dv="nothing"))
