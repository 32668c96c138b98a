"""What a run leaves: a page that needs nothing else, JSON, CSV, the plots, and the tables for a document."""

from __future__ import annotations

import csv
import html
from typing import TYPE_CHECKING, Any

from roslet.cli.bench import plots
from roslet.cli.bench.tables import tables
from roslet.cli.output import json_text

if TYPE_CHECKING:
    import pathlib

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 75rem; padding: 0 1rem; color: #222 }
div { overflow-x: auto } svg { max-width: 100%; height: auto }
table { border-collapse: collapse; font-size: 13px } td, th { padding: .25rem .6rem; border-bottom: 1px solid #ddd }
td { text-align: right } th { text-align: left } tr.quoted { color: #777; font-style: italic }
ul.problems { color: #a00 }
"""
NO_PLOTS = "matplotlib is not installed (pip install 'roslet[plots]'): no plots."
COLUMNS = ("count", "lost", "mean", "min", "quartile1", "median", "quartile3", "p99", "max")


def drawings(result: dict[str, Any]) -> dict[str, str]:
    """The plots as SVG, by file name; none where nothing was measured or matplotlib is missing."""
    if not result.get("rtt") or not plots.available():
        return {}
    cases = result["rtt"]["cases"]
    found = {}
    if any(case != "coordinate" for case in cases):
        found["rtt-strings.svg"] = plots.strings(result)
    if "coordinate" in cases:
        found["rtt-coordinate.svg"] = plots.coordinate(result)
    return found


def page(result: dict[str, Any], drawn: dict[str, str]) -> str:
    """The HTML page."""
    about = result["about"]
    facts = "".join(
        f"<li>{html.escape(name)}: {html.escape(str(value))}</li>" for name, value in about.items()
    )
    wrong = "".join(f"<li>{html.escape(one)}</li>" for one in result["problems"])
    problems = f'<h2>Problems</h2><ul class="problems">{wrong}</ul>' if wrong else ""
    # What stands before <svg> is a declaration, which a page must not hold.
    pictures = "".join(f"<div>{svg[svg.index('<svg') :]}</div>" for svg in drawn.values())
    if result.get("rtt") and not drawn:
        pictures = f"<p>{NO_PLOTS}</p>"
    body = "".join(table.html() for table in tables(result))
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>roslet bench</title>'
        f"<style>{STYLE}</style></head><body><h1>roslet bench</h1><ul>{facts}</ul>{problems}{pictures}{body}</body></html>\n"
    )


def write(result: dict[str, Any], folder: pathlib.Path) -> list[pathlib.Path]:
    """Write everything into a folder, which is made; the paths."""
    folder.mkdir(parents=True, exist_ok=True)
    drawn = drawings(result)
    texts = {
        "report.html": page(result, drawn),
        "results.json": json_text(result) + "\n",
        "tables.md": "\n\n".join(table.markdown() for table in tables(result)) + "\n",
        **drawn,
    }
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    paths = [folder / name for name in texts]
    if result.get("rtt"):
        path = folder / "rtt.csv"
        with path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["stack", "case", *COLUMNS])
            for name, cases in result["rtt"]["figures"].items():
                for case, one in cases.items():
                    writer.writerow([name, case, *(round(one[column], 3) for column in COLUMNS)])
        paths.append(path)
    return paths
