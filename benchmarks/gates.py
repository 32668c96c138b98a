"""What the ROS 2 node in gates costs, and how quick it is.

    python benchmarks/gates.py [--only size,echo,latency,publish] [--messages N] [--designs TEXT] [--json]

size     LUTs, flip-flops, block RAMs and MHz on ECP5, speed grade 6, routed: `Ros2Ether` with the manual's constants, and
         `RosNode` with 1, 4 and 16 topics each way; and on an iCE40 HX8K the example serial-count, and a node that only
         publishes a number. --designs: those with TEXT
echo     the example typed-echo, pin to pin: from the last nibble of a Coordinate on `ping` to the first of the preamble of
         the one on `pong`, N times (1,000 unless told otherwise), each at any moment of an idle node
latency  the manual's node with the user logic of topic-pub-sub: from `ros2_pub_app_data_rel` to the first nibble of the
         preamble, and from the last nibble of a message to `ros2_sub_app_data_recv`, N of each
publish  messages of 64 octets, published as quickly as the node takes them: how much of the wire they fill

Times are of the simulated design with `clk` of 100 MHz and a PHY of 100 Mbit/s, to a cycle of the PHY's: they are the same
wherever this is run. Sizes need Yosys and nextpnr, and take minutes each.
"""

from __future__ import annotations

import argparse
import functools
import json
import pathlib
import random
import runpy
import statistics
import sys
import tempfile
from collections.abc import Callable
from typing import Any

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import connect

import roslet
from roslet.cli.gateware import ROS_SETTINGS, SETTINGS
from roslet.cli.gateware_ros import QOS, ParticipantStation
from roslet.engine.rtps import events
from roslet.errors import RosletError
from roslet.gateware.boards import lattice
from roslet.gateware.boards.pinned import Pinned
from roslet.gateware.config import Config
from roslet.gateware.tops.links import Serial
from roslet.gateware.tops.ros2_ether import Ros2Ether
from roslet.gateware.tops.ros_node import Publish, RosNode, Subscribe
from roslet.gateware.wires import expose
from roslet.gen.runtime import message_class
from roslet.names.ros2 import TOPIC, dds_topic, dds_type
from roslet.sim.mii import Mii, Sent
from roslet.sim.model import PICOSECONDS, Model
from roslet.sim.wire import GatewareStation, Wire
from roslet.wire.rtps import qos
from roslet.wire.rtps.qos import Qos

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
COORDINATE, STRING, BLOCK = "mros_comm_measure/msg/Coordinate", "std_msgs/msg/String", "bench_msgs/msg/Block"
BLOCK_TEXT = "uint8[64] data\n"
BEST_EFFORT = Qos((qos.BEST_EFFORT, qos.DEFAULT_BLOCKING), history=(qos.KEEP_LAST, 1))
CLOCK, PHY_CLOCK, NIBBLE = 100e6, 25e6, 4
SERIAL_CLOCK = 25_000_000
FACTOR = 50.0
"""Seconds of the wire in one of the design's own time: periods of the protocol are seconds of the wire."""
CLOCKS = {"clk": CLOCK, "phy_rx_clk": PHY_CLOCK, "phy_tx_clk": PHY_CLOCK}
GAP = 12
"""Octets between frames. IEEE 802.3, 4.4.2."""


class Echoes(wiring.Component):
    """A node with so many topics each way, each of which sends back what comes."""

    def __init__(self, topics: int, **options: Any) -> None:
        self._topics = topics
        pairs = [(Subscribe(f"in{n}", COORDINATE), Publish(f"out{n}", COORDINATE)) for n in range(topics)]
        self._node = RosNode("echoes", topics=[topic for pair in pairs for topic in pair], **options)
        members = self._node.signature.members
        self._pins = [name for name in members if not name.startswith(("in", "out"))]
        super().__init__({name: members[name] for name in self._pins})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.node = node = self._node
        expose(m, node, self, self._pins)
        for n in range(self._topics):
            connect(m, getattr(node, f"in{n}"), getattr(node, f"out{n}"))
        return m


