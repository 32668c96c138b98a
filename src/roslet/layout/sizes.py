"""Minimum and maximum sizes, by walking a layout's operations with the shortest and the longest content.

Padding makes sizes depend on the position, but moving a position up to a multiple never reorders two
positions: what starts later ends no earlier. Hence the longest message is the one whose every variable part
is longest.
"""

from __future__ import annotations

from roslet.layout.operations import PRIMITIVE_SIZE, Numbers, Octets, Run, Text

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.layout.operations import Operation, Sequence

PERIOD = 8
"""Alignment repeats after so many bytes: no primitive of either encoding aligns to more."""


def extent(operations: tuple[Operation, ...], start: int, longest: bool) -> int | None:
    """The bytes that `operations` take from position `start`; None where the longest content has no bound."""
    position = start
    for operation in operations:
        if isinstance(operation, Run):
            position += -position % operation.align + operation.size
        elif isinstance(operation, Text):
            if not longest:
                # The NUL was not counted in the length slot: an empty string still has it.
                position += operation.terminator
            elif operation.bound is None:
                return None
            else:
                position += operation.bound * (4 if operation.wide else 1) + operation.terminator
        elif isinstance(operation, Octets):
            if longest:
                if operation.bound is None:
                    return None
                position += operation.bound
        elif isinstance(operation, Numbers):
            if longest:
                if operation.bound is None:
                    return None
                position += -position % operation.align + operation.pad
                position += operation.bound * PRIMITIVE_SIZE[operation.primitive]
        else:
            after = _repeat(operation, position, longest)
            if after is None:
                return None
            position = after
    return position - start


def _repeat(sequence: Sequence, position: int, longest: bool) -> int | None:
    if sequence.kind == "fixed":
        count = sequence.size or 0
    elif not longest:
        count = 0
    elif sequence.size is None:
        return None
    else:
        count = sequence.size
    operations = sequence.element.operations
    seen: dict[int, tuple[int, int]] = {}
    done = 0
    while done < count:
        phase = position % PERIOD
        if phase in seen:  # the sizes repeat from here on
            before, then = seen[phase]
            cycle = done - before
            position += (position - then) * ((count - done) // cycle)
            count = done + (count - done) % cycle
            seen = {}
            if done == count:
                break
        seen[phase] = (done, position)
        size = extent(operations, position, longest)
        if size is None:
            return None
        position += size
        done += 1
    return position


def message_sizes(operations: tuple[Operation, ...]) -> tuple[int, int | None]:
    """Exact minimum and maximum of a whole message's body."""
    shortest = extent(operations, 0, False)
    return shortest or 0, extent(operations, 0, True)


def element_sizes(operations: tuple[Operation, ...], aligned: bool) -> tuple[int, int | None]:
    """Bounds that hold wherever an element starts."""
    starts = range(PERIOD) if aligned else range(1)
    shortest = [extent(operations, start, False) or 0 for start in starts]
    longest = [extent(operations, start, True) for start in starts]
    if longest[0] is None:
        return min(shortest), None
    return min(shortest), max([size or 0 for size in longest])
