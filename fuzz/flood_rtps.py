"""Invariant: a million hostile datagrams later, a participant holds no more than its limits, and no more memory than after
the first hundred thousand.

    python fuzz/flood_rtps.py [DATAGRAMS]     some minutes for the million; no fuzzer is needed
"""

from __future__ import annotations

import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import fuzz_rtps_participant as target

from engine.rtps import discovery, hand

# Octets that a participant at all its limits may hold: histories, held samples, fragments, discovery data.
MAX_HELD = 16 << 20


def flood(count: int) -> int:
    """Random submessages of many peers, real and invented, at a participant; the most octets that it held."""
    source = random.Random(1)
    participant = target.met()
    now, most = 0.0, 0
    for number in range(count):
        now += 0.0005
        octets = bytes(source.randrange(256) for _ in range(40))
        program = target.Program(octets)
        kind = number % 16
        if kind == 0:
            stranger = bytes((1, 1)) + source.randrange(1 << 20).to_bytes(10, "big")
            datagram = hand.spdp(source.choice((*target.PEERS[:2], stranger)), sequence=number + 1)
        elif kind == 1:
            datagram = source.randbytes(source.randrange(100))
        else:
            datagram = hand.message(target.said(program), prefix=source.choice(target.PEERS[:2]))
        participant.receive_datagram(datagram, hand.SOURCE, now)
        if number % 8 == 0:
            participant.handle_deadline(now)
            participant.datagrams_to_send(now)
            participant.take_events()
        if number % (count // 20 or 1) == 0:
            target.within(participant)
            most = max(most, discovery.held(participant))
            if most > MAX_HELD:
                raise AssertionError(f"{most} octets after {number} datagrams")
    return most


def main() -> None:
    """The command."""
    count = int(sys.argv[1]) if sys.argv[1:] else 1000000
    most = flood(count)
    print(f"{count} datagrams, within the limits", file=sys.stdout)
    print(f"{most} octets held at most", file=sys.stderr)


if __name__ == "__main__":
    main()
