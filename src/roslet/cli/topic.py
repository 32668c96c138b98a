"""`roslet topic`: the declarations, and the questions that need no node. `echo`, `pub`, `hz` and `bw` have modules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.options import ALL, CommandError, Group, below, count, full_name, positive

if TYPE_CHECKING:
    import argparse

    from roslet.cli.graph import Graph

_FOR = "stop after so many seconds"


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)

    list_ = group.listing(run_list, "topics", "roslet topic list\nroslet topic list --names | grep camera")
    list_.add_argument("-a", "--all", action="store_true", help=ALL)

    info = group.command(
        "info",
        run_info,
        "show a topic's type, publishers and subscribers",
        "roslet topic info /chatter",
        "network json",
    )
    info.add_argument("topic", metavar="TOPIC")
    info.add_argument(
        "-v", "--verbose", action="store_true", help="on ROS 2 also type hashes, ids and every policy"
    )

    type_ = group.command(
        "type",
        run_type,
        "print a topic's type",
        "roslet topic type /chatter\nroslet interface show $(roslet topic type /chatter)",
        "network json",
    )
    type_.add_argument("topic", metavar="TOPIC")

    find = group.command(
        "find",
        run_find,
        "list the topics of a type",
        "roslet topic find sensor_msgs/msg/Image\nroslet topic find std_msgs/String",
        "network json",
    )
    find.add_argument("type", metavar="TYPE", help="package/Name or package/msg/Name, on either network")
    find.add_argument("-a", "--all", action="store_true", help=ALL)

    _add_echo(group)
    _add_pub(group)

    for name, function, summary in (
        ("hz", run_hz, "measure the rate at which messages arrive"),
        ("bw", run_bw, "measure the bytes per second of a topic"),
        ("delay", run_delay, "measure how old messages are when they arrive, by the stamp in their header"),
    ):
        live = group.command(
            name,
            function,
            summary,
            f"roslet topic {name} /chatter\nroslet topic {name} /scan /image --for 10\n"
            f"roslet topic {name} /scan --json --for 5",
            "network types json",
        )
        add_qos(live)
        live.add_argument("topics", nargs="+", metavar="TOPIC")
        live.add_argument(
            "-w",
            "--window",
            type=count,
            default=1000,
            metavar="N",
            help="over the last N messages (default 1000)",
        )
        live.add_argument(
            "--every", type=positive, default=1.0, metavar="SECONDS", help="between two reports (default 1)"
        )
        live.add_argument("--for", dest="limit", type=positive, metavar="SECONDS", help=_FOR)


def add_qos(parser: argparse.ArgumentParser) -> None:
    """Declare --qos."""
    parser.add_argument(
        "--qos",
        metavar="POLICY=VALUE",
        action="append",
        default=[],
        help="of this end: depth=5, reliability=best_effort, durability=transient_local, deadline=0.5, ...; default: a "
        "subscription on ROS 2 suits the topic's publishers",
    )


def _add_echo(group: Group) -> None:
    echo = group.command(
        "echo",
        run_echo,
        "print a topic's messages",
        "roslet topic echo /chatter\nroslet topic echo /odom --field pose.pose.position -n 5\n"
        "roslet topic echo /scan --noarr\nroslet topic echo /imu --json | jq .orientation.w",
        "network types json",
    )
    echo.description = (
        "Print a topic's messages as YAML, one document each.\n\nTypes that are not installed here are shown by "
        "the definition that their publisher sends;\non ROS 2, by the description that its node gives."
    )
    add_qos(echo)
    echo.add_argument("topic", metavar="TOPIC")
    echo.add_argument("-n", "--count", type=count, metavar="COUNT", help="stop after COUNT messages")
    echo.add_argument("-1", "--once", action="store_const", const=1, dest="count", help="stop after one")
    echo.add_argument("--field", metavar="PATH", help="only this: pose.position.x, ranges[3], points[0:2].x")
    echo.add_argument("--noarr", action="store_true", help="do not show arrays, only how long they are")
    echo.add_argument("--nostr", action="store_true", help="do not show strings, only how long they are")
    echo.add_argument("--truncate", type=count, metavar="N", help="show N elements of an array at most")
    echo.add_argument(
        "-c", "--clear", action="store_true", help="show only the latest message, in place (on a terminal)"
    )
    echo.add_argument("--for", dest="limit", type=positive, metavar="SECONDS", help=_FOR)
    echo.add_argument(
        "--timeout",
        type=positive,
        metavar="SECONDS",
        help="fail (exit code 1) where no message comes for so long",
    )


def _add_pub(group: Group) -> None:
    pub = group.command(
        "pub",
        run_pub,
        "publish messages",
        "roslet topic pub /chatter std_msgs/String data:=hello\n"
        "roslet topic pub -r 10 /cmd_vel geometry_msgs/Twist linear.x:=0.5 angular.z:=-0.1\n"
        "roslet topic pub -1 /goal geometry_msgs/PoseStamped '{header: auto, pose: {position: {x: 1}}}'\n"
        "roslet topic pub -1 /point geometry_msgs/Point 1 2 -- -3",
        "network types",
    )
    pub.description = (
        "Publish messages.\n\nWithout -1 or -r the message is published once, latched, until Ctrl-C. A value is "
        "YAML\n(JSON or a scalar where PyYAML is not installed); `now` is the present time, `auto` a\n"
        "header with the present time. Fields that are not given keep their defaults."
    )
    add_qos(pub)
    pub.add_argument("topic", metavar="TOPIC")
    pub.add_argument(
        "type", metavar="TYPE", help="package/Name or package/msg/Name, or - for the type that the topic has"
    )
    pub.add_argument(
        "values",
        nargs="*",
        metavar="VALUE",
        help="field.path:=value, a mapping, or the fields' values in order",
    )
    pub.add_argument("-r", "--rate", type=positive, metavar="HZ", help="publish again at this rate")
    pub.add_argument(
        "-1",
        "--once",
        action="store_true",
        help="publish once, when the subscribers that there are have connected, and end",
    )
    pub.add_argument("-n", "--count", type=count, metavar="COUNT", help="with -r: stop after COUNT messages")
    pub.add_argument("--latch", action="store_true", help="late subscribers get the last message")
    pub.add_argument(
        "--wait",
        type=float,
        default=3.0,
        metavar="SECONDS",
        help="with -1: how long to wait for a subscriber at most (default 3)",
    )
    pub.add_argument("--for", dest="limit", type=positive, metavar="SECONDS", help=_FOR)


def run_list(arguments: argparse.Namespace) -> int:
    """`roslet topic list`."""
    from roslet.cli.graph import open_graph
    from roslet.cli.output import emit_json, note_nothing, table

    namespace = below(arguments.namespace)
    with open_graph(arguments.network) as graph:
        topics = [
            topic
            for topic in graph.topics()
            if topic.startswith(namespace) and (arguments.all or not graph.hidden(topic))
        ]
        if arguments.names:
            for topic in topics:
                print(topic)
        else:
            rows = describe(graph, topics)
            if arguments.json:
                emit_json(rows)
            else:
                table(
                    ("TOPIC", "TYPE", "PUBLISHERS", "SUBSCRIBERS"),
                    [
                        (row["topic"], row["type"], len(row["publishers"]), len(row["subscribers"]))
                        for row in rows
                    ],
                )
    if not topics and not arguments.json:
        note_nothing("topics", namespace)
    return 0


def describe(graph: Graph, topics: list[str]) -> list[dict[str, Any]]:
    """Topics as JSON data."""
    types, publishers, subscribers = graph.types, graph.publishers, graph.subscribers
    return [
        {
            "topic": topic,
            "type": types.get(topic, "*"),
            "publishers": publishers.get(topic, []),
            "subscribers": subscribers.get(topic, []),
        }
        for topic in topics
    ]


def _known(graph: Graph, name: str) -> str:
    topic = full_name(name)
    if topic not in graph.publishers and topic not in graph.subscribers:
        raise CommandError(f"nobody publishes or subscribes {topic}")
    return topic


def run_info(arguments: argparse.Namespace) -> int:
    """`roslet topic info`."""
    from roslet.cli.graph import open_graph
    from roslet.cli.output import emit_json, section

    with open_graph(arguments.network) as graph:
        topic = _known(graph, arguments.topic)
        described: dict[str, Any] = {
            "topic": topic,
            "type": graph.types.get(topic, "*"),
            **graph.endpoints_info(topic),
        }
    if arguments.json:
        emit_json(described)
        return 0
    print(f"Topic: {topic}")
    print(f"Type:  {described['type']}")
    for title, part in (("Publishers", "publishers"), ("Subscribers", "subscribers")):
        print()
        section(title, graph.endpoint_rows(described[part], arguments.verbose))
    return 0


def topic_type(graph: Graph, topic: str) -> str:
    """The type of a topic. Raises CommandError where nobody knows it."""
    kind = graph.types.get(topic, "*")
    if kind == "*":
        raise CommandError(f"the type of {topic} is not known: nobody publishes it")
    return kind


def run_type(arguments: argparse.Namespace) -> int:
    """`roslet topic type`."""
    from roslet.cli.graph import open_graph
    from roslet.cli.output import emit_json

    with open_graph(arguments.network) as graph:
        topic = _known(graph, arguments.topic)
        kind = topic_type(graph, topic)
    if arguments.json:
        emit_json({"topic": topic, "type": kind})
    else:
        print(kind)
    return 0


def run_find(arguments: argparse.Namespace) -> int:
    """`roslet topic find`."""
    from roslet.cli.graph import open_graph
    from roslet.cli.output import emit_json, note

    wanted = _bare(arguments.type)
    with open_graph(arguments.network) as graph:
        types = graph.types
        found = [
            topic
            for topic in graph.topics()
            if wanted in [_bare(kind) for kind in types.get(topic, "*").split(", ")]
            and (arguments.all or not graph.hidden(topic))
        ]
    if arguments.json:
        emit_json(found)
    else:
        for topic in found:
            print(topic)
        if not found:
            note(f"no topics of {arguments.type}")
    return 0


def _bare(kind: str) -> str:
    """A message type without what ROS 2 puts in its middle."""
    return kind.replace("/msg/", "/", 1)


def run_echo(arguments: argparse.Namespace) -> int:
    """`roslet topic echo`."""
    from roslet.cli.echo import echo

    return echo(arguments)


def run_pub(arguments: argparse.Namespace) -> int:
    """`roslet topic pub`."""
    from roslet.cli.pub import publish

    return publish(arguments)


def run_hz(arguments: argparse.Namespace) -> int:
    """`roslet topic hz`."""
    from roslet.cli.measure import measure

    return measure(arguments, "hz")


def run_bw(arguments: argparse.Namespace) -> int:
    """`roslet topic bw`."""
    from roslet.cli.measure import measure

    return measure(arguments, "bw")


def run_delay(arguments: argparse.Namespace) -> int:
    """`roslet topic delay`."""
    from roslet.cli.measure import measure

    return measure(arguments, "delay")
