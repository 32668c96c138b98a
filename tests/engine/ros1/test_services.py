"""Services between engines in virtual time."""

from struct import pack

import pytest

from engine.ros1.network import Intruder, header_bytes, world
from roslet.engine.ros1 import links
from roslet.errors import HandshakeRefused, ServiceFailed

pytestmark = pytest.mark.micropython

TYPE_CHECKING = False
if TYPE_CHECKING:
    pass


@pytest.mark.parametrize("piece", [1, 3, 1000])
def test_calls_are_answered_in_order(piece: int) -> None:
    network, _, talker, listener = world(piece)
    talker.service("/work", lambda body: b"<" + body + b">")
    network.run(1.0)
    bodies = [b"", b"a", b"b" * 100]
    results = listener.call(talker.engine.service_uri, "/work", bodies)
    assert network.run(5.0, lambda: len(results) == 3)
    assert results == [b"<>", b"<a>", b"<" + b"b" * 100 + b">"]


def test_a_connection_that_is_not_persistent_ends_after_its_answer() -> None:
    network, _, talker, listener = world()
    offer = talker.service("/work", lambda body: body)
    network.run(1.0)
    results = listener.call(talker.engine.service_uri, "/work", [b"x"], persistent=False)
    network.run(1.0)
    assert results == [b"x"] and offer.links == []


def test_requests_behind_the_last_are_dropped_and_counted() -> None:
    network, _, talker, listener = world()
    talker.service("/work", lambda body: body)
    network.run(1.0)
    results = listener.call(talker.engine.service_uri, "/work", [b"1", b"2", b"3"], persistent=False)
    network.run(1.0)
    assert results[0] == b"1" and [type(error) for error in results[1:]] == [ServiceFailed, ServiceFailed]
    assert talker.engine.counters["request-after-the-last"] >= 1


def test_a_handler_that_fails_fails_its_own_call_only() -> None:
    network, _, talker, listener = world()

    def handler(body: bytes) -> bytes:
        if body == b"bad":
            raise ServiceFailed("no \u00fcse")
        return body

    talker.service("/work", handler)
    network.run(1.0)
    results = listener.call(talker.engine.service_uri, "/work", [b"good", b"bad", b"good"])
    network.run(1.0)
    assert results[0] == results[2] == b"good"
    assert isinstance(results[1], ServiceFailed) and str(results[1]) == "no \u00fcse"


def test_a_call_of_a_service_with_another_md5sum_is_refused() -> None:
    network, _, talker, listener = world()
    talker.service("/work", lambda body: body)
    network.run(1.0)
    results = listener.call(talker.engine.service_uri, "/work", [b"x"], md5sum="other")
    network.run(1.0)
    assert isinstance(results[0], HandshakeRefused) and "has md5sum s, the client expects other" in str(
        results[0]
    )
    assert talker.engine.counters == {"md5sum-mismatch": 1}
    assert listener.engine.counters == {"refused-by-peer": 1}


def test_a_probe_gets_the_header_and_nothing_else() -> None:
    network, _, talker, _ = world()
    offer = talker.service("/work", lambda body: body)
    network.run(1.0)
    intruder = Intruder(
        network, ("alpha", 5001), header_bytes(callerid="/x", md5sum="*", service="/work", probe="1")
    )
    network.run(1.0)
    assert b"request_type=t/SReq" in intruder.heard and not intruder.end.alive
    assert offer.links == [] and talker.engine.counters == {}


def test_a_server_that_dies_fails_the_calls_under_way() -> None:
    network, _, talker, listener = world()
    talker.service("/work", lambda body: body)
    network.run(1.0)
    results = listener.call(talker.engine.service_uri, "/work", [b"x"])
    network.run(0.0045)
    talker.crash()
    network.run(1.0)
    assert isinstance(results[0], ServiceFailed) and "connection lost" in str(results[0])


def test_a_server_that_cannot_be_reached_fails_the_call_in_time() -> None:
    network, _, _talker, listener = world()
    network.vanished.append("alpha")
    results = listener.call("rosrpc://alpha:5001", "/work", [b"x"])
    network.run(links.HANDSHAKE_TIMEOUT + 1)
    assert isinstance(results[0], HandshakeRefused) and "no connection header in time" in str(results[0])
    assert listener.engine.counters == {"handshake-timeout": 1}


def test_a_client_that_does_not_take_its_replies_is_not_read_from() -> None:
    network, _, talker, _ = world(piece=1 << 20)
    calls = []

    def handler(body: bytes) -> bytes:
        calls.append(body)
        return bytes(300_000)

    offer = talker.service("/work", handler)
    network.run(1.0)
    header = header_bytes(callerid="/x", md5sum="s", service="/work", persistent="1")
    Intruder(network, ("alpha", 5001), header)
    network.run(1.0)
    (link,) = offer.links
    link.frames.writable()[:400] = pack("<I", 0) * 100
    link.received(400, network.now)
    assert link.paused and len(calls) == 4, "four replies are over the bound"
    assert len(link.data_to_send()) == 4 * 300_005
    link.go_on(network.now)
    assert link.paused and len(calls) == 8