class Talker(wiring.Component):
    """A node that publishes on `data`, best effort, whenever it may."""

    def __init__(self, kind: str, **options: Any) -> None:
        self._node = RosNode("talker", topics=[Publish("data", kind, reliable=False)], **options)
        members = self._node.signature.members
        self._pins = [name for name in members if name != "data"]
        super().__init__({name: members[name] for name in self._pins})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.node = node = self._node
        expose(m, node, self, self._pins)
        m.d.comb += node.data.valid.eq(1)
        return m


def example(name: str) -> Any:
    """The design of an example."""
    return runpy.run_path(str(EXAMPLES / "gateware" / f"{name}.py"))["Design"]


# -- sizes


def designs() -> dict[str, Callable[[], tuple[lattice.Chip, Any]]]:
    """What `size` builds, by name: for which chip, and the top."""
    hz = round(CLOCK)

    def node(topics: int) -> tuple[lattice.Chip, Any]:
        return lattice.ECP5, Echoes(topics, endpoints=max(16, 4 * topics))

    return {
        "Ros2Ether": lambda: (
            lattice.ECP5,
            Pinned(Ros2Ether(Config(ros2clk_hz=hz)), (*SETTINGS, *ROS_SETTINGS)),
        ),
        **{f"RosNode {topics}+{topics}": functools.partial(node, topics) for topics in (1, 4, 16)},
        "serial-count": lambda: (lattice.ICE40, example("serial_count")(SERIAL_CLOCK)),
        "one publisher of UInt32, serial": lambda: (
            lattice.ICE40,
            Talker(
                "std_msgs/msg/UInt32",
                clk_hz=SERIAL_CLOCK,
                link=Serial(echo_data=None),
                fragments=1,
                participants=1,
                endpoints=2,
            ),
        ),
    }


def size(chosen: str) -> list[dict[str, Any]]:
    """The figures of each design with `chosen` in its name; one that does not fit says so."""
    rows: list[dict[str, Any]] = []
    for name, make in designs().items():
        if chosen not in name:
            continue
        print(f"placing and routing {name}", file=sys.stderr, flush=True)
        chip, top = make()
        goals = {clock: hz / 1e6 for clock, hz in CLOCKS.items() if clock in top.signature.members}
        goals["clk"] = chip.default_mhz
        with tempfile.TemporaryDirectory() as folder:
            try:
                found = lattice.build(chip, top, "design", pathlib.Path(folder), goals)
                rows.append({"design": name, **found})
            except RosletError as error:
                rows.append({"design": name, "device": chip.title, "failed": str(error).splitlines()[-1]})
    return rows


# -- times


class Timed(GatewareStation):
    """A design whose frames are noted: `taken`, with when the last nibble of each went into the pins, and `sent`. While
    `watched` has the name of a signal, `risen` gets the times at which it rises."""

    def __init__(self, model: Model, mii: Mii, *rest: Any) -> None:
        super().__init__(model, mii, *rest)
        self.taken: list[tuple[bytes, float]] = []
        self.sent: list[Sent] = []
        self.watched = ""
        self.risen: list[float] = []
        self._under_way: list[bytes] = []
        give, receive = mii.send, mii.receive

        def send(frame: bytes, *others: Any, **named: Any) -> None:
            self._under_way.append(bytes(frame))
            give(frame, *others, **named)

        def take() -> list[Sent]:
            found = receive()
            self.sent += found
            return found

        mii.send, mii.receive = send, take  # type: ignore[method-assign]

    def advance(self, now: float) -> None:
        until = round((now - self._start) / self.factor * PICOSECONDS)
        level = bool(self.watched) and self.model.get(self.watched)
        while self.model.picoseconds < until and (self.mii.waiting or self.watched):
            step = round(PICOSECONDS / (CLOCK if self.watched else PHY_CLOCK))
            self.model.run_until(min(until, self.model.picoseconds + step))
            while len(self._under_way) > self.mii.waiting:
                self.taken.append((self._under_way.pop(0), self.model.now))
            if self.watched:
                before, level = level, self.model.get(self.watched)
                if level and not before:
                    self.risen.append(self.model.now)
        super().advance(now)


