"""`roslet gateware sim`: a gateware example at the pins of a simulated PHY, among software hosts or on a TAP device; or on a
serial line."""

from __future__ import annotations

import itertools
import pathlib
import runpy
import subprocess
import time
from typing import TYPE_CHECKING, Any, ClassVar

from roslet.cli.demo.programs import folder
from roslet.cli.options import OK, CommandError, Group, positive
from roslet.cli.output import emit_json, json_text, note

if TYPE_CHECKING:
    import argparse

    from roslet.engine.net.endpoint import Endpoint
    from roslet.engine.net.host import Host
    from roslet.sim.model import Model
    from roslet.sim.wire import DesignStation, Wire

EXAMPLES = {
    name: f"{name.replace('-', '_')}.py"
    for name in ("imu-node", "serial-count", "topic-pub-sub", "typed-echo", "udp-tx-rx")
}
# The design's clock, in its own time: as slow as 100 Mbit/s allows without a pause.
CLOCK, PHY_CLOCK = 50e6, 25e6
# Seconds of the wire in a second of the design: so 200,000 cycles a second, which one processor simulates in real time.
FACTOR = 250.0
LINES = {False: "Ethernet", True: "a serial line"}
HOST, HOST_MAC, PREFIX = "192.168.1.10", "02:00:00:00:00:10", 24
# What the software host sends, in turn, and how often it does, and pings.
LENGTHS = (1, 5, 10, 15, 0)
EVERY = 0.5


def add(group: Group) -> None:
    """Declare the command."""
    sim = group.command(
        "sim",
        run,
        "simulate a gateware example at the pins of its PHY",
        "roslet gateware sim udp-tx-rx\n"
        "roslet gateware sim topic-pub-sub\n"
        "roslet gateware sim typed-echo --json\n"
        "roslet gateware sim udp-tx-rx --seconds 20 --pcap wire.pcap --loss 0.1\n"
        "roslet gateware sim udp-tx-rx --tap tap0   # as root; then: ping 192.168.1.100\n"
        "roslet gateware sim serial-count --pty --seconds 600",
        "json",
    )
    sim.description = (
        "Simulate a gateware example at the pins of its PHY.\n\nThe design is compiled, which takes a minute or two the "
        f"first time. On the wire with it is a software host, {HOST}, which pings it and sends it datagrams, or is a ROS 2 "
        "node and exchanges messages with it; or, with --tap, the Linux kernel, and whatever ROS 2 runs there. serial-count "
        "has a serial line instead, at whose other end the host is, or with --pty whoever opens the pseudo-terminal: the "
        "network to use is told."
    )
    sim.add_argument("example", choices=EXAMPLES, metavar="EXAMPLE", help=", ".join(EXAMPLES))
    sim.add_argument(
        "--seconds", type=positive, default=5.0, help="how long, in seconds of the wire (default 5)"
    )
    sim.add_argument(
        "--factor",
        type=positive,
        default=FACTOR,
        help=f"seconds of the wire in a second of the design, {CLOCK:.0e} of whose cycles they are (default {FACTOR:g})",
    )
    sim.add_argument(
        "--tap",
        metavar="NAME",
        help=f"make a TAP device with the address {HOST} in place of the software host",
    )
    sim.add_argument(
        "--pty",
        action="store_true",
        help="make a pseudo-terminal in place of the software host, for a serial line",
    )
    sim.add_argument("--pcap", metavar="FILE", help="write what passes the wire")
    sim.add_argument("--vcd", metavar="FILE", help="write a waveform of every signal: large")
    sim.add_argument("--loss", type=float, default=0.0, metavar="P", help="lose frames with this probability")
    sim.add_argument("--seed", type=int, default=0, help="of the losses (default 0)")


def run(arguments: argparse.Namespace) -> int:
    """`roslet gateware sim`."""
    try:
        from roslet.sim.model import Model

        design = runpy.run_path(str(folder() / "gateware" / EXAMPLES[arguments.example]))["Design"]
    except ModuleNotFoundError as error:
        raise CommandError(f"{error.name} is not installed: pip install 'roslet[gateware]'") from None
    kind = _session(arguments.example)
    without = ("tap", "pcap", "loss") if kind.SERIAL else ("pty",)
    for option in without:
        if getattr(arguments, option):
            raise CommandError(f"{arguments.example} has {LINES[kind.SERIAL]}: there is no --{option} for it")
    top = design(round(CLOCK / arguments.factor), counters=True, **kind.options(arguments.factor))
    if not arguments.json:
        note("compiling the design, unless that was done before")
    with Model(top) as model:
        session = kind(arguments, model, top.reasons)
        try:
            session.run(arguments.seconds)
        except KeyboardInterrupt:
            pass
        finally:
            session.close()
        session.report()
    return OK


def _session(example: str) -> type[Session]:
    if example == "udp-tx-rx":
        return Session
    from roslet.cli.gateware_ros import SESSIONS

    return SESSIONS[example]


def dropped(model: Model, reasons: dict[str, int]) -> dict[str, int]:
    """What a design with counters has dropped since its reset, by reason. Takes a few cycles of `clk` for each."""
    model.run_cycles("clk", len(reasons) + 2)  # a counter is looked after so often
    found = {}
    for reason, number in reasons.items():
        model.set("drop_reason", number)
        model.run_cycles("clk", 2)
        count = model.get("drop_count")
        if count:
            found[reason] = count
    return found


