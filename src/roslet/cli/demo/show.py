"""What `roslet demo` does, shows and judges."""

from __future__ import annotations

import os
import pathlib
import statistics
import tempfile
import time
import zlib
from struct import unpack_from
from typing import TYPE_CHECKING, Any

from roslet.cli.demo import floor, gates
from roslet.cli.demo.programs import Program, Programs, cyclone_python
from roslet.cli.output import Live, emit_json, seconds_text, table

if TYPE_CHECKING:
    import argparse

PICTURES_PER_SECOND = 10.0
WIDTH, HEIGHT = 320, 240
# Seconds that each floor is timed, before and again after the nodes have talked.
FLOOR_SECONDS = 1.0
# Seconds beyond the planned ones for processes to start, find each other and end.
GRACE = 15.0
# Seconds between the talker's finding a CycloneDDS reader and the first message: that reader takes only what is sent after
# it has found the talker, which no writer is told.
SETTLE = 1.0
COORDINATE = "mros_comm_measure/Coordinate"
ROS1, ROS2 = "ROS 1", "ROS 2"
CYCLONE = "CycloneDDS"


def demonstrate(arguments: argparse.Namespace) -> int:
    """The demonstration; 0 where every message came and was right."""
    folder = pathlib.Path(arguments.folder or tempfile.mkdtemp(prefix="roslet-demo-"))
    folder.mkdir(parents=True, exist_ok=True)
    demo = _Demo(arguments, folder)
    demo.time_floors()
    demo.ros1()
    demo.ros2()
    demo.time_floors()
    if not arguments.no_gates:
        demo.gates()
    result = demo.result()
    if arguments.json:
        emit_json(result)
    else:
        _print(result)
    return 1 if result["problems"] else 0