class Bench:
    """A design with a software participant on its wire, which reads `reads`, a topic and its type, and writes `writes`.
    Raises RuntimeError where they do not find each other."""

    def __init__(
        self, top: Any, reads: tuple[str, str], writes: tuple[str, str] | None = None, asks: Qos = QOS
    ) -> None:
        self.model = Model(top)
        for name, hz in CLOCKS.items():
            self.model.clock(name, hz)
        self.model.set("rst_n", 0)
        self.model.run(1e-6)
        self.model.set("rst_n", 1)
        self.wire = Wire(FACTOR)
        gates = self.wire.gateware(self.model, Mii(self.model), kind=Timed)
        assert isinstance(gates, Timed)
        self.gates = gates
        station = ParticipantStation(self.wire.hub.port())
        self.wire.add(station)
        self.participant = station.participant
        self.samples: list[bytes] = []
        self._matches = 0
        self.participant.create_reader(dds_topic(TOPIC, reads[0]), dds_type(reads[1]), asks, 0.0)
        if writes is not None:
            names = dds_topic(TOPIC, writes[0]), dds_type(writes[1])
            self.writer: Any = self.participant.create_writer(*names, asks, 0.0)
        self.run_until(lambda: self._matches >= 1 + (writes is not None), "they find each other", 10.0)
        self.run(3.0)

    def _look(self) -> None:
        while (event := self.participant.next_event()) is not None:
            if isinstance(event, events.EndpointMatched):
                self._matches += 1
            elif isinstance(event, events.SampleReceived):
                self.samples.append(bytes(event.payload))

    def run(self, seconds: float) -> None:
        """Let time of the wire pass."""
        self.wire.run(seconds)
        self._look()

    def run_until(self, seen: Callable[[], bool], what: str, seconds: float = 2.0) -> None:
        """Until `seen` holds. Raises RuntimeError, with `what` in it, where that takes too long."""

        def look() -> bool:
            self._look()
            return seen()

        if not self.wire.run(seconds, look):
            raise RuntimeError(f"not within {seconds:g} s: {what}")

    def write(self, payload: bytes) -> Callable[[], float]:
        """Publish, and forget the frames so far. Returns what tells when the last nibble of the message was taken."""
        self.gates.taken.clear()
        self.gates.sent.clear()
        self.writer.write(payload, self.wire.now)
        return lambda: next(at for frame, at in self.gates.taken if payload[4:] in frame)

    def close(self) -> None:
        """Give back the model."""
        self.wire.close()
        self.model.close()


def spread(times: list[float]) -> dict[str, float]:
    """Of times in seconds: how they are distributed, in microseconds."""
    ordered = sorted(times)
    found = {
        "min": ordered[0],
        "median": statistics.median(ordered),
        "p99": ordered[int(0.99 * (len(ordered) - 1))],
        "max": ordered[-1],
        "spread": ordered[-1] - ordered[0],
    }
    return {"count": len(ordered), **{name: round(1e6 * value, 3) for name, value in found.items()}}


def echo(messages: int) -> dict[str, Any]:
    """Pin to pin, of an idle node. Raises RuntimeError where a message does not come back as it was."""
    bench = Bench(example("typed_echo")(round(CLOCK / FACTOR)), ("/pong", COORDINATE), ("/ping", COORDINATE))
    kind: Any = message_class("ros2", COORDINATE)
    dice = random.Random(1)
    times = []
    for number in range(1, messages + 1):
        bench.run(FACTOR * dice.uniform(1e-4, 3e-4))
        payload = kind(x=float(number), y=0.5, z=-float(number)).serialize()
        taken, before = bench.write(payload), len(bench.samples)
        bench.run_until(lambda before=before: len(bench.samples) > before, f"message {number} is back")  # type: ignore[misc]
        if bench.samples[-1] != payload:
            raise RuntimeError(f"message {number} came back as {bench.samples[-1].hex()}")
        reply = next(sent for sent in bench.gates.sent if payload[4:] in sent.frame)
        times.append(reply.start - taken())
    bench.close()
    return {
        "turnaround": spread(times),
        "the reply on the wire": round(1e6 * len(reply.symbols) / PHY_CLOCK, 3),
    }


