"""Tables, once as data: what is printed, put in a page, or in a document."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import Any

from roslet.cli.bench import paper


@dataclass(frozen=True)
class Table:
    """A table with its title, a note below it, and the rows that are only quoted, by their first cell."""

    title: str
    headings: list[str]
    rows: list[list[str]]
    note: str = ""
    quoted: frozenset[str] = frozenset()

    def html(self) -> str:
        """As an element of a page."""
        head = "".join(f"<th>{html.escape(cell)}</th>" for cell in self.headings)
        body = []
        for row in self.rows:
            kind = ' class="quoted"' if row[0] in self.quoted else ""
            first, *rest = (html.escape(cell) for cell in row)
            body.append(f"<tr{kind}><th>{first}</th>{''.join(f'<td>{cell}</td>' for cell in rest)}</tr>")
        note = f"<p>{html.escape(self.note)}</p>" if self.note else ""
        table = f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(body)}</tbody></table>"
        return f"<h3>{html.escape(self.title)}</h3><div>{table}</div>{note}"

    def markdown(self) -> str:
        """As a part of a document."""
        lines = ["| " + " | ".join(self.headings) + " |", "|---" * len(self.headings) + "|"]
        for row in self.rows:
            cells = [f"*{cell}*" if cell and row[0] in self.quoted else cell for cell in row]
            lines.append("| " + " | ".join(cells) + " |")
        note = f"\n\n{self.note}" if self.note else ""
        return f"**{self.title}**\n\n" + "\n".join(lines) + note


def number(value: float | None) -> str:
    """Of microseconds or ratios: three digits, or all before the point."""
    if value is None:
        return "-"
    return f"{value:,.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def published(name: str) -> str:
    """A row of the paper's."""
    return f"{name} ({paper.MARK})"


def trips(result: dict[str, Any]) -> list[Table]:
    """Tables 1 to 3 of the paper: means, as there; medians, with the spread of the rounds; medians over the floor's."""
    found = result["rtt"]
    figures, names = found["figures"], found["cases"]
    heads = [case if case == paper.COORDINATE else f"{int(case):,} B" for case in names]
    quoted = {
        published(name): [number(values.get(case)) for case in names] for name, values in paper.MEANS.items()
    }

    def rows(key: str) -> list[list[str]]:
        return [
            [name, *(number(cases[case][key]) if case in cases else "-" for case in names)]
            for name, cases in figures.items()
        ]

    lost = sum(int(one["lost"]) for cases in figures.values() for one in cases.values())
    means = Table(
        "Mean round trip, microseconds (the paper's Tables 1 to 3)",
        ["", *heads],
        rows("mean") + [[name, *cells] for name, cells in quoted.items()],
        f"{found['count']} messages of each size in each of {found['rounds']} rounds; {lost} lost. The paper's rows are of "
        "another board, network and computer: no comparison in absolute terms.",
        frozenset(quoted),
    )
    medians = Table("Median round trip, microseconds", ["", *heads], rows("median"))
    spread = [
        [
            name,
            *(
                f"{number(cases[case]['lowest round'])} to {number(cases[case]['highest round'])}"
                if case in cases
                else "-"
                for case in names
            ),
        ]
        for name, cases in figures.items()
    ]
    noise = Table(
        "Noise: the least and the greatest median of a round, microseconds",
        ["", *heads],
        spread,
        noise_text(found),
    )
    tail = Table("99th percentile, microseconds", ["", *heads], rows("p99"))
    over = Table(
        "Median over that of the floor in the same rounds",
        ["", *heads],
        [[name, *(number(values.get(case)) for case in names)] for name, values in found["ratios"].items()],
        "The floor is raw blocking sockets in Python: TCP for ROS 1, UDP for ROS 2.",
    )
    return [means, medians, over, tail, noise] if found["rounds"] > 1 else [means, medians, over, tail]


def noise_text(found: dict[str, Any]) -> str:
    """What else the machine did."""
    loads = ", ".join(f"{load:.1f}" for load in found["load"])
    return (
        f"Load average of the machine at the beginning of each round: {loads}, on {found['processors']} processors. Others "
        f"used {found['others']:.1f} processors on average while these ran."
    )


