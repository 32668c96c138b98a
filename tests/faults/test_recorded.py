"""Sessions of real rospy and roscpp nodes, cut at every byte and played to ours. tools/record_ros1.py recorded them."""

from __future__ import annotations

import pathlib
import socket
import struct
import threading
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import pytest

import roslet
from faults.test_peers import FakePublisher
from interop.exchange import on_scale
from nodes import Nodes, Raw, ports, wait_until
from roslet.gen.runtime import message_class

CAPTURES = pathlib.Path(__file__).resolve().parent.parent / "captures/ros1"
STRING = "std_msgs/String"
WORKSPACE = pathlib.Path(__file__).resolve().parent.parent / "interop/peers/ws"


def on_switch(request: Any) -> dict[str, Any]:
    return {"success": request.data, "message": "now " + ("on" if request.data else "off")}


class Recording(NamedTuple):
    """What two nodes of a peer said to each other: four texts on `/chatter`, and two calls of a service."""

    peer: str
    texts: list[str]
    service: str
    type: str
    serve: Callable[[Any], dict[str, Any]]
    requests: list[dict[str, Any]]
    responses: list[tuple[object, str]]  # what `outcome` says of each

    def bytes_of(self, name: str) -> bytes:
        return (CAPTURES / f"{self.peer}_{name}.bin").read_bytes()

    def outcome(self, response: Any) -> tuple[object, str]:
        if self.peer == "rospy":
            return response.success, response.message
        return [(point.x, point.y, point.z, point.time.secs) for point in response.points], response.text


def point(k: int) -> Any:
    """The k-th Coordinate of roscpp_peer.cpp."""
    roslet.load(WORKSPACE)
    kind: Any = message_class("ros1", "mros_comm_measure/Coordinate")
    stamp = roslet.Time(1700000000 + k, 123456789)
    return kind(x=k + 0.5, y=-2.0 * k - 0.25, z=1000.125 + k, time=stamp)


ROSPY = Recording(
    peer="rospy",
    texts=["one", "", "drei ä", "x" * 40],
    service="switch",
    type="std_srvs/SetBool",
    serve=on_switch,
    requests=[{"data": True}, {"data": False}],
    responses=[(True, "now on"), (False, "now off")],
)
ROSCPP = Recording(
    peer="roscpp",
    texts=["abc", "", "žluťoučký 日本 🐢 0", ("abcdefghijklmnopqrstuvwxyz" * 2)[:40]],
    service="scale",
    type="peer_msgs/Scale",
    serve=on_scale,
    requests=[{"points": [point(0), point(1)], "factor": 2.0}, {"factor": 0.5}],
    responses=[
        ([(1.0, -0.5, 2000.25, 1700000000), (3.0, -4.5, 2002.25, 1700000001)], "scaled 2"),
        ([], "scaled 0"),
    ],
)


@pytest.fixture(params=[ROSPY, ROSCPP], ids=lambda recording: recording.peer)
def recording(request: pytest.FixtureRequest) -> Recording:
    roslet.load(WORKSPACE)
    found: Recording = request.param
    return found


def frame_ends(session: bytes, flag: int = 0) -> list[int]:
    """The offsets at which the header and each message of a recorded stream end; `flag` bytes are before each message."""
    ends = [4 + struct.unpack_from("<I", session)[0]]
    while ends[-1] < len(session):
        start = ends[-1] + flag
        ends.append(start + 4 + struct.unpack_from("<I", session, start)[0])
    assert ends[-1] == len(session), "the recording ends with a whole message"
    return ends


def new(node: roslet.Node, before: dict[str, int]) -> set[str]:
    """What a node has counted since."""
    return {name for name, count in node.counters.items() if count != before.get(name, 0)}


def hear(got: list[str], message: Any) -> None:
    got.append(message.data)


def test_a_publisher_cut_at_every_byte(make: Nodes, recording: Recording) -> None:
    session = recording.bytes_of("publisher")
    header, *ends = frame_ends(session)
    fake = FakePublisher(make, "chatter")
    node = make("b")
    try:
        for cut in range(len(session) + 1):
            got: list[str] = []
            before = node.counters
            subscription = node.subscribe("chatter", STRING, partial(hear, got))
            raw = fake.take()
            raw.send(session[:cut])
            raw.close()
            wait_until(lambda before=before: new(node, before), f"cut after {cut} bytes: it is counted")  # type: ignore[misc]
            subscription.close()
            assert got == recording.texts[: sum(end <= cut for end in ends)], cut
            if cut < header:
                expected = {"closed-before-header"}
            elif cut in (header, *ends):
                expected = {"publisher-lost"}
            else:
                expected = {"publisher-lost", "frame-truncated"}
            assert new(node, before) == expected, cut
    finally:
        fake.close()