def latency(messages: int) -> dict[str, Any]:
    """Of the manual's node."""
    hz = round(CLOCK / FACTOR)
    design = example("topic_pub_sub")(hz, rate=hz / 20_000)
    bench = Bench(design, ("/bbb", STRING), ("/aaa", STRING))
    kind: Any = message_class("ros2", STRING)
    received, published = [], []
    for number in range(messages):
        bench.gates.watched = "node ros2_sub_app_data_recv"
        taken = bench.write(kind(data=f"message {number:04}").serialize())
        bench.run_until(lambda: bool(bench.gates.risen), "a message is announced")
        received.append(bench.gates.risen.pop() - taken())
        bench.gates.watched = "node ros2_pub_app_data_rel"
        bench.run_until(lambda: bool(bench.gates.risen), "a message is given back")
        released = bench.gates.risen.pop()
        bench.gates.watched = ""
        bench.gates.sent.clear()
        bench.run_until(lambda: any(b"from FPGA" in sent.frame for sent in bench.gates.sent), "it is sent")
        sent = next(sent for sent in bench.gates.sent if b"from FPGA" in sent.frame)
        published.append(sent.start - released)
    bench.close()
    return {"publish": spread(published), "receive": spread(received)}


def publish(messages: int) -> dict[str, Any]:
    """As quickly as a node takes them. Raises RuntimeError where one is missing."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "bench_msgs" / "msg" / "Block.msg"
        path.parent.mkdir(parents=True)
        path.write_text(BLOCK_TEXT, encoding="utf-8")
        roslet.load(path.parents[1])
        top = Talker(BLOCK, clk_hz=CLOCK / FACTOR)
    bench = Bench(top, ("/data", BLOCK), asks=BEST_EFFORT)
    bench.gates.sent.clear()
    before = len(bench.samples)
    bench.run_until(lambda: len(bench.samples) >= before + messages, "they are published", 60.0)
    frames = [sent for sent in bench.gates.sent if len(sent.frame) > SIZE_ON_WIRE]
    bench.close()
    seconds = frames[-1].start - frames[0].start
    octets = sum(len(sent.symbols) / 2 + GAP for sent in frames[:-1])
    return {
        "messages a second": round((len(frames) - 1) / seconds),
        "of the wire": round(octets * 8 / (PHY_CLOCK * NIBBLE) / seconds, 4),
        "octets of a frame": len(frames[0].symbols) // 2,
    }


SIZE_ON_WIRE = 14 + 20 + 8 + 20 + 24 + 4 + 64
"""Octets of a frame with a message of 64 octets: Ethernet, IPv4, UDP, RTPS, DATA, encapsulation."""
PARTS = ("echo", "latency", "publish", "size")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", default=",".join(PARTS), help=", ".join(PARTS))
    parser.add_argument("--messages", type=int, default=1000)
    parser.add_argument("--designs", default="", metavar="TEXT")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    roslet.load(EXAMPLES / "msgs" / "mros_comm_measure")
    run: dict[str, Callable[[], Any]] = {
        "echo": lambda: echo(arguments.messages),
        "latency": lambda: latency(arguments.messages),
        "publish": lambda: publish(arguments.messages),
        "size": lambda: size(arguments.designs),
    }
    chosen = arguments.only.split(",")
    if unknown := set(chosen) - set(PARTS):
        parser.error(f"no such part: {', '.join(sorted(unknown))}")
    result = {part: run[part]() for part in PARTS if part in chosen}
    if arguments.json:
        print(json.dumps(result))
        return
    for part, found in result.items():
        print(part)
        for row in found if isinstance(found, list) else [found]:
            for name, value in row.items():
                print(f"  {name}: {value}")
            print()


if __name__ == "__main__":
    main()
