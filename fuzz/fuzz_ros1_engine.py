"""Invariant: whatever bytes come on whichever connection of a ROS 1 engine, nothing is raised, what it holds stays bounded,
every refusal is counted under an explained reason, and afterwards a well-behaved subscriber gets its message.

    python fuzz/fuzz_ros1_engine.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_ros1_engine.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import sys
from struct import pack
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.engine.ros1.engine import Engine
from roslet.engine.ros1.graph import MAX_PUBLISHERS
from roslet.engine.ros1.links import IncomingLink, PublisherLink
from roslet.engine.ros1.reasons import REASONS
from roslet.engine.ros1.rpc import RpcServer
from roslet.errors import ServiceFailed
from roslet.wire import http, xmlrpc
from roslet.wire.tcpros import emit_header, parse_header

SUBSCRIBER = {"callerid": "/s", "md5sum": "m", "topic": "/t", "type": "t/T"}
CLIENT = {"callerid": "/c", "md5sum": "s", "service": "/work", "persistent": "1"}
PUBLISHER = {"callerid": "/p", "md5sum": "m", "type": "t/T"}
KINDS = 8


class World:
    """An engine with a publication, a subscription with a publisher, a service, a client of one, and a master."""

    def __init__(self) -> None:
        self.now = 100.0
        self.engine = engine = Engine("/n", "http://master:1", "host", 1)
        engine.listening(5000, 5001)
        self.publication = engine.advertise("/t", "t/T", "m", "text", False, 3, self.now)
        self.subscription = engine.subscribe("/u", "t/T", "m", "text", self._sink, self.now, max_frame=1000)
        engine.offer_service("/work", "t/S", "s", ("t/A", "t/B"), self._serve, self.now)
        self.subscription.update(["http://peer:1/"], self.now)
        self.subscription._answered("http://peer:1/", ["TCPROS", "peer", 2], None, self.now)
        self.link: Any = self.subscription.links["http://peer:1/"]
        self.link.connected(self.now)
        self.call = engine.service_link("rosrpc://peer:3", dict(CLIENT), self.now)
        self.call.call(b"question", lambda body, error: None)
        self.call.connected(self.now)
        self.master = engine._master
        self.master.connected(self.now)

    @staticmethod
    def _sink(view: memoryview, start: int, end: int, link: object) -> None:
        if end - start > 1000:
            raise AssertionError("a frame beyond the bound")

    @staticmethod
    def _serve(view: memoryview, start: int, end: int, link: object) -> bytes:
        if view[start:end] == b"bad":
            raise ServiceFailed("bad")
        return bytes(view[start:end])

    def connection(self, kind: int) -> Any:
        """The machine whose peer is the fuzzer."""
        if kind == 0:
            return self.engine.accept_rpc(self.now)
        if kind in (1, 2, 3):
            link = self.engine.accept_tcpros(self.now)
            if kind == 1:
                return link
            return self.feed(link, emit_header(SUBSCRIBER if kind == 2 else CLIENT))
        if kind == 4:
            return self.feed(self.link, emit_header(PUBLISHER))
        return (self.link, self.call, self.master)[kind - 5]

    def feed(self, machine: Any, data: bytes) -> Any:
        """What a shell does with input; the machine that has the connection then."""
        if hasattr(machine, "writable"):
            at = 0
            while at < len(data) and not machine.closing:
                room = machine.writable()
                if not room:
                    raise AssertionError("no room for the next byte")
                count = min(len(room), len(data) - at)
                room[:count] = data[at : at + count]
                at += count
                machine.received(count, self.now)
                if getattr(machine, "paused", False):
                    machine.data_to_send()
                    machine.go_on(self.now)
                successor = machine.successor if isinstance(machine, IncomingLink) else None
                if successor is not None:
                    successor.take_over(machine.data_to_send(), machine.take_rest())
                    machine = successor
                    if isinstance(machine, PublisherLink):
                        machine.publication.opened(machine)
                        machine.take_rest()
                    else:
                        machine.receive_data(machine.take_rest(), self.now)
                elif machine.user and not machine.closing:
                    machine.receive_data(machine.take_rest(), self.now)
        else:
            machine.receive_data(data, self.now)
            if isinstance(machine, RpcServer):
                self.engine.rpc_pump(machine, self.now, "10.0.0.1")
        self.engine.pump(self.now)
        self.engine.take_connections()
        self.engine.take_touched()
        return machine


def check(data: bytes) -> None:
    """Raises if the invariant does not hold; the first byte chooses the connection, the second the cuts."""
    if len(data) < 2:
        return
    world = World()
    engine = world.engine
    machine = world.connection(data[0] % KINDS)
    rest = data[2:]
    source = random.Random(data[1])
    while rest:
        length = len(rest) if not data[1] else source.randrange(1, 80)
        machine = world.feed(machine, rest[:length])
        rest = rest[length:]
        world.now += 0.01
    for seconds in (1.0, 20.0, 400.0):
        world.now += seconds
        for due in (engine, machine, world.link, world.call, world.master):
            due.handle_deadline(world.now)
        engine.pump(world.now)
    lost = getattr(machine, "lost", None) or getattr(machine, "connection_lost", None)
    if lost is not None:
        lost("the end", world.now)
    if engine.shutdown_reason is None:
        verify(world)


def verify(world: World) -> None:
    """The engine is as well as before."""
    engine = world.engine
    unknown = set(engine.counters) - set(REASONS) - RPC_REASONS
    if unknown:
        raise AssertionError(f"unexplained reasons {unknown}")
    if len(world.subscription.publishers) > MAX_PUBLISHERS:
        raise AssertionError(f"{len(world.subscription.publishers)} publishers")
    link = engine.accept_tcpros(world.now)
    opened = world.feed(link, emit_header(SUBSCRIBER))
    if not isinstance(opened, PublisherLink) or opened not in world.publication.links:
        raise AssertionError("a good subscriber was not taken")
    answer = opened.data_to_send()
    if parse_header(answer[4:])["md5sum"] != "m":
        raise AssertionError(f"a good subscriber was answered {answer!r}")
    opened.queue.push(pack("<I", 2) + b"hi")
    if b"".join(map(bytes, opened.queue.peek())) != b"\x02\0\0\0hi":
        raise AssertionError("a message does not go out")
    server = engine.accept_rpc(world.now)
    world.feed(server, http.emit_request("h:1", "/", xmlrpc.emit_call("getPid", ["/x"])))
    if b"<value><array>" not in server.data_to_send():
        raise AssertionError("the slave API does not answer")


# What wire.http, wire.xmlrpc and engine.ros1.rpc name.
RPC_REASONS = {
    "header-too-large",
    "body-too-large",
    "bad-start-line",
    "bad-header",
    "bad-content-length",
    "bad-chunk",
    "unsupported-encoding",
    "unsupported-version",
    "truncated",
    "too-large",
    "too-many-tags",
    "too-deep",
    "bad-encoding",
    "control-character",
    "forbidden-markup",
    "bad-entity",
    "unexpected-tag",
    "unexpected-text",
    "bad-int",
    "bad-boolean",
    "bad-double",
    "bad-base64",
    "bad-document",
    "slow-request",
    "too-many-requests",
    "not-post",
}

URIS = ["http://h:1/", "http://h:2/", "", "x", 5]
CALLS: list[tuple[str, list[Any]]] = [
    ("publisherUpdate", ["/m", "/u", URIS]),
    ("publisherUpdate", ["/m", "/t", []]),
    ("paramUpdate", ["/m", "/p", {"a": [1]}]),
    ("requestTopic", ["/x", "/t", [["UDPROS", b"\x02\0\0\0a=", "h", 5, 1500], ["TCPROS"]]]),
    ("requestTopic", ["/x", "/t", [["TCPROS"]]]),
    ("getBusInfo", ["/x"]),
    ("getBusStats", ["/x"]),
    ("getSubscriptions", [[]]),
    ("shutdown", ["/x", "why"]),
    ("system.multicall", [[{"methodName": "getPid", "params": ["/x"]}]]),
]


def smoke(count: int) -> None:
    """`count` random inputs, always the same."""
    source = random.Random(0)
    bodies = [http.emit_request("h:1", "/", xmlrpc.emit_call(method, params)) for method, params in CALLS]
    answers = [
        http.emit_response(xmlrpc.emit_response(value), True)
        for value in ([1, "", []], [1, "", ["TCPROS", "h", 1]], [0, "no", 0], 5, [1, "", URIS])
    ]
    headers = [emit_header(fields) for fields in (SUBSCRIBER, CLIENT, PUBLISHER, {"error": "no"}, {})]
    frames = [pack("<I", len(body)) + body for body in (b"", b"bad", b"x" * 1000, b"y" * 1001)]
    replies = [ok + frame for frame in frames for ok in (b"\x00", b"\x01")]
    pools = [bodies, headers + frames, frames, frames, frames, headers + frames, headers + replies, answers]
    for _ in range(count):
        kind = source.randrange(KINDS)
        data = bytearray(b"".join(source.choice(pools[kind]) for _ in range(source.randrange(1, 5))))
        for _ in range(source.randrange(4)):
            at = source.randrange(len(data) + 1)
            data[at : at + source.randrange(3)] = source.randbytes(source.randrange(3))
        check(bytes([kind, source.randrange(256)]) + bytes(data))
    print(f"{count} inputs, no finding")


def main() -> None:
    """The command."""
    if sys.argv[1:2] == ["--smoke"]:
        smoke(int(sys.argv[2]))
        return
    import atheris

    atheris.instrument_all()
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
