"""Sessions of real peers, cut at every byte, against a participant in the place of one of them."""

from __future__ import annotations

import pathlib

import pytest

import pcap
import peers
from roslet.engine.rtps import events
from roslet.engine.rtps.participant import Participant
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps.qos import Qos

FOLDER = peers.ROOT / "tests/captures/rtps"
FILES = sorted(FOLDER.glob("*.pcap"))
SOURCE = ("127.0.0.1", 7410)
# Of datagrams beyond it the middle is one long text: there only every 97th cut is made.
LONG = 1500
STRING = "std_msgs::msg::dds_::String_"


class Witness:
    """A participant with the prefix of a recorded one, and what it made of a session."""

    def __init__(self, prefix: bytes) -> None:
        meta, user = locator.udp4("127.0.0.1", 7410), locator.udp4("127.0.0.1", 7411)
        self.participant = Participant(prefix, 0, (meta,), (user,), (("239.255.0.1", 7400),))
        self.participant.start(0.0)
        latched = Qos((qos.RELIABLE, 10**8), qos.TRANSIENT_LOCAL, (qos.KEEP_LAST, 5))
        volatile = latched.replace(durability=qos.VOLATILE)
        for topic in ("rt/chatter", "rq/askRequest", "rr/askReply"):
            kind = {
                "rt/chatter": STRING,
                "rq/askRequest": "std_srvs::srv::dds_::SetBool_Request_",
                "rr/askReply": "std_srvs::srv::dds_::SetBool_Response_",
            }[topic]
            self.participant.create_reader(topic, kind, volatile, 0.0)
            self.participant.create_writer(topic, kind, latched, 0.0).write(b"\0\1\0\0" + bytes(40), 0.0)
        self.now = 0.0
        self.events: list[object] = []

    def take(self, datagram: bytes) -> None:
        self.participant.receive_datagram(datagram, SOURCE, self.now)

    def turn(self) -> None:
        self.now += 0.001
        self.participant.handle_deadline(self.now)
        self.participant.datagrams_to_send(self.now)
        self.events += [type(one).__name__ for one in self.participant.take_events()]

    def kinds(self) -> list[object]:
        return [one for one in self.events if one != events.SampleReceived.__name__]


@pytest.mark.parametrize("path", FILES, ids=[path.stem for path in FILES])
def test_a_session_cut_at_every_byte_raises_nothing_and_changes_nothing(path: pathlib.Path) -> None:
    session = [payload for _, _, payload in pcap.read(path)]
    for prefix in sorted({payload[8:20] for payload in session}):
        whole, cut = Witness(prefix), Witness(prefix)
        for payload in session:
            if payload[8:20] == prefix:
                continue
            whole.take(payload)
            long = len(payload) > LONG
            for size in range(0, len(payload), 97 if long else 1):
                cut.take(payload[:size])
            cut.take(payload)
            whole.turn()
            cut.turn()
        assert whole.kinds() == cut.kinds()
        assert whole.participant.endpoints == cut.participant.endpoints
        assert "EndpointMatched" in whole.kinds()
        assert cut.participant.counters["submessage-too-long"] > 1000
