"""What `roslet demo` does, shows and judges."""

from __future__ import annotations

import pathlib
import statistics
import tempfile
import time
import zlib
from struct import unpack_from
from typing import TYPE_CHECKING, Any

from roslet.cli.demo import floor
from roslet.cli.demo.programs import Program, Programs
from roslet.cli.output import Live, emit_json, seconds_text, table

if TYPE_CHECKING:
    import argparse

PICTURES_PER_SECOND = 10.0
WIDTH, HEIGHT = 320, 240
# Seconds that the floor is timed, before and again after the nodes have talked.
FLOOR_SECONDS = 1.5
# Seconds beyond the planned ones for processes to start, find each other and end.
GRACE = 15.0


def demonstrate(arguments: argparse.Namespace) -> int:
    """The demonstration; 0 where every message came and was right."""
    from roslet.master.server import MasterServer

    folder = pathlib.Path(arguments.folder or tempfile.mkdtemp(prefix="roslet-demo-"))
    folder.mkdir(parents=True, exist_ok=True)
    quiet = arguments.json

    def say(text: str) -> None:
        if not quiet:
            print(text, flush=True)

    say(
        f"raw sockets: {arguments.rate:g} round trips of {floor.SIZE} bytes a second, {FLOOR_SECONDS:g} s ..."
    )
    trips = floor.measure(FLOOR_SECONDS, arguments.rate)
    with MasterServer("127.0.0.1", 0) as master, Programs(f"ros1://127.0.0.1:{master.port}") as programs:
        say(f"master:      ROS_MASTER_URI={master.uri}")
        cast = _start(programs, arguments.seconds, arguments.rate, folder)
        say(f"processes:   {', '.join(program.name for program in programs.all)}")
        _watch(cast, programs, arguments, trips, quiet)
        problems = [problem for program in programs.all if (problem := program.finish(GRACE))]
        left = _registered(master)
    trips += floor.measure(FLOOR_SECONDS, arguments.rate)
    result = judge({name: program.figures for name, program in cast.items()}, trips, folder / "image.png")
    result["problems"] = problems + result["problems"]
    if left:
        result["problems"].append(f"still registered at the master: {', '.join(left)}")
    if quiet:
        emit_json(result)
    else:
        _print(result)
    return 1 if result["problems"] else 0


def _start(programs: Programs, seconds: float, rate: float, folder: pathlib.Path) -> dict[str, Program]:
    """Listeners first, so that the first message has somebody to hear it; the talkers wait for them."""
    points = max(1, round(seconds * rate))
    pictures = max(1, round(seconds * PICTURES_PER_SECOND))
    limit = seconds + GRACE  # a program that waits for a lost message ends nevertheless
    return {
        "listener": programs.start("coordinate_listener.py", "--count", points, "--seconds", limit),
        "viewer": programs.start(
            "image_viewer.py", "--check", "--count", pictures, "--seconds", limit, "--save", folder / "image.png"
        ),
        "talker": programs.start("coordinate_talker.py", "--count", points, "--rate", rate),
        "camera": programs.start(
            "image_publisher.py", "--count", pictures, "--rate", PICTURES_PER_SECOND,
            "--width", WIDTH, "--height", HEIGHT,
        ),
    }  # fmt: skip


def _watch(
    cast: dict[str, Program],
    programs: Programs,
    arguments: argparse.Namespace,
    trips: list[float],
    quiet: bool,
) -> None:
    """Show what the programs report, once a second, until they have ended or should have."""
    live = Live()
    before: dict[str, int] = {}
    began = then = time.monotonic()
    while any(program.running for program in programs.all):
        time.sleep(0.1)
        now = time.monotonic()
        if now - began > arguments.seconds + GRACE:
            return
        if quiet or now - then < 1.0:
            continue
        figures = {name: program.figures for name, program in cast.items()}
        counts = {
            "ping": figures["listener"].get("heard", 0),
            "pong": figures["talker"].get("returned", 0),
            "image": figures["viewer"].get("received", 0),
        }
        rates = {topic: (count - before.get(topic, 0)) / (now - then) for topic, count in counts.items()}
        median, base = figures["talker"].get("median"), statistics.median(trips)
        parts = _live_parts(counts, rates, median, base, now - began)
        live.show(("\n" if live.in_place else "  ").join(parts))
        before, then = counts, now


def _live_parts(
    counts: dict[str, int], rates: dict[str, float], median: float | None, base: float, seconds: float
) -> list[str]:
    parts = [f"{seconds:5.1f} s"]
    parts += [f"/{topic} {rates[topic]:6.1f} Hz ({count})" for topic, count in counts.items()]
    if median:
        parts.append(f"round trip {seconds_text(median)}, raw sockets {seconds_text(base)}")
    return parts


