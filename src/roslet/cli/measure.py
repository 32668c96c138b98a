"""`roslet topic hz`, `bw` and `delay`: what arrives, when, how much, and how old."""

from __future__ import annotations

import math
import time
from collections import deque
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from roslet.cli.options import CommandError, full_name, load_types
from roslet.cli.output import Live, bytes_text, json_text, seconds_text
from roslet.cli.session import open_session

if TYPE_CHECKING:
    import argparse


class Meter:
    """The arrivals of one topic: the last `window` of them, and since the last report."""

    def __init__(self, topic: str, window: int) -> None:
        self.topic = topic
        self.messages = 0
        self.recent = 0
        self.arrivals: deque[tuple[float, int]] = deque(maxlen=window + 1)
        self.delays: deque[float] = deque(maxlen=window)

    def arrived(self, size: int, now: float) -> None:
        """A message of `size` bytes has come at `now` seconds."""
        self.messages += 1
        self.recent += 1
        self.arrivals.append((now, size))

    def figures(self, what: str, now: float) -> dict[str, Any]:
        """What one report of that command says."""
        if what == "bw":
            return self.bandwidth(now)
        return self.rate() if what == "hz" else self.delay()

    def delayed(self, seconds: float) -> None:
        """A message has come that was stamped so long ago."""
        self.messages += 1
        self.recent += 1
        self.delays.append(seconds)

    def delay(self) -> dict[str, Any]:
        """Seconds between stamp and arrival, over the window; no such keys without a message."""
        figures: dict[str, Any] = {"topic": self.topic, "messages": self.messages}
        if self.delays:
            mean = sum(self.delays) / len(self.delays)
            figures.update(
                mean=mean,
                minimum=min(self.delays),
                maximum=max(self.delays),
                deviation=math.sqrt(sum((one - mean) ** 2 for one in self.delays) / len(self.delays)),
                window=len(self.delays),
            )
        return figures

    def rate(self) -> dict[str, Any]:
        """Rate in Hz and the intervals in seconds, over the window; no such keys with fewer than two messages."""
        figures: dict[str, Any] = {"topic": self.topic, "messages": self.messages}
        times = [when for when, _ in self.arrivals]
        intervals = [later - sooner for sooner, later in pairwise(times)]
        span = sum(intervals)
        if span > 0:
            mean = span / len(intervals)
            figures.update(
                rate=1 / mean,
                minimum=min(intervals),
                maximum=max(intervals),
                deviation=math.sqrt(sum((interval - mean) ** 2 for interval in intervals) / len(intervals)),
                window=len(intervals),
            )
        return figures

    def bandwidth(self, now: float) -> dict[str, Any]:
        """Bytes per second and the sizes in bytes, over the window; no such keys with fewer than two messages."""
        figures: dict[str, Any] = {"topic": self.topic, "messages": self.messages}
        sizes = [size for _, size in self.arrivals]
        span = now - self.arrivals[0][0] if self.arrivals else 0.0
        if len(sizes) > 1 and span > 0:
            # The first message begins the span and does not belong to it.
            figures.update(
                bytes_per_second=sum(sizes[1:]) / span,
                mean=sum(sizes) / len(sizes),
                minimum=min(sizes),
                maximum=max(sizes),
                window=len(sizes) - 1,
            )
        return figures


def rate_line(figures: dict[str, Any], silent: bool, width: int) -> str:
    """One report of `hz`."""
    head = figures["topic"].ljust(width)
    if "rate" not in figures:
        return f"{head}  {'no message' if not figures['messages'] else '1 message'} yet"
    return (
        f"{head}  {figures['rate']:9.2f} Hz  min {seconds_text(figures['minimum'])}"
        f"  max {seconds_text(figures['maximum'])}  std {seconds_text(figures['deviation'])}"
        f"  window {figures['window']}{'  (no new message)' if silent else ''}"
    )


def bandwidth_line(figures: dict[str, Any], silent: bool, width: int) -> str:
    """One report of `bw`."""
    head = figures["topic"].ljust(width)
    if "mean" not in figures:
        return f"{head}  {'no message' if not figures['messages'] else '1 message'} yet"
    return (
        f"{head}  {bytes_text(figures['bytes_per_second']):>10}/s  mean {bytes_text(figures['mean'])}"
        f"  min {bytes_text(figures['minimum'])}  max {bytes_text(figures['maximum'])}"
        f"  window {figures['window']}{'  (no new message)' if silent else ''}"
    )


def delay_line(figures: dict[str, Any], silent: bool, width: int) -> str:
    """One report of `delay`."""
    head = figures["topic"].ljust(width)
    if "mean" not in figures:
        return f"{head}  no message yet"
    return (
        f"{head}  mean {seconds_text(figures['mean'])}  min {seconds_text(figures['minimum'])}"
        f"  max {seconds_text(figures['maximum'])}  std {seconds_text(figures['deviation'])}"
        f"  window {figures['window']}{'  (no new message)' if silent else ''}"
    )


_LINES = {"hz": rate_line, "bw": bandwidth_line, "delay": delay_line}


def stamp_of(message: Any) -> float:
    """Seconds of the stamp in a message's header. Raises CommandError where it has none."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    for seconds, nanoseconds in (("secs", "nsecs"), ("sec", "nanosec")):
        if hasattr(stamp, nanoseconds):
            return float(getattr(stamp, seconds) + getattr(stamp, nanoseconds) * 1e-9)
    raise CommandError(f"{message._type} has no header with a stamp")


def measure(arguments: argparse.Namespace, what: str) -> int:
    """Report every second until time is up or Ctrl-C. The exit code is 1 where a topic had no message at all."""
    load_types(arguments)
    meters = [Meter(full_name(topic), arguments.window) for topic in arguments.topics]
    width = max(len(meter.topic) for meter in meters)
    live = Live()
    with open_session(arguments, what) as session:
        node, reader = session.node, session.reader()
        for meter in meters:

            def arrived(raw: Any, meter: Meter = meter) -> None:
                meter.arrived(len(raw.data), time.monotonic())

            def arrived_with_stamp(raw: Any, meter: Meter = meter) -> None:
                now = node.now().to_sec()
                meter.delayed(now - stamp_of(reader.read(raw)))

            session.listen(
                meter.topic, arrived_with_stamp if what == "delay" else arrived, 1000, arguments.qos, False
            )
        begin = time.monotonic()
        end = math.inf if arguments.limit is None else begin + arguments.limit
        while time.monotonic() < end and not node.is_shutdown:
            node.spin(min(arguments.every, max(0.001, end - time.monotonic())))
            now = time.monotonic()
            lines = []
            for meter in meters:
                figures = meter.figures(what, now)
                if arguments.json:
                    print(json_text({"time": round(now - begin, 3), **figures}), flush=True)
                else:
                    lines.append(_LINES[what](figures, not meter.recent, width))
                meter.recent = 0
            if lines:
                live.show("\n".join(lines))
    return 0 if all(meter.messages for meter in meters) else 1
