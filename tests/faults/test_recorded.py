"""Sessions of real rospy nodes, cut at every byte and played to ours. tools/record_ros1.py recorded them."""

from __future__ import annotations

import pathlib
import socket
import struct
import threading
from functools import partial
from typing import Any

import pytest

import roslet
from faults.test_peers import FakePublisher
from nodes import Nodes, Raw, ports, wait_until

CAPTURES = pathlib.Path(__file__).resolve().parent.parent / "captures/ros1"
STRING = "std_msgs/String"
TEXTS = ["one", "", "drei ä", "x" * 40]
BODIES = [struct.pack("<I", len(text.encode())) + text.encode() for text in TEXTS]


def recorded(name: str) -> bytes:
    return (CAPTURES / f"rospy_{name}.bin").read_bytes()


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


def test_a_rospy_publisher_cut_at_every_byte(make: Nodes) -> None:
    session = recorded("publisher")
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
            assert got == TEXTS[: sum(end <= cut for end in ends)], cut
            if cut < header:
                expected = {"closed-before-header"}
            elif cut in (header, *ends):
                expected = {"publisher-lost"}
            else:
                expected = {"publisher-lost", "frame-truncated"}
            assert new(node, before) == expected, cut
    finally:
        fake.close()


def test_a_rospy_subscriber_cut_at_every_byte(make: Nodes) -> None:
    session = recorded("subscriber")
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
        for text in TEXTS:
            publisher.publish(data=text)
        theirs = recorded("publisher")[frame_ends(recorded("publisher"))[0] :]
        assert raw.read(len(theirs)) == theirs, "our messages are rospy's, byte for byte"
    wait_until(lambda: publisher.subscriber_count == 0, "its end is seen")
    assert new(node, before) == set()


def test_a_rospy_client_cut_at_every_byte(make: Nodes) -> None:
    session = recorded("client")
    header, *ends = frame_ends(session)
    answers = recorded("service")
    answer_ends = frame_ends(answers, flag=1)
    node = make("a")
    asked: list[bool] = []

    def switch(request: Any) -> dict[str, Any]:
        asked.append(request.data)
        return {"success": request.data, "message": "now " + ("on" if request.data else "off")}

    node.service("switch", "std_srvs/SetBool", switch)
    node.start()
    for cut in range(len(session) + 1):
        before = node.counters
        asked.clear()
        whole = sum(end <= cut for end in ends)
        with Raw(ports(node)[1]) as raw:
            raw.send(session[:cut])
            if cut >= header:
                assert raw.read_header()["md5sum"] == "09fb03525b03e7ea1fd3992bafd87e16"
                said = answers[answer_ends[0] : answer_ends[whole]]
                assert raw.read(len(said)) == said, "our responses are rospy's, byte for byte"
        assert asked == [True, False][:whole], cut
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


def test_a_rospy_service_cut_at_every_byte(make: Nodes, master: Any) -> None:
    session = recorded("service")
    header, *ends = frame_ends(session, flag=1)
    node = make("b")
    with socket.create_server(("127.0.0.1", 0)) as listener:
        listener.settimeout(5)
        uri = f"rosrpc://127.0.0.1:{listener.getsockname()[1]}"
        master.call("registerService", "/fake", "/switch", uri, "http://127.0.0.1:9/")

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
            client = node.client("switch", "std_srvs/SetBool", persistent=True)
            got: list[tuple[bool, str]] = []
            failure = ""
            try:
                for value in (True, False):
                    response = client.call(data=value, timeout=5)
                    got.append((response.success, response.message))
            except roslet.ServiceFailed as error:
                failure = str(error)
            thread.join()
            client.close()
            whole = sum(end <= cut for end in ends)
            assert got == [(True, "now on"), (False, "now off")][:whole], cut
            assert ("connection lost" in failure) == (whole < 2), (cut, failure)
            within = any(start + 1 <= cut < end for start, end in zip([header, *ends], ends, strict=False))
            assert new(node, before) == ({"frame-truncated"} if within else set()), cut


@pytest.mark.parametrize("name", ["publisher", "subscriber", "client", "service"])
def test_the_recordings_are_of_rospy(name: str) -> None:
    assert b"callerid=/recorded_" in recorded(name)