class _Demo:
    """One run: what was timed, what the programs said, what was wrong."""

    def __init__(self, arguments: argparse.Namespace, folder: pathlib.Path) -> None:
        self.seconds: float = arguments.seconds
        self.rate: float = arguments.rate
        self.quiet: bool = arguments.json
        self.folder = folder
        self.points = max(1, round(self.seconds * self.rate))
        self.floors: dict[str, list[float]] = {ROS1: [], ROS2: []}
        self.figures: dict[str, dict[str, dict[str, Any]]] = {ROS1: {}, ROS2: {}}
        self.problems: list[str] = []
        self.simulated: dict[str, Any] | None = None

    def say(self, text: str) -> None:
        if not self.quiet:
            print(text, flush=True)

    def time_floors(self) -> None:
        if not self.floors[ROS1]:
            self.say(
                f"raw sockets: {self.rate:g} round trips a second, over TCP ({floor.SIZE} bytes) and over UDP "
                f"({floor.DATAGRAM} bytes) ..."
            )
        self.floors[ROS1] += floor.measure(FLOOR_SECONDS, self.rate)
        self.floors[ROS2] += floor.measure_datagrams(FLOOR_SECONDS, self.rate)

    def ros1(self) -> None:
        """A master, the Coordinate pair and the images."""
        from roslet.master.server import MasterServer

        pictures = max(1, round(self.seconds * PICTURES_PER_SECOND))
        limit = self.seconds + GRACE  # a program that waits for a lost message ends nevertheless
        with MasterServer("127.0.0.1", 0) as master, Programs(f"ros1://127.0.0.1:{master.port}") as programs:
            # Listeners first, so that the first message has somebody to hear it; the talkers wait for them.
            cast = {
                "listener": programs.start("coordinate_listener.py", "--count", self.points, "--seconds", limit),
                "viewer": programs.start(
                    "image_viewer.py", "--check", "--count", pictures, "--seconds", limit,
                    "--save", self.folder / "image.png",
                ),
                "talker": programs.start("coordinate_talker.py", "--count", self.points, "--rate", self.rate),
                "camera": programs.start(
                    "image_publisher.py", "--count", pictures, "--rate", PICTURES_PER_SECOND,
                    "--width", WIDTH, "--height", HEIGHT,
                ),
            }  # fmt: skip
            self.say(f"\n{ROS1}: ROS_MASTER_URI={master.uri}")
            self.say(f"processes: {', '.join(program.name for program in programs.all)}")
            self._watch(ROS1, cast, programs)
            left = _registered(master)
        if left:
            self.problems.append(f"still registered at the master: {', '.join(left)}")

    def ros2(self) -> None:
        """The same pair over RTPS, and CycloneDDS as a third party where it is installed."""
        domain = 1 + os.getpid() % 100  # hardly anybody else's; and it does not leave this host
        limit = self.seconds + GRACE
        python = cyclone_python()
        with Programs(f"ros2://{domain}?range=localhost") as programs:
            cast = {
                "listener": programs.start(
                    "coordinate_listener.py", "--count", self.points, "--seconds", limit
                )
            }
            if python is not None:
                cast["cyclone"] = programs.start_cyclone(python, domain, self.points, limit)
            self.say(f"\n{ROS2}: {programs.network}")
            for program in tuple(cast.values()):  # so that what the talker times is discovery
                program.wait_ready(GRACE)
            cast["talker"] = programs.start(
                "coordinate_talker.py", "--count", self.points, "--rate", self.rate,
                "--subscribers", len(cast), "--settle", SETTLE,
            )  # fmt: skip
            self.say(f"processes: {', '.join(program.name for program in programs.all)}")
            if python is None:
                self.say(f"{CYCLONE} is not installed: no third party listens")
            self._watch(ROS2, cast, programs)

    def gates(self) -> None:
        """A node in gates, and one in software, on a simulated wire."""
        missing = gates.missing()
        if missing is not None:
            self.say(f"\n{missing} is not installed: no node in gates takes part")
            return
        self.simulated = gates.simulate(self.say)
        self.problems += gates.judge(self.simulated)

    def _watch(self, network: str, cast: dict[str, Program], programs: Programs) -> None:
        """Show what the programs report, once a second, until they have ended or should have."""
        live = Live()
        before: dict[str, int] = {}
        told = False
        base = statistics.median(self.floors[network])
        began = then = time.monotonic()
        while any(program.running for program in programs.all):
            time.sleep(0.1)
            now = time.monotonic()
            if now - began > self.seconds + GRACE:
                break
            if self.quiet or now - then < 1.0:
                continue
            figures = {name: program.figures for name, program in cast.items()}
            if network == ROS2 and not told and "found" in figures["talker"]:
                told = True
                self.say(f"discovery: {_discovery(figures)}")
            counts = _counts(figures)
            rates = {topic: (count - before.get(topic, 0)) / (now - then) for topic, count in counts.items()}
            parts = _live_parts(counts, rates, figures["talker"].get("median"), base, now - began)
            live.show(("\n" if live.in_place else "  ").join(parts))
            before, then = counts, now
        self.problems += [
            f"{network}: {problem}" for program in programs.all if (problem := program.finish(GRACE))
        ]
        self.figures[network] = {name: program.figures for name, program in cast.items()}

    def result(self) -> dict[str, Any]:
        """The summary, and under `problems` what was wrong or missing."""
        result = judge(self.figures, self.floors, self.folder / "image.png")
        result["gates"] = self.simulated
        result["problems"] = self.problems + result["problems"]
        return result


def _discovery(figures: dict[str, dict[str, Any]]) -> str:
    talker = figures["talker"]
    found = talker.get("found")
    if found is None:
        return "-"
    others = "the listener" + (f" and {CYCLONE}" if "cyclone" in figures else "")
    return f"the talker, from the start of its node, was matched with {others} in {seconds_text(found)}"


