"""Records sessions between Debian's rospy nodes: the .bin files under tests/captures/ros1.

    python tools/record_ros1.py [OUTPUT_FOLDER]      with rospy installed for /usr/bin/python3

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
import urllib.parse
import xmlrpc.client
import xmlrpc.server
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.master.server import MasterServer

ROOT = pathlib.Path(__file__).resolve().parent.parent
PATIENCE = 20

SERVER = """
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

CLIENT = """
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


def start(program: str, master: MasterServer, folder: str) -> subprocess.Popen[bytes]:
    """A rospy program at a master."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    environment.update(
        ROS_MASTER_URI=f"http://127.0.0.1:{master.port}",
        ROS_IP="127.0.0.1",
        ROS_HOME=folder,
        ROS_LOG_DIR=folder,
    )
    return subprocess.Popen(["/usr/bin/python3", "-c", program], env=environment, stdout=subprocess.PIPE)


def record(output: pathlib.Path) -> None:
    """One session of each kind."""
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
        processes = [start(SERVER, left, folder)]
        try:
            if processes[0].stdout is None or processes[0].stdout.readline() != b"ready\n":
                raise RuntimeError("the rospy server did not start")
            api = left.call("lookupNode", "/recorder", "/recorded_server")[2]
            peer: Any = xmlrpc.client.ServerProxy(api)
            _, host, port = peer.requestTopic("/recorder", "/chatter", [["TCPROS"]])[2]
            rpc = urllib.parse.urlsplit(left.call("lookupService", "/recorder", "/switch")[2])
            right.call("registerPublisher", "/recorder", "/chatter", "std_msgs/String", uri)
            right.call("registerService", "/recorder", "/switch", f"rosrpc://127.0.0.1:{ports[1]}", uri)
            targets = [(topic, (host, port)), (service, (str(rpc.hostname), int(rpc.port or 0)))]
            found: list[tuple[bytes, bytes]] = [(b"", b"")] * 2

            def run(index: int) -> None:
                found[index] = relay(*targets[index])

            threads = [threading.Thread(target=run, args=(index,), daemon=True) for index in range(2)]
            for thread in threads:
                thread.start()
            processes.append(start(CLIENT, right, folder))
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
            (output / f"rospy_{name}.bin").write_bytes(data)
            print(f"rospy_{name}.bin: {len(data)} bytes")


if __name__ == "__main__":
    record(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "tests/captures/ros1")