def test_a_subscriber_cut_at_every_byte(make: Nodes, recording: Recording) -> None:
    session = recording.bytes_of("subscriber")
    assert frame_ends(session) == [len(session)], "a subscriber says its header and nothing else"
    node = make("a")
    publisher = node.publisher("chatter", STRING)
    for cut in range(len(session)):
        before = node.counters
        with Raw(ports(node)[1]) as raw:
            raw.send(session[:cut])
        wait_until(lambda before=before: new(node, before), f"cut after {cut} bytes: it is counted")  # type: ignore[misc]
        assert new(node, before) == {"closed-before-header"}, cut
        assert publisher.subscriber_count == 0
    before = node.counters
    with Raw(ports(node)[1]) as raw:
        raw.send(session)
        assert raw.read_header()["type"] == STRING
        wait_until(lambda: publisher.subscriber_count == 1, "the whole header connects")
        for text in recording.texts:
            publisher.publish(data=text)
        theirs = recording.bytes_of("publisher")[frame_ends(recording.bytes_of("publisher"))[0] :]
        assert raw.read(len(theirs)) == theirs, "our messages are the peer's, byte for byte"
    wait_until(lambda: publisher.subscriber_count == 0, "its end is seen")
    assert new(node, before) == set()


def test_a_client_cut_at_every_byte(make: Nodes, recording: Recording) -> None:
    session = recording.bytes_of("client")
    header, *ends = frame_ends(session)
    answers = recording.bytes_of("service")
    answer_ends = frame_ends(answers, flag=1)
    node = make("a")
    asked: list[bytes] = []

    def serve(request: Any) -> dict[str, Any]:
        asked.append(request.serialize())
        return recording.serve(request)

    kind: Any = node.service(recording.service, recording.type, serve).type
    wanted = [kind.Request(**request).serialize() for request in recording.requests]
    node.start()
    for cut in range(len(session) + 1):
        before = node.counters
        asked.clear()
        whole = sum(end <= cut for end in ends)
        with Raw(ports(node)[1]) as raw:
            raw.send(session[:cut])
            if cut >= header:
                assert raw.read_header()["md5sum"] == kind._md5sum
                said = answers[answer_ends[0] : answer_ends[whole]]
                assert raw.read(len(said)) == said, "our responses are the peer's, byte for byte"
        assert asked == wanted[:whole], cut
        if cut < header:
            expected = {"closed-before-header"}
        elif cut in (header, *ends):
            expected = set()
        else:
            expected = {"frame-truncated"}
        wait_until(
            lambda before=before, expected=expected: new(node, before) == expected,  # type: ignore[misc]
            f"cut after {cut} bytes: {expected or 'nothing'} is counted",
        )


def test_a_service_cut_at_every_byte(make: Nodes, recording: Recording, master: Any) -> None:
    session = recording.bytes_of("service")
    header, *ends = frame_ends(session, flag=1)
    node = make("b")
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(5)
        uri = f"rosrpc://127.0.0.1:{listener.getsockname()[1]}"
        master.call("registerService", "/fake", "/" + recording.service, uri, "http://127.0.0.1:9/")

        def answer(cut: int) -> None:
            raw = Raw.__new__(Raw)
            raw.sock, _ = listener.accept()
            raw.sock.settimeout(5)
            with raw:
                raw.read_header()
                start = header
                raw.send(session[: min(cut, header)])
                for end in ends:
                    if cut < start:
                        return
                    raw.read_frame()  # the request
                    raw.send(session[start : min(cut, end)])
                    start = end
                    if cut <= end:
                        return

        for cut in range(len(session) + 1):
            before = node.counters
            thread = threading.Thread(target=answer, args=(cut,))
            thread.start()
            client = node.client(recording.service, recording.type, persistent=True)
            got: list[tuple[object, str]] = []
            failure = ""
            try:
                for request in recording.requests:
                    got.append(recording.outcome(client.call(request, timeout=5)))
            except roslet.ServiceFailed as error:
                failure = str(error)
            thread.join()
            client.close()
            whole = sum(end <= cut for end in ends)
            assert got == recording.responses[:whole], cut
            assert ("connection lost" in failure) == (whole < 2), (cut, failure)
            within = any(start + 1 <= cut < end for start, end in zip([header, *ends], ends, strict=False))
            assert new(node, before) == ({"frame-truncated"} if within else set()), cut


@pytest.mark.parametrize("name", ["publisher", "subscriber", "client", "service"])
def test_the_recordings_are_of_real_nodes(name: str, recording: Recording) -> None:
    assert b"callerid=/recorded_" in recording.bytes_of(name)
