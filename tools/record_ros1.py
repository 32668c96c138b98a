"""Records sessions between Debian's rospy nodes, and between roscpp nodes: the .bin files under tests/captures/ros1.

    python tools/record_ros1.py [OUTPUT_FOLDER]      with the peers of `make peers`

There are two masters. The publisher and the service are registered at one, the subscriber and the client at the other,
where this program is registered in their stead: it relays both connections and keeps each direction as it is on the wire.
"""

from __future__ import annotations

import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.parse
import xmlrpc.client
import xmlrpc.server
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))

import peers
from roslet.master.server import MasterServer

ROOT = pathlib.Path(__file__).resolve().parent.parent
PATIENCE = 20

ROSPY_SERVER = """
import rospy
from std_msgs.msg import String
from std_srvs.srv import SetBool
rospy.init_node("recorded_server")
rospy.Service("switch", SetBool, lambda request: (request.data, "now " + ("on" if request.data else "off")))
publisher = rospy.Publisher("chatter", String, queue_size=10)
print("ready", flush=True)
while publisher.get_num_connections() == 0:
    rospy.sleep(0.01)
for text in ("one", "", "drei \\u00e4", "x" * 40):
    publisher.publish(text)
rospy.spin()
"""

ROSPY_CLIENT = """
import rospy
from std_msgs.msg import String
from std_srvs.srv import SetBool
rospy.init_node("recorded_client")
heard = []
rospy.Subscriber("chatter", String, heard.append)
while len(heard) < 4:
    rospy.sleep(0.01)
switch = rospy.ServiceProxy("switch", SetBool, persistent=True)
switch(True)
switch(False)
switch.close()
"""


def relay(listener: socket.socket, target: tuple[str, int]) -> tuple[bytes, bytes]:
    """One connection, passed on to `target`; what the connecting side said, and what the other did."""
    kept = (bytearray(), bytearray())

    def pump(source: socket.socket, sink: socket.socket, keep: bytearray) -> None:
        try:
            while piece := source.recv(65536):
                keep += piece
                sink.sendall(piece)
            sink.shutdown(socket.SHUT_WR)
        except OSError:
            pass  # one side has gone; what it said is kept

    left, _ = listener.accept()
    with left, socket.create_connection(target, PATIENCE) as right:
        pumps = [
            threading.Thread(target=pump, args=(left, right, kept[0]), daemon=True),
            threading.Thread(target=pump, args=(right, left, kept[1]), daemon=True),
        ]
        for thread in pumps:
            thread.start()
        for thread in pumps:
            thread.join(PATIENCE)
    return bytes(kept[0]), bytes(kept[1])


class Rospy:
    """The two ends of the sessions as rospy programs, each at a master of its own."""

    service = "/switch"

    def __init__(self, master: MasterServer, folder: str, program: str) -> None:
        self.process = start([str(peers.DEBIAN_PYTHON), "-c", program], master, folder)

    @classmethod
    def server(cls, master: MasterServer, folder: str) -> Rospy:
        """Publishes `/chatter` as soon as somebody listens, and offers `/switch`."""
        made = cls(master, folder, ROSPY_SERVER)
        if made.process.stdout is None or made.process.stdout.readline() != b"ready\n":
            raise RuntimeError("the rospy server did not start")
        return made

    @classmethod
    def client(cls, master: MasterServer, folder: str) -> Rospy:
        """Listens, and calls when it has heard everything."""
        return cls(master, folder, ROSPY_CLIENT)

    @staticmethod
    def drive(server: Rospy, client: Rospy) -> None:
        """Both programs act by themselves."""