class Session:
    """A design on its wire, and what is told of it."""

    RATE: ClassVar[float | None] = None
    """Messages that the example publishes in a second of its own time, where that is more than the wire would carry in one
    of its seconds."""
    SERIAL: ClassVar[bool] = False
    """Whether a serial line is in place of Ethernet."""

    @classmethod
    def options(cls, factor: float) -> dict[str, float]:
        """What the design is made with, beside its clock."""
        return {} if cls.RATE is None else {"rate": cls.RATE / factor}

    def __init__(self, arguments: argparse.Namespace, model: Model, reasons: dict[str, int]) -> None:
        from roslet.sim.wire import Wire

        self._json = arguments.json
        self._outside = bool(arguments.tap or arguments.pty)
        self._reasons = reasons
        self._model = model
        self._host: Host | None = None
        self._endpoint: Endpoint | None = None
        self._lengths = itertools.cycle(LENGTHS)
        self._leds = 0
        self.counts = {"texts": 0, "pings answered": 0, "frames": 0}
        model.clock("clk", CLOCK)
        for name in () if self.SERIAL else ("phy_rx_clk", "phy_tx_clk"):
            model.clock(name, PHY_CLOCK)
        if arguments.vcd:
            model.vcd(arguments.vcd)
        model.set("rst_n", 0)
        model.run(1e-6)
        model.set("rst_n", 1)
        self.wire: Wire = Wire(arguments.factor, 1.0 if self._outside else None)
        self._gates = self._plug(arguments)
        self._capture = self.wire.capture(pathlib.Path(arguments.pcap)) if arguments.pcap else None
        if not self.SERIAL:
            self.wire.hub.listeners.append(self._count)
        if arguments.tap:
            self._plug_tap(arguments.tap)
        elif not self._outside:
            self._add_host()
        self._began = time.perf_counter()
        self._first = model.cycles("clk")

    def _count(self, frame: bytes, now: float) -> None:
        self.counts["frames"] += 1

    def _plug(self, arguments: argparse.Namespace) -> DesignStation:
        """Put the design on the wire."""
        from roslet.sim.link import Faults
        from roslet.sim.mii import Mii

        link = self.wire.hub.port()
        if arguments.loss:
            link = Faults(link, arguments.seed, loss=arguments.loss)
        return self.wire.gateware(self._model, Mii(self._model), link)

    def _plug_tap(self, name: str) -> None:
        from roslet.sim.tap import Tap

        self.wire.tap(Tap(name))
        for command in (
            ["ip", "address", "add", f"{HOST}/{PREFIX}", "dev", name],
            ["ip", "link", "set", name, "up"],
        ):
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            if done.returncode:
                raise CommandError(f"{' '.join(command)}: {done.stderr.strip()}")
        self._tell(f"{name} is up, with the address {HOST}", tap=name)

    def _add_host(self) -> None:
        from roslet.engine.net.host import Host

        self._host = Host(HOST_MAC, f"{HOST}/{PREFIX}")
        self.wire.host(self._host)
        self._endpoint = self._host.open(1234)

    def run(self, seconds: float) -> None:
        """Let the wire live."""
        end = self.wire.now + seconds
        due = self.wire.now + EVERY
        while self.wire.now < end:
            self.wire.run(max(1e-9, min(due, end) - self.wire.now), self._look)
            if self.wire.now >= due:
                due += EVERY
                self._ask()

    def _look(self) -> bool:
        """Tell what is new; never a reason to stop."""
        leds = self._model.get("led")
        if leds != self._leds:
            self._leds = leds
            shown = "  ".join(f"LD{4 + n} {'*' if leds >> n & 1 else '.'}" for n in range(4))
            self._tell(f"LEDs  {shown}", leds=leds)
        self._hear()
        return False

    def _hear(self) -> None:
        """Tell what the software has received."""
        if self._host is not None and self._endpoint is not None:
            while (got := self._endpoint.receive()) is not None:
                self.counts["texts"] += 1
                self._tell(f"{got[0]!r} from {got[1][0]}:{got[1][1]}", received=got[0].decode("latin-1"))
            while (event := self._host.next_event()) is not None:
                seconds = getattr(event, "seconds", None)
                if seconds is not None:
                    self.counts["pings answered"] += 1
                    own = seconds / self.wire.factor
                    self._tell(f"ping answered in {own * 1e6:.1f} us of the design's time", ping=own)

    def _ask(self) -> None:
        if self._host is None or self._endpoint is None:
            return
        self._host.ping("192.168.1.100", self.wire.now)
        length = next(self._lengths)
        self._endpoint.send(bytes(length), ("192.168.1.100", 1234), self.wire.now)
        self._tell(f"{length} octets sent to the design", sent=length)

    def _tell(self, text: str, **values: Any) -> None:
        if self._json:
            print(json_text({"time": round(self.wire.now, 6), **values}), flush=True)
        else:
            print(f"{self.wire.now:8.3f} s  {text}", flush=True)

    def close(self) -> None:
        """Give back the links and close the files."""
        self._cycles = self._model.cycles("clk") - self._first
        self._seconds = time.perf_counter() - self._began
        self.wire.close()
        if self._capture is not None:
            self._capture.close()

    def report(self) -> None:
        """What it came to."""
        found = {
            **self.counts,
            "faults": self._gates.faults,
            "dropped": dropped(self._model, self._reasons),
            "cycles": self._cycles,
            "cycles a second": round(self._cycles / self._seconds),
        }
        if self._json:
            emit_json(found, None)
            return
        for name, value in found.items():
            if isinstance(value, dict):
                value = ", ".join(f"{key} {count}" for key, count in value.items()) or "none"
            print(f"{name}: {value}")
