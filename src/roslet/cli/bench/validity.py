"""Whether every value arrives as it was written, from roslet to each peer and back.

roslet publishes a message; the peer says every value that it read, and publishes the message again; roslet reads that. What
the peer said is compared with what was written, and so is what came back: each way is judged by itself.
"""

from __future__ import annotations

import contextlib
import dataclasses
import json
import re
import signal
import struct
import time
from typing import TYPE_CHECKING, Any

import roslet
from roslet.cli.bench import compiled, stacks, values
from roslet.cli.demo.programs import folder
from roslet.cli.process import Failed, Process
from roslet.gen.runtime import message_class

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

START, ANSWER = 30.0, 10.0
# Between two tries to reach a peer that has not found us yet.
AGAIN = 0.25
QUICK = ("Int32", "Float64MultiArray", "String", "PointStamped", "Coordinate", "Image")
"""Types that --quick is content with."""
LEAF = re.compile(r"\s*[\w\[\]]+: (.*)")
ROSCPP = "roscpp"


class Mirror:
    """A peer in the role `mirror`: `heard` gives what it read of the next message."""

    def __init__(self, stack: stacks.Stack, network: stacks.Network, types: Sequence[str]) -> None:
        self.printed = stack.name == ROSCPP
        command = [*stack.echo, *types] if self.printed else stack.command("mirror", {"types": list(types)})
        stop = signal.SIGTERM if stack.foreign else None
        variables = stack.environment(network, BENCH_MIRROR=json.dumps(list(types)))
        self.process = Process(stack.name, command, variables, stop)
        self.lacking: set[int] = set()

    def ready(self) -> None:
        """Wait for it. Raises Failed."""
        while True:
            fact = self._fact(START)
            if "ready" in fact:
                return
            if "lacks" in fact:
                self.lacking.add(fact["type"])

    def heard(self, number: int, seconds: float) -> list[Any]:
        """The values of the next message of the type with this number. Raises Failed."""
        while True:
            fact = self._fact(seconds)
            if fact.get("type") == number:
                return [_value(one) for one in fact["values"]]

    def _fact(self, seconds: float) -> dict[str, Any]:
        if not self.printed:
            return self.process.fact(seconds)
        line = self.process.line(seconds)
        word, _, rest = line.partition(" ")
        if word == "lacks":
            return {"type": int(rest), "lacks": rest}
        if word != "type":
            return {word: True}
        found: list[str] = []
        while (line := self.process.line(seconds)) != "end":
            leaf = LEAF.match(line)
            if leaf is not None and leaf.group(1):
                found.append(leaf.group(1))
        return {"type": int(rest), "values": found}


def _value(told: Any) -> Any:
    """A value as a program told it: {"float": its eight octets} where its own texts of floats are not exact."""
    return struct.unpack(">d", bytes.fromhex(told["float"]))[0] if isinstance(told, dict) else told


def peers(found: Sequence[stacks.Stack], say: Callable[[str], None]) -> list[stacks.Stack]:
    """Those of the stacks that are peers, once each; roscpp with the program that it has for this. May compile."""
    chosen = []
    for stack in found:
        if stack.name == ROSCPP:
            stack = dataclasses.replace(stack, echo=(str(compiled.program("roscpp_mirror", say)),))
        chosen.append(stack)
    return [stack for stack in chosen if stack.dialect and not stack.foreign and "UDP" not in stack.name]


def measure(
    found: Sequence[stacks.Stack],
    network: stacks.Network,
    progress: Callable[[str, int, int], None],
    types: Sequence[str] = (),
) -> dict[str, Any]:
    """By peer and type how many messages were right, "3 of 3", and what was not. Of these types only, where any is named."""
    table: dict[str, dict[str, str]] = {}
    problems: list[str] = []
    for at, stack in enumerate(found):
        progress(stack.name, at, len(found))
        try:
            table[stack.name] = _peer(stack, network, problems, types)
        except Failed as error:
            problems.append(f"validity, {stack.name}: {error}")
    progress("", len(found), len(found))
    return {"peers": table, "problems": problems}


def _peer(
    stack: stacks.Stack, network: stacks.Network, problems: list[str], types: Sequence[str]
) -> dict[str, str]:
    ros1 = stack.dialect == "ros1"
    messages = {
        name: wanted
        for name, wanted in values.messages(ros1).items()
        if not types or name.split("/")[1] in types
    }
    roslet.load(folder() / "msgs" / "mros_comm_measure")
    url = network.ros1 if ros1 else network.ros2
    mirror = Mirror(stack, network, list(messages))
    rows: dict[str, str] = {}
    with mirror.process, roslet.Node("bench_validity", network=url) as node:
        mirror.ready()
        for number, (type_name, wanted) in enumerate(messages.items()):
            if number in mirror.lacking:
                continue
            right = 0
            ends = _Ends(node, stack.dialect, type_name, number)
            for index, value in enumerate(wanted):
                try:
                    wrong = _exchange(ends, mirror, number, value, first=index == 0)
                except Failed as error:
                    wrong = str(error)
                right += not wrong
                if wrong:
                    problems.append(f"validity, {stack.name}, {type_name}, message {index + 1}: {wrong}")
            rows[type_name] = f"{right} of {len(wanted)}"
    return rows


class _Ends:
    """Our publisher and subscription of one type."""

    def __init__(self, node: roslet.Node, dialect: Any, type_name: str, number: int) -> None:
        self.node = node
        self.kind: Any = message_class(dialect, type_name)
        self.make = lambda name: message_class(dialect, name)()
        self.back: list[list[Any]] = []
        self.publisher = node.publisher(f"there_{number}", self.kind)
        node.subscribe(f"back_{number}", self.kind, lambda message: self.back.append(values.read(message)))


def _exchange(ends: _Ends, mirror: Mirror, number: int, value: list[Any], first: bool) -> str:
    """What was wrong with one message; "" where nothing was. The first one is sent until it comes back, as either end may
    find the other later. Raises Failed."""
    ends.back.clear()
    message = values.fill(ends.kind(), value, ends.make)
    end = time.monotonic() + ANSWER
    sent = 0
    while not ends.back and time.monotonic() < end:
        ends.publisher.publish(message)
        sent += 1
        ends.node.spin_until(lambda: ends.back, AGAIN if first else ANSWER)
    if not ends.back:
        return "nothing comes back"
    if sent > 1:  # what was sent in vain, or comes twice
        ends.node.spin_until(lambda: len(ends.back) >= sent, AGAIN)
    heard = [mirror.heard(number, ANSWER) for _ in range(len(ends.back))]
    with contextlib.suppress(Failed):  # what it heard before it had found us
        while len(heard) < sent:
            heard.append(mirror.heard(number, AGAIN))
    expected = values.printed(value) if mirror.printed else values.flat(value)
    if not all(values.same(expected, one) for one in heard):
        return f"the peer read {_short(heard[0])}, not {_short(expected)}"
    if not all(values.same(values.flat(value), one) for one in ends.back):
        return f"what came back is {_short(ends.back[0])}"
    return ""


def _short(found: list[Any]) -> str:
    text = str(found[:8])[1:-1]
    return text[:80] + (" ..." if len(found) > 8 or len(text) > 80 else "")