def _counts(figures: dict[str, dict[str, Any]]) -> dict[str, int]:
    """Messages received so far, by topic."""
    counts = {
        "ping": figures["listener"].get("heard", 0),
        "pong": figures["talker"].get("returned", 0),
    }
    if "viewer" in figures:
        counts["image"] = figures["viewer"].get("received", 0)
    if "cyclone" in figures:
        counts[f"ping at {CYCLONE}"] = figures["cyclone"].get("heard", 0)
    return counts


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
    figures: dict[str, dict[str, dict[str, Any]]], floors: dict[str, list[float]], picture: pathlib.Path
) -> dict[str, Any]:
    """The summary of what the programs of each network last reported, and under `problems` what was wrong or missing."""
    problems: list[str] = []
    topics: list[dict[str, Any]] = []
    round_trips: list[dict[str, Any]] = []

    def exchange(network: str, topic: str, kind: str, sent: Any, received: Any, wrong: Any) -> None:
        right = bool(sent) and sent == received and wrong == 0
        if not right:
            problems.append(f"{network} {topic}: sent {sent}, received {received}, wrong {wrong}")
        row = {"network": network, "topic": topic, "type": kind, "sent": sent, "received": received}
        topics.append({**row, "wrong": wrong, "right": right})

    for network, programs in figures.items():
        talker, listener = programs.get("talker", {}), programs.get("listener", {})
        sent, heard = talker.get("sent"), listener.get("heard")
        exchange(network, "/ping", COORDINATE, sent, heard, listener.get("wrong"))
        exchange(network, "/pong", COORDINATE, heard, talker.get("returned"), talker.get("altered"))
        if "cyclone" in programs:
            other = programs["cyclone"]
            exchange(network, f"/ping at {CYCLONE}", COORDINATE, sent, other.get("heard"), other.get("wrong"))
        trips, base = sorted(talker.get("round_trips", ())), sorted(floors[network])
        if not trips:
            problems.append(f"{network}: no round trip was timed")
        if not base:
            problems.append(f"{network}: no round trip of raw sockets was timed")
        round_trips.append({"network": network, "roslet": _summary(trips), "floor": _summary(base)})
    camera, viewer = figures[ROS1].get("camera", {}), figures[ROS1].get("viewer", {})
    exchange(
        ROS1, "/image", "sensor_msgs/Image", camera.get("sent"), viewer.get("received"), viewer.get("wrong")
    )
    try:
        size = png_size(picture.read_bytes())
        if size != (WIDTH, HEIGHT):
            problems.append(f"{picture}: {size[0]} x {size[1]} pixels, expected {WIDTH} x {HEIGHT}")
    except (OSError, ValueError, zlib.error) as error:
        problems.append(f"{picture}: {error}")
    return {
        "topics": topics,
        "round_trips": round_trips,
        "discovery": figures[ROS2].get("talker", {}).get("found"),
        "cyclonedds": "cyclone" in figures[ROS2],
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
        ("NETWORK", "TOPIC", "TYPE", "SENT", "RECEIVED", "WRONG", "RESULT"),
        [
            (
                row["network"],
                row["topic"],
                row["type"],
                *("-" if row[key] is None else row[key] for key in ("sent", "received", "wrong")),
                "ok" if row["right"] else "WRONG",
            )
            for row in result["topics"]
        ],
    )
    print()
    timed = [one for one in result["round_trips"] if one["roslet"]["count"] and one["floor"]["count"]]
    table(
        ("ROUND TRIP", "COUNT", "MEDIAN", "99 %", "TO RAW"),
        [
            (
                f"{one['network']} {name}",
                one[key]["count"],
                seconds_text(one[key]["median"]),
                seconds_text(one[key]["p99"]),
                f"{one[key]['median'] / one['floor']['median']:.2f}",
            )
            for one in timed
            for name, key in (("roslet", "roslet"), ("raw sockets", "floor"))
        ],
    )
    if not result["cyclonedds"]:
        print(f"{CYCLONE} is not installed and took no part")
    if result["gates"]:
        found = result["gates"]
        print(
            f"gates: {len(found['heard'])} messages from them, {len(found['sent'])} to them, "
            f"{found.get('cycles', 0):,} cycles, {found.get('cycles a second', 0):,} a second"
        )
    print(f"picture: {result['picture']}")
    print()
    for problem in result["problems"]:
        print(f"WRONG: {problem}")
    print("failed" if result["problems"] else "every message came and was right")
