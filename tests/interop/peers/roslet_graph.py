"""A roslet Context on sockets, without a node of the API: roslet_graph.py ROLE [COUNT], node /robot/ours.

talker   publishes and subscribes /chatter, and serves /ask. `ready PUBLISHER SUBSCRIPTION` (GUIDs)
server   serves /ask. `ready`, `asked yes` or `asked no` for each request
client   calls /ask COUNT times, one after the other. `ready`, `answer yes`; ends by itself

All print `nodes NAMES ENCLAVES`, `subscribed TOPICS` (what /witness subscribes) at each change, and end on SIGTERM,
saying `closed`.
"""

import signal
import struct
import sys
import time

from roslet.engine.ros2.context import Context
from roslet.engine.ros2.services import ServiceClient, ServiceServer
from roslet.io.select import Reactor
from roslet.io.udp import Domain
from roslet.names import dds_topic, dds_type
from roslet.wire.rtps import qos
from roslet.wire.rtps.qos import Qos

STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
ASK_HASHES = (
    "RIHS01_c62fbb99d94e1b25e8ef9e109f9581956bb1b3361a45a4e5810c36a90d29932e",
    "RIHS01_d0814e7f7b4880ab77e9c57426c7aa1562ab69f11eef8e2e968812f9cbd0b059",
)
RELIABLE = Qos((qos.RELIABLE, 10**8), history=(qos.KEEP_LAST, 10))
LATCHED = RELIABLE.replace(durability=qos.TRANSIENT_LOCAL)


def say(*words):
    print(*words, flush=True)


class Ours:
    def __init__(self):
        self.reactor = Reactor()
        self.context = None
        self.domain = Domain(self.reactor, self.on_event)
        self.context = Context(self.domain.participant)
        self.answers = []
        self.calls = 0
        self.client = None
        with self.reactor.lock:
            self.now = self.reactor.now()
            self.context.start(self.now)
            self.node = self.context.add_node("ours", "/robot", self.now)

    def on_event(self, event):
        if self.context is not None:
            self.context.handle_event(event, self.reactor.now())

    def talk(self):
        names = dds_topic("rt", "/chatter"), dds_type("std_msgs/msg/String")
        writer = self.context.create_writer(self.node, *names, LATCHED, STRING_HASH, self.now)
        reader = self.context.create_reader(self.node, *names, RELIABLE, STRING_HASH, self.now)
        return writer.data.guid.hex(), reader.data.guid.hex()

    def serve(self):
        def asked(proxy, value, time):
            request = server.request(proxy, value, time)
            said = request.payload[4] != 0
            text = b"yes\0" if said else b"no\0"
            say("asked", "yes" if said else "no")
            body = b"\0\1\0\0" + struct.pack("<?xxxI", said, len(text)) + text
            server.reply(request, body, self.reactor.now())

        server = ServiceServer(
            self.context, self.node, "/ask", "std_srvs/srv/SetBool", RELIABLE, self.now, ASK_HASHES, asked
        )

    def call(self):
        def answered(proxy, value, time):
            found = self.client.response(proxy, value)
            if found is not None:
                length = struct.unpack_from("<I", found[1], 8)[0]
                self.answers.append(bytes(found[1][12 : 11 + length]).decode())
                say("answer", self.answers[-1])

        self.client = ServiceClient(
            self.context, self.node, "/ask", "std_srvs/srv/SetBool", RELIABLE, self.now, ASK_HASHES, answered
        )

    def turn(self, count):
        self.reactor.run_until(lambda: False, 0.01)
        with self.reactor.lock:
            now = self.reactor.now()
            self.context.handle_deadline(now)
            client = self.client
            if (
                client is not None
                and self.calls < count
                and client.ready()
                and len(self.answers) == self.calls
            ):
                client.call(b"\0\1\0\0" + bytes([self.calls % 2 == 0]), now)
                self.calls += 1
            self.domain.flush()


def main():
    role = sys.argv[1]
    count = int(sys.argv[2]) if len(sys.argv) > 2 else -1
    ended = []
    signal.signal(signal.SIGTERM, lambda *_: ended.append(True))
    ours = Ours()
    ready = ()
    with ours.reactor.lock:
        if role == "client":
            ours.call()
        else:
            ready = ours.talk() if role == "talker" else ()
            ours.serve()
        ours.context.flush(ours.now)
        ours.domain.flush()
    say("ready", *ready)
    said = {}
    ends = time.monotonic() + 60.0
    while time.monotonic() < ends and not ended and len(ours.answers) != count:
        ours.turn(count)
        graph = ours.context.graph
        nodes = sorted(one.full_name + " " + one.enclave for one in graph.nodes())
        for what, text in (
            ("nodes", "; ".join(nodes)),
            ("subscribed", " ".join(graph.topics(("witness", "/"), False))),
        ):
            if said.get(what) != text:
                said[what] = text
                say(what, text)
    ours.domain.close()
    ours.reactor.close()
    say("closed")


main()
