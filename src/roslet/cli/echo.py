"""`roslet topic echo`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from roslet.cli.options import CommandError, full_name, load_types
from roslet.cli.output import Live, json_text
from roslet.cli.render import Style, plain, select, steps, yaml_lines
from roslet.cli.session import open_session
from roslet.errors import MalformedMessage

if TYPE_CHECKING:
    import argparse

# Messages that may wait while one is printed.
DEPTH = 10


def echo(arguments: argparse.Namespace) -> int:
    """Print messages until there were enough of them, time is up, or Ctrl-C."""
    load_types(arguments)
    topic = full_name(arguments.topic)
    if arguments.field:
        steps(arguments.field)  # a wrong path is reported before the first message
    style = Style(arguments.noarr, arguments.nostr, arguments.truncate)
    live = Live() if arguments.clear else None
    shown = 0
    left = arguments.count
    done = False
    latest = begin = time.monotonic()

    def show(raw: Any) -> None:
        nonlocal shown, done, latest
        if done:
            return
        latest = time.monotonic()
        try:
            message = reader.read(raw)
        except MalformedMessage as error:
            raise CommandError(f"{topic}: a message that is no {raw.type}: {error}") from None
        value = select(message, arguments.field, style) if arguments.field else plain(message, style)
        if arguments.json:
            print(json_text(value), flush=True)
        else:
            text = "\n".join(yaml_lines(value))
            if live is not None and live.in_place:
                live.show(text)
            else:
                print(f"{text}\n---", flush=True)
        shown += 1
        done = left is not None and shown >= left

    def over() -> bool:
        now = time.monotonic()
        return (
            done
            or (arguments.limit is not None and now - begin >= arguments.limit)
            or (arguments.timeout is not None and now - latest >= arguments.timeout)
        )

    with open_session(arguments, "echo") as session:
        node, reader = session.node, session.reader()
        latest = begin = time.monotonic()
        tap = session.listen(topic, show, DEPTH, arguments.qos)
        # The loop looks at the clock at least this often, so that a limit ends a silent topic too.
        while not over() and not node.is_shutdown:
            node.spin_until(over, _soonest(arguments, begin, latest))
        publishers = tap.publisher_count
    if not done and arguments.timeout is not None and time.monotonic() - latest >= arguments.timeout:
        who = f"{publishers} publishers" if publishers != 1 else "1 publisher"
        raise CommandError(f"{topic}: no message within {arguments.timeout:g} s ({who})")
    return 0


def _soonest(arguments: argparse.Namespace, begin: float, latest: float) -> float | None:
    """Seconds until one of the limits may be over; None where there is none."""
    now = time.monotonic()
    ends = []
    if arguments.limit is not None:
        ends.append(begin + arguments.limit - now)
    if arguments.timeout is not None:
        ends.append(latest + arguments.timeout - now)
    return max(0.001, min(ends)) if ends else None
