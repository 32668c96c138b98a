"""What Yosys's CXXRTL wrote of a design, cut into translation units that a compiler is soon done with.

CXXRTL writes one function, `eval()`, of all that happens at an edge: thousands of statements, each of which follows from
those before it. Compilers need time for it that grows faster than its length, and one core does it all. Cut into functions
it is compiled in a third of that time, by all cores, and runs as fast.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from roslet.errors import RosletError

# Characters of a function of statements: more takes the compiler longer, less keeps less in the processor's registers.
PART = 20_000

_EVAL = re.compile(r"^bool p_top::eval\(performer \*performer\) \{\n(.*?)^}\n", re.MULTILINE | re.DOTALL)
_LOCAL = re.compile(r"\t(value<\d+>) (\w+);")
_EDGE = re.compile(r"\tbool (?:pos|neg)edge_\w+ = .*;")
_WORD = re.compile(r"\w+")


class UnexpectedDesign(RosletError):
    """The design does not look as expected: a new Yosys."""


class Units(NamedTuple):
    """The files of a design, and what is known of it."""

    header: str  # "design.h", which the others and the driver include
    often: list[str]  # what runs at every edge
    seldom: str  # what does not: to be compiled without optimization, which takes most compilers the longest
    clocks: str  # ROSLET_CLOCK(pin, member) for each clock of which nothing but the rising edge matters
    feedback: bool  # whether wires feed back, so that a step may need several evaluations


def cut(design: str, count: int) -> Units:
    """The file that `write_cxxrtl` made, in `count` units and one more. Raises UnexpectedDesign."""
    found = _EVAL.search(design)
    start = design.find("\nvoid p_top::reset() {")
    end = design.find("\n}; // struct p_top")
    if found is None or not 0 < end < start < found.start():
        raise UnexpectedDesign("Yosys wrote a design without a p_top, or with its parts in another order")
    statements, local, edges, feedback = _statements(found[1])
    parts = _parts(statements)
    used: dict[str, set[int]] = {name: set() for name in local}
    for n, part in enumerate(parts):
        for name in local.keys() & set(_WORD.findall(part)):
            used[name].add(n)
    # What several parts know becomes a member, where it is none already: debug_eval() has some of them for itself.
    known = set(re.findall(r"^\t/\*outline\*/ value<\d+> (\w+);", design, re.MULTILINE))
    shared = [name for name, where in used.items() if len(where) > 1 and name not in known]
    members = [f"\t{local[name]} {name};" for name in shared]
    members += [f"\tvoid part{n}();" for n in range(len(parts))]

    functions = []
    for n, part in enumerate(parts):
        own = [f"\t{local[name]} {name};" for name, where in used.items() if where == {n}]
        functions.append("\n".join((f"void p_top::part{n}() {{", *edges, *own, part, "}")))
    calls = [f"\tpart{n}();" for n in range(len(parts))]
    converged = "false" if feedback else "true"
    functions.append(
        "\n".join(("bool p_top::eval(performer *performer) {", *calls, f"\treturn {converged};", "}"))
    )
    share = -(-len(functions) // count)
    return Units(
        "\n".join((design[:end], *members, design[end + 1 : start], "} // namespace cxxrtl_design", "")),
        [_unit("\n\n".join(functions[n * share : (n + 1) * share]) + "\n}\n") for n in range(count)],
        _unit(design[start : found.start()] + design[found.end() :]),
        _clocks(design, found[1]),
        feedback,
    )


def _unit(text: str) -> str:
    return f'#include "design.h"\n\nnamespace cxxrtl_design {{\n{text}'


def _statements(body: str) -> tuple[list[str], dict[str, str], list[str], bool]:
    """Of eval(): its statements, the types of its local values by their names, its lines that find the edges of clocks,
    and whether it may have to be called again."""
    statements: list[str] = []
    local: dict[str, str] = {}
    edges: list[str] = []
    feedback = None
    open_: list[str] = []  # the lines of a statement that goes on
    depth = 0
    for line in body.splitlines():
        if not line or line.lstrip().startswith("//"):
            continue
        if not open_:
            if declared := _LOCAL.fullmatch(line):
                local[declared[2]] = declared[1]
                continue
            if _EDGE.fullmatch(line):
                edges.append(line)
                continue
            if line.startswith("\tbool converged = "):
                feedback = "false" in line
                continue
            if line == "\treturn converged;":
                continue
        open_.append(line)
        depth += line.count("{") - line.count("}")
        # What is read of a memory without a clock: the index, and behind it the block that uses it.
        if depth == 0 and (line == "\t}" or not open_[0].startswith("\tauto ")):
            statements.append("\n".join(open_))
            open_ = []
    if feedback is None or open_ or any("converged" in statement for statement in statements):
        raise UnexpectedDesign("Yosys wrote a p_top::eval that does not end as expected")
    return statements, local, edges, feedback


def _parts(statements: list[str]) -> list[str]:
    """Statements in their order, so many together that they make up PART."""
    parts: list[list[str]] = []
    size = PART
    for statement in statements:
        if size >= PART:
            parts.append([])
            size = 0
        parts[-1].append(statement)
        size += len(statement)
    return ["\n".join(part) for part in parts]


def _clocks(design: str, body: str) -> str:
    lines = []
    for member in re.findall(r"^\tvalue<1> prev_(p_\w+);", design, re.MULTILINE):
        if re.search(rf"\b{member}\b|negedge_{member}\b", body):
            continue
        # Yosys doubles underscores in names, and begins them with p_ where they are public.
        name = member[2:].replace("__", "_")
        lines.append(f'ROSLET_CLOCK("{name}", prev_{member})\n')
    return "".join(lines)