class Roscpp:
    """The same with tests/interop/peers/roscpp_peer.cpp, which obeys line by line."""

    service = "/scale"

    def __init__(self, master: MasterServer, folder: str, name: str) -> None:
        self.process = start([str(peers.find("roscpp")), f"__name:={name}"], master, folder)
        self.wait_for("ready")

    @classmethod
    def server(cls, master: MasterServer, folder: str) -> Roscpp:
        """Advertises `/chatter` and offers `/scale`."""
        made = cls(master, folder, "recorded_server")
        made.ask("advertise std_msgs/String chatter", "advertised")
        made.ask("serve scale", "serving")
        return made

    @classmethod
    def client(cls, master: MasterServer, folder: str) -> Roscpp:
        """Listens."""
        made = cls(master, folder, "recorded_client")
        made.ask("subscribe std_msgs/String chatter", "subscribed")
        return made

    def wait_for(self, answer: str) -> str:
        """The next line that begins with `answer`."""
        if self.process.stdout is None:
            raise RuntimeError("no output")
        for line in self.process.stdout:
            if line.decode().startswith(answer):
                return line.decode()
        raise RuntimeError(f"the roscpp peer ended before it said {answer!r}")

    def ask(self, command: str, answer: str) -> str:
        """Say a command; the line that answers it."""
        if self.process.stdin is None:
            raise RuntimeError("no input")
        self.process.stdin.write(command.encode() + b"\n")
        self.process.stdin.flush()
        return self.wait_for(answer)

    @staticmethod
    def drive(server: Roscpp, client: Roscpp) -> None:
        """Four messages, two calls, the end of the client."""
        while server.ask("subscribers chatter", "subscribers").split()[-1] == "0":
            time.sleep(0.01)
        for size in (3, 0, -1, 40):  # -1: a text beyond ASCII
            server.ask(f"publish chatter 0 {size}", "published")
            client.wait_for("got")
        client.ask("call scale 2 2.0 1", "called")
        client.ask("call scale 0 0.5 1", "called")
        if client.process.stdin is not None:
            client.process.stdin.close()


def start(command: list[str], master: MasterServer, folder: str) -> subprocess.Popen[bytes]:
    """A peer's process at a master."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment.update(
        ROS_MASTER_URI=f"http://127.0.0.1:{master.port}",
        ROS_IP="127.0.0.1",
        ROS_HOME=folder,
        ROS_LOG_DIR=folder,
    )
    return subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE)


def record(output: pathlib.Path, kind: type[Rospy] | type[Roscpp]) -> None:
    """One session of each sort between two nodes of a kind."""
    with (
        MasterServer("127.0.0.1", 0) as left,
        MasterServer("127.0.0.1", 0) as right,
        socket.create_server(("127.0.0.1", 0)) as topic,
        socket.create_server(("127.0.0.1", 0)) as service,
        xmlrpc.server.SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as slave,
        tempfile.TemporaryDirectory() as folder,
    ):
        topic.settimeout(PATIENCE)
        service.settimeout(PATIENCE)
        ports = [sock.getsockname()[1] for sock in (topic, service)]
        uri = f"http://127.0.0.1:{slave.server_address[1]}/"
        slave.register_function(
            lambda caller, name, protocols: [1, "", ["TCPROS", "127.0.0.1", ports[0]]], "requestTopic"
        )
        threading.Thread(target=slave.serve_forever, daemon=True).start()
        server: Any = kind.server(left, folder)
        processes = [server.process]
        try:
            api = left.call("lookupNode", "/recorder", "/recorded_server")[2]
            peer: Any = xmlrpc.client.ServerProxy(api)
            _, host, port = peer.requestTopic("/recorder", "/chatter", [["TCPROS"]])[2]
            rpc = urllib.parse.urlsplit(left.call("lookupService", "/recorder", kind.service)[2])
            right.call("registerPublisher", "/recorder", "/chatter", "std_msgs/String", uri)
            right.call("registerService", "/recorder", kind.service, f"rosrpc://127.0.0.1:{ports[1]}", uri)
            targets = [(topic, (host, port)), (service, (str(rpc.hostname), int(rpc.port or 0)))]
            found: list[tuple[bytes, bytes]] = [(b"", b"")] * 2

            def run(index: int) -> None:
                found[index] = relay(*targets[index])

            threads = [threading.Thread(target=run, args=(index,), daemon=True) for index in range(2)]
            for thread in threads:
                thread.start()
            client: Any = kind.client(right, folder)
            processes.append(client.process)
            kind.drive(server, client)
            for thread in threads:
                thread.join(PATIENCE)
        finally:
            for process in processes:
                process.terminate()
                process.wait()
            slave.shutdown()
    if not all(map(all, found)):
        raise RuntimeError("a session did not end; nothing is written")
    output.mkdir(parents=True, exist_ok=True)
    for names, pair in zip((("subscriber", "publisher"), ("client", "service")), found, strict=True):
        for name, data in zip(names, pair, strict=True):
            path = output / f"{kind.__name__.lower()}_{name}.bin"
            path.write_bytes(data)
            print(f"{path.name}: {len(data)} bytes")


if __name__ == "__main__":
    for recorded in (Rospy, Roscpp):
        record(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "tests/captures/ros1", recorded)
