"""Printing: aligned tables, JSON, lines that are updated in place on a terminal."""

from __future__ import annotations

import json
import math
import os
import shutil
import sys
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


def table(headings: Sequence[str], rows: Iterable[Sequence[Any]], indent: str = "") -> None:
    """Print rows in aligned columns; numbers to the right. Prints nothing at all where there are no rows."""
    lines = [[str(cell) for cell in row] for row in rows]
    if not lines:
        return
    numeric = [all(_is_number(line[at]) for line in lines) for at in range(len(headings))]
    lines.insert(0, list(headings))
    widths = [max(len(line[at]) for line in lines) for at in range(len(headings))]
    for line in lines:
        cells = [
            cell.rjust(width) if right else cell.ljust(width)
            for cell, width, right in zip(line, widths, numeric, strict=True)
        ]
        print((indent + "  ".join(cells)).rstrip())


def _is_number(text: str) -> bool:
    return text in ("", "-") or text.replace(".", "", 1).isdigit()


def section(title: str, rows: Sequence[Sequence[str]], nothing: str = "none") -> None:
    """Print a titled list of aligned rows; says `nothing` where it is empty."""
    if not rows:
        print(f"{title}: {nothing}")
        return
    print(f"{title}:")
    columns = max(len(row) for row in rows)
    widths = [max(len(row[at]) if at < len(row) else 0 for row in rows) for at in range(columns)]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=False)]
        print(("  " + "  ".join(cells)).rstrip())


def note(text: str) -> None:
    """Something for a person, not for a pipe."""
    print(text, file=sys.stderr, flush=True)


def note_nothing(what: str, prefix: str) -> None:
    """Say that there is nothing to list of which the name begins so."""
    note(f"no {what}" if prefix == "/" else f"no {what} below {prefix}")


def emit_json(value: Any, indent: int | None = 2) -> None:
    """Print one JSON document; `indent` None for one line. Numbers that JSON lacks become "NaN" and "Infinity"."""
    print(json_text(value, indent), flush=indent is None)


def json_text(value: Any, indent: int | None = None) -> str:
    """`value` as JSON text."""
    try:
        return json.dumps(value, indent=indent, allow_nan=False)
    except ValueError:
        return json.dumps(finite(value), indent=indent)


def finite(value: Any) -> Any:
    """`value` with the floats that JSON lacks as strings, spelled as the JSON mapping of Protocol Buffers does."""
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    if isinstance(value, dict):
        return {key: finite(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [finite(inner) for inner in value]
    return value


class Live:
    """Text that replaces what it showed before, on a terminal; elsewhere one after the other."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self.stream = sys.stdout if stream is None else stream
        self.in_place = self.stream.isatty() and os.environ.get("TERM", "dumb") != "dumb"
        self._height = 0

    def show(self, text: str) -> None:
        """Show `text`, of one or more lines."""
        lines = text.split("\n")
        if self.in_place:
            size = shutil.get_terminal_size()
            # A line that wraps, or more lines than the terminal has, could not be taken back.
            lines = [line[: size.columns - 1] for line in lines[: max(1, size.lines - 1)]]
            if self._height:
                self.stream.write(f"\x1b[{self._height}A\r\x1b[J")
            self._height = len(lines)
        self.stream.write("\n".join(lines) + "\n")
        self.stream.flush()


def bytes_text(count: float) -> str:
    """A number of bytes for people: 1.50 MB."""
    for unit in ("B", "kB", "MB"):
        if count < 1000:
            return f"{count:.0f} B" if unit == "B" else f"{count:.2f} {unit}"
        count /= 1000
    return f"{count:.2f} GB"


def seconds_text(seconds: float) -> str:
    """A duration for people: 85.1 us, 2.3 ms, 1.2 s."""
    if seconds < 1e-3:
        return f"{seconds * 1e6:.1f} us"
    if seconds < 1:
        return f"{seconds * 1e3:.1f} ms"
    return f"{seconds:.2f} s"
