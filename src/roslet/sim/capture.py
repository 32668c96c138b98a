"""Captures that tshark and Wireshark read: classic pcap with nanoseconds."""

from __future__ import annotations

import pathlib
import struct

from roslet.sim.link import Damaged, Link, Listened

# draft-ietf-opsawg-pcap, 4: the magic number of nanosecond files, version 2.4, the longest frame, LINKTYPE_ETHERNET.
_HEADER = struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 262144, 1)
_RECORD = struct.Struct("<IIII")
NANOSECONDS = 10**9


class Capture:
    """A file that frames are written to. `start`: seconds of the Unix epoch at time 0 of the wire. Damaged frames have no
    place in such a file, and are counted: `damaged`."""

    def __init__(self, path: str | pathlib.Path, start: int = 0) -> None:
        self.frames = 0
        self.damaged = 0
        self._start = start * NANOSECONDS
        self._file = open(path, "wb")  # noqa: SIM115 - closed by close()
        self._file.write(_HEADER)

    def write(self, frame: bytes, now: float) -> None:
        """One frame."""
        if isinstance(frame, Damaged):
            self.damaged += 1
            return
        seconds, nanoseconds = divmod(self._start + round(now * NANOSECONDS), NANOSECONDS)
        self._file.write(_RECORD.pack(seconds, nanoseconds, len(frame), len(frame)) + frame)
        self.frames += 1

    def around(self, inner: Link) -> Link:
        """A link whose frames are written, in both directions."""
        return Listened(inner, lambda frame, now, outwards: self.write(frame, now))

    def close(self) -> None:
        """The file is complete. Closing twice is allowed."""
        self._file.close()

    def __enter__(self) -> Capture:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