def gates(result: dict[str, Any]) -> list[Table]:
    """The node in gates: no round trip, but its own share of one."""
    found = result["gates"]["turnaround"]
    row = [number(found[key]) for key in ("min", "median", "p99", "max")]
    return [
        Table(
            "A node in gates, simulated: turnaround of a Coordinate, microseconds",
            ["", "min", "median", "99 %", "max"],
            [["roslet in gates, 100 MHz, 100 Mbit/s", *row]],
            "Pin to pin, in time of the design, exact to a cycle of the PHY's clock: from the last nibble in to the first "
            "one out. It is the echo node's share alone, without a sender or a kernel.",
        )
    ]


def validity(result: dict[str, Any]) -> list[Table]:
    """Who read what as it was written."""
    found = result["validity"]["peers"]
    types = list(dict.fromkeys(name for one in found.values() for name in one))
    return [
        Table(
            "Validity: messages of which every value was right at the peer and again on its way back",
            ["type", *found],
            [[name, *(one.get(name, "-") for one in found.values())] for name in types],
            "roslet publishes; the peer says each value that it read, and publishes the message; roslet reads that. "
            "'-': the peer has no such type.",
        )
    ]


def size(result: dict[str, Any]) -> list[Table]:
    """As the paper's Table 4, for what is comparable here."""
    found = result["size"]
    tables = []
    if found["sections"] or found["gates"]:
        quoted = {published(name): one for name, one in paper.PROGRAM_BYTES.items()}
        luts = ["-"] if found["gates"] else []  # a column only where there is something for it
        rows = [
            [name, *(f"{value:,}" for value in one), f"{sum(one):,}", *luts]
            for name, one in (*found["sections"].items(), *quoted.items())
        ]
        at = len(found["sections"])
        rows[at:at] = [[name, *("-" * 4), f"{number:,}"] for name, number in found["gates"].items()]
        tables.append(
            Table(
                "Echo node as a program, bytes (the paper's Table 4)",
                ["", "text", "data", "bss", "all", *(["LUT4"] if luts else [])],
                rows,
                "The roscpp program is linked with shared libraries, which are not in this; the paper's hold their system.",
                frozenset(quoted),
            )
        )
    rows = [[name, f"{one['bytes']:,}", one["what"]] for name, one in found["installed"].items()]
    tables.append(Table("Installed, bytes", ["", "bytes", "what"], rows))
    if found["memory"]:
        rows = [[name, f"{value / 1e6:.1f}"] for name, value in found["memory"].items()]
        tables.append(
            Table(
                "Memory of the echo node as a process, greatest resident, MB",
                ["", "MB"],
                rows,
                "Shared libraries are counted in each.",
            )
        )
    return tables


def porting(result: dict[str, Any]) -> list[Table]:
    """As the paper's Table 5."""
    found = result["porting"]
    rows = [
        [
            one["from"],
            one["to"],
            one["program"],
            *(str(one[key]) for key in ("added", "changed", "deleted", "all")),
            one["verified"],
        ]
        for one in found["rows"]
    ]
    quoted = []
    for (name, program), (edge, host) in paper.PORTING.items():
        sums = [one + other for one, other in zip(edge, host, strict=True)]
        quoted.append([published(name), "", program, *map(str, sums), str(sum(sums)), ""])
    return [
        Table(
            "Porting cost, lines (the paper's Table 5)",
            ["from", "to", "program", "added", "changed", "deleted", "all", "run"],
            rows + quoted,
            "Lines that hold code, by difflib: of a block that is replaced, as many as both sides have count as changed. "
            "The paper's rows are edge and host together.",
            frozenset(row[0] for row in quoted),
        )
    ]


def tables(result: dict[str, Any]) -> list[Table]:
    """All of a result."""
    makers = {"rtt": trips, "gates": gates, "validity": validity, "size": size, "porting": porting}
    return [table for part, make in makers.items() if result.get(part) for table in make(result)]
