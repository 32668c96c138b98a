"""`roslet action`, on ROS 2."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.graph import only_type, open_ros2
from roslet.cli.options import (
    FAILED,
    OK,
    UNREACHABLE,
    CommandError,
    Group,
    below,
    full_name,
    load_types,
    positive,
)
from roslet.cli.output import emit_json, json_text, note, note_nothing, section, table

if TYPE_CHECKING:
    import argparse

    from roslet.cli.ros2.graph import Ros2Graph
    from roslet.node.ros2.actions import ClientGoal

# Seconds that a server has, after Ctrl-C, to end the goal.
CANCEL_TIMEOUT = 3.0


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)

    group.listing(run_list, "actions", "roslet action list\nroslet action list --names")

    info = group.command(
        "info",
        run_info,
        "show an action's type, servers and clients",
        "roslet action info /fibonacci",
        "network json",
    )
    info.add_argument("action", metavar="ACTION")

    send = group.command(
        "send_goal",
        run_send_goal,
        "send a goal, show feedback and the result",
        "roslet action send_goal /fibonacci order:=5\nroslet action send_goal /fibonacci '{order: 5}' --json",
        "network types json",
    )
    send.description = (
        "Send a goal, show feedback as it comes, and the result.\n\nCtrl-C cancels the goal. The exit code is 1 where the "
        "goal is not accepted or does not succeed."
    )
    send.add_argument("action", metavar="ACTION")
    send.add_argument(
        "values",
        nargs="*",
        metavar="VALUE",
        help="field.path:=value, a mapping, or the fields' values in order",
    )
    send.add_argument("--type", metavar="TYPE", help="package/action/Name; default: what the server has")
    send.add_argument("--no-feedback", action="store_true", help="show the result alone")
    send.add_argument(
        "--timeout",
        type=positive,
        metavar="SECONDS",
        help="give up (exit code 3) after so long; the goal is canceled",
    )


def _found(graph: Ros2Graph) -> dict[str, dict[str, Any]]:
    """Every action with its type, servers and clients."""
    from roslet.cli.ros2.graph import full_name as node_of
    from roslet.cli.ros2.nodes import action_type, actions_of
    from roslet.names import REPLY, REQUEST

    found: dict[str, dict[str, Any]] = {}
    for channel, part in ((REQUEST, "servers"), (REPLY, "clients")):
        for action, endpoints in actions_of(graph.of(channel, False)).items():
            row = found.setdefault(action, {"action": action, "type": "", "servers": [], "clients": []})
            types = {*filter(None, row["type"].split(", ")), *map(action_type, endpoints)}
            row["type"] = ", ".join(sorted(types))
            row[part] = sorted(node_of(one) for one in endpoints)
    return dict(sorted(found.items()))


def run_list(arguments: argparse.Namespace) -> int:
    """`roslet action list`."""
    namespace = below(arguments.namespace)
    with open_ros2(arguments.network, "action list") as graph:
        rows = [row for row in _found(graph).values() if row["action"].startswith(namespace)]
    if arguments.json:
        emit_json(rows)
        return OK
    if arguments.names:
        for row in rows:
            print(row["action"])
    else:
        table(
            ("ACTION", "TYPE", "SERVERS", "CLIENTS"),
            [(row["action"], row["type"], len(row["servers"]), len(row["clients"])) for row in rows],
        )
    if not rows:
        note_nothing("actions", namespace)
    return OK


def run_info(arguments: argparse.Namespace) -> int:
    """`roslet action info`."""
    name = full_name(arguments.action)
    with open_ros2(arguments.network, "action info") as graph:
        row = _found(graph).get(name)
    if row is None:
        raise CommandError(f"there is no action {name}")
    if arguments.json:
        emit_json(row)
        return OK
    print(f"Action: {name}")
    print(f"Type:   {row['type']}")
    for title, part in (("Servers", "servers"), ("Clients", "clients")):
        print()
        section(title, [(node,) for node in row[part]])
    return OK


def run_send_goal(arguments: argparse.Namespace) -> int:
    """`roslet action send_goal`."""
    from time import monotonic

    from roslet.cli.values import build
    from roslet.errors import CallTimeout, UnknownType
    from roslet.gen.runtime import action_class
    from roslet.io.interrupts import held
    from roslet.node.ros2.actions import GoalRejected

    load_types(arguments)
    name = full_name(arguments.action)
    end = None if arguments.timeout is None else monotonic() + arguments.timeout
    with open_ros2(arguments.network, "action send_goal") as graph:
        row = _found(graph).get(name)
        if row is None or not row["servers"]:
            raise CommandError(f"nobody serves an action {name}")
        try:
            kind = action_class("ros2", arguments.type or only_type(name, row["type"], "give --type"))
        except UnknownType as error:
            raise CommandError(f"{error}; load it with --types DIR") from None
        node = graph.node
        client = node.action_client(name, kind)
        goal = build(kind.Goal, arguments.values, node.now)
        feedback = None if arguments.no_feedback else lambda message: _show(arguments, "feedback", message)
        answer = None
        try:
            with held():
                answer = client.send_goal_async(goal, feedback)
            if not node.spin_until(answer.done, arguments.timeout):
                raise CommandError(f"{name}: no answer within {arguments.timeout:g} s", UNREACHABLE)
            left = None if end is None else max(0.001, end - monotonic())
            status, result = answer.result(0).result(left)
        except GoalRejected as error:
            raise CommandError(str(error)) from None
        except CallTimeout:
            assert answer is not None
            _cancel(arguments, answer.result(0))
            raise CommandError(
                f"{name}: no result within {arguments.timeout:g} s; the goal is canceled", UNREACHABLE
            ) from None
        except KeyboardInterrupt:
            if answer is None:
                raise  # nothing was sent
            if not node.spin_until(answer.done, CANCEL_TIMEOUT):
                note("the server does not say whether it has accepted the goal")
            elif answer.exception() is None:
                _cancel(arguments, answer.result(0))
            raise
        _show(arguments, "result", result, status)
    return OK if status == "SUCCEEDED" else FAILED


def _cancel(arguments: argparse.Namespace, goal: ClientGoal) -> None:
    """Ask that a goal be canceled, and show what it has come to where that is told soon."""
    from roslet.errors import CallTimeout

    try:
        if not goal.cancel(CANCEL_TIMEOUT):
            note("the server does not cancel the goal")
            return
        status, result = goal.result(CANCEL_TIMEOUT)
    except CallTimeout:
        note("the server does not say whether it has canceled the goal")
        return
    _show(arguments, "result", result, status)


def _show(arguments: argparse.Namespace, what: str, message: Any, status: str = "") -> None:
    from roslet.cli.render import plain, yaml_lines

    value: dict[str, Any] = {what: plain(message)}
    if status:
        value = {"status": status, **value}
    if arguments.json:
        print(json_text(value), flush=True)
    else:
        print("\n".join(yaml_lines(value)) + "\n---", flush=True)