def _registered(master: Any) -> list[str]:
    """Nodes that the master still knows after all have ended."""
    code, _, state = master.call("getSystemState", "/demo")
    return sorted({node for part in state for _, nodes in part for node in nodes}) if code == 1 else ["?"]


def judge(
    figures: dict[str, dict[str, Any]], floor_trips: list[float], picture: pathlib.Path
) -> dict[str, Any]:
    """The summary of what the programs last reported, and under `problems` what was wrong or missing."""
    talker, listener = figures["talker"], figures["listener"]
    camera, viewer = figures["camera"], figures["viewer"]
    problems: list[str] = []
    topics = []
    for topic, kind, sent, received, wrong in (
        (
            "/ping",
            "mros_comm_measure/Coordinate",
            talker.get("sent"),
            listener.get("heard"),
            listener.get("wrong"),
        ),
        (
            "/pong",
            "mros_comm_measure/Coordinate",
            listener.get("heard"),
            talker.get("returned"),
            talker.get("altered"),
        ),
        ("/image", "sensor_msgs/Image", camera.get("sent"), viewer.get("received"), viewer.get("wrong")),
    ):
        right = bool(sent) and sent == received and wrong == 0
        if not right:
            problems.append(f"{topic}: sent {sent}, received {received}, wrong {wrong}")
        topics.append(
            {"topic": topic, "type": kind, "sent": sent, "received": received, "wrong": wrong, "right": right}
        )
    trips = sorted(talker.get("round_trips", ()))
    if not trips:
        problems.append("no round trip was timed")
    if not floor_trips:
        problems.append("no round trip of raw sockets was timed")
    try:
        size = png_size(picture.read_bytes())
        if size != (WIDTH, HEIGHT):
            problems.append(f"{picture}: {size[0]} x {size[1]} pixels, expected {WIDTH} x {HEIGHT}")
    except (OSError, ValueError, zlib.error) as error:
        problems.append(f"{picture}: {error}")
    return {
        "topics": topics,
        "round_trip": _summary(trips),
        "floor": _summary(sorted(floor_trips)),
        "picture": str(picture),
        "problems": problems,
    }


def _summary(trips: list[float]) -> dict[str, Any]:
    """Of sorted round trips: how many, median and 99th percentile in seconds."""
    if not trips:
        return {"count": 0, "median": None, "p99": None}
    return {
        "count": len(trips),
        "median": statistics.median(trips),
        "p99": trips[int(0.99 * (len(trips) - 1))],
    }


def png_size(data: bytes) -> tuple[int, int]:
    """Width and height of a PNG file of one IDAT chunk, every chunk's checksum and the rows' length checked.

    Raises ValueError, zlib.error.
    """
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("no PNG file")
    chunks: dict[bytes, bytes] = {}
    at = 8
    while at + 12 <= len(data):
        length: int = unpack_from(">I", data, at)[0]
        name, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        if len(data) < at + 12 + length or unpack_from(">I", data, at + 8 + length)[0] != zlib.crc32(
            name + body
        ):
            raise ValueError(f"the PNG chunk at byte {at} is damaged")
        chunks[name] = body
        at += 12 + length
    if len(chunks.get(b"IHDR", b"")) != 13 or b"IDAT" not in chunks or b"IEND" not in chunks:
        raise ValueError("the PNG file is not whole")
    width, height = unpack_from(">II", chunks[b"IHDR"])
    if len(zlib.decompress(chunks[b"IDAT"])) != height * (1 + 3 * width):
        raise ValueError("the PNG file has not as many rows as it says")
    return int(width), int(height)


def _print(result: dict[str, Any]) -> None:
    print()
    table(
        ("TOPIC", "TYPE", "SENT", "RECEIVED", "WRONG", "RESULT"),
        [
            (
                row["topic"],
                row["type"],
                "-" if row["sent"] is None else row["sent"],
                "-" if row["received"] is None else row["received"],
                "-" if row["wrong"] is None else row["wrong"],
                "ok" if row["right"] else "WRONG",
            )
            for row in result["topics"]
        ],
    )
    trip, base = result["round_trip"], result["floor"]
    print()
    if trip["count"] and base["count"]:
        table(
            ("ROUND TRIP", "COUNT", "MEDIAN", "99 %"),
            [
                (name, part["count"], seconds_text(part["median"]), seconds_text(part["p99"]))
                for name, part in (("roslet", trip), ("raw sockets", base))
            ],
        )
        print(f"roslet takes {trip['median'] / base['median']:.2f} times what raw sockets take")
    print(f"picture: {result['picture']}")
    print()
    for problem in result["problems"]:
        print(f"WRONG: {problem}")
    print("failed" if result["problems"] else "every message came and was right")
