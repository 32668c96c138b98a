"""A node with a Verilog port for each field: the module that is written, and a user's Verilog around it, on a simulated wire
with a software participant."""

from __future__ import annotations

import pathlib
import re
import shutil
import subprocess
from typing import Any

import pytest

import roslet
from gateware.running import started
from gateware.tops.written import Written
from roslet.cli.gateware_ros import QOS, ParticipantStation
from roslet.engine.rtps import events
from roslet.gateware.tops.ros_node import Publish, RosNode, Subscribe
from roslet.gateware.verilog import write_ros_node
from roslet.gen.runtime import message_class
from roslet.names.ros2 import TOPIC, dds_topic, dds_type
from roslet.sim.model import Model
from roslet.sim.wire import Wire

pytestmark = pytest.mark.timeout(400)  # the design is compiled
COORDINATE, TWIST = "mros_comm_measure/msg/Coordinate", "geometry_msgs/msg/Twist"
CLOCK, FACTOR = 25e6, 50.0
TOPICS: list[Publish | Subscribe] = [Subscribe("cmd_vel", TWIST), Publish("place", COORDINATE)]
# The user's part: the upper halves of two float64, which are float32 as good as any, come back.
USER = """
module user(input wire clk, rst_n, phy_rx_clk, phy_tx_clk, phy_rx_dv, phy_rx_er, input wire [3:0] phy_rxd,
            output wire phy_tx_en, phy_rst_n, output wire [3:0] phy_txd);
  wire valid, ready;
  wire [63:0] x, z;
  robot node(.clk(clk), .rst_n(rst_n), .phy_rx_clk(phy_rx_clk), .phy_tx_clk(phy_tx_clk), .phy_rx_dv(phy_rx_dv),
             .phy_rx_er(phy_rx_er), .phy_rxd(phy_rxd), .phy_tx_en(phy_tx_en),
             .phy_rst_n(phy_rst_n), .phy_txd(phy_txd), .alive(), .matched(),
             .cmd_vel_valid(valid), .cmd_vel_ready(ready), .cmd_vel_linear_x(x), .cmd_vel_angular_z(z),
             .place_valid(valid), .place_ready(ready), .place_x(x[63:32]), .place_y(32'h3f800000), .place_z(z[63:32]),
             .place_time_sec(-32'sd7), .place_time_nanosec(x[31:0]));
endmodule
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    folder = tmp_path_factory.mktemp("flat")
    roslet.load(pathlib.Path(__file__).parents[3] / "examples/msgs/mros_comm_measure")
    node = RosNode("robot", topics=TOPICS, clk_hz=CLOCK / FACTOR, flat=True)
    assert write_ros_node(node, "robot", folder) == ["robot.v", "robot.vh"]
    (folder / "user.v").write_text(USER)
    return folder


def test_its_ports_are_the_fields_and_the_header_documents_each(written: pathlib.Path) -> None:
    module = re.search(
        r"^module robot\((.*?)\);$(.*?)^endmodule", (written / "robot.v").read_text(), re.M | re.S
    )
    assert module is not None
    found = re.findall(r"^  (input|output) (?:signed )?(?:\[(\d+):0\] )?(\w+);", module[2], re.M)
    ports = {name: (way, int(high or 0) + 1) for way, high, name in found}
    expected = {
        **{f"cmd_vel_{part}_{axis}": ("output", 64) for part in ("linear", "angular") for axis in "xyz"},
        **{f"place_{field}": ("input", 32) for field in ("x", "y", "z", "time_sec", "time_nanosec")},
        "cmd_vel_valid": ("output", 1),
        "cmd_vel_ready": ("input", 1),
        "place_valid": ("input", 1),
        "place_ready": ("output", 1),
    }
    assert {name: port for name, port in ports.items() if name.startswith(("cmd_vel", "place"))} == expected
    header = (written / "robot.vh").read_text()
    assert all(line.startswith("//") or not line for line in header.splitlines())
    documented = dict(re.findall(r"^// (\w+) +(\d+) ", header, re.M))
    assert documented == {name: str(width) for name, (_, width) in expected.items()}


def test_without_flat_ports_it_is_refused(tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValueError, match="flat=True"):
        write_ros_node(RosNode("robot", topics=TOPICS[:1]), "robot", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_users_verilog_is_built_on_it(written: pathlib.Path) -> None:
    if shutil.which("iverilog") is None:
        pytest.skip("no Icarus Verilog: tools/debian.sh installs it")
    command = ["iverilog", "-g2005-sv", "-Wall", "-t", "null", "-s", "user", "user.v", "robot.v"]
    done = subprocess.run(command, cwd=written, capture_output=True, text=True, check=True, timeout=60)
    assert "user.v" not in done.stderr, "no port is left out, none has another width"


def test_what_was_written_sends_and_receives(written: pathlib.Path) -> None:
    twist: Any = message_class("ros2", TWIST)
    coordinate: Any = message_class("ros2", COORDINATE)
    got: list[Any] = []
    matched: list[str] = []
    with Model(Written("user", [written / "robot.v", written / "user.v"])) as model:
        wire = Wire(FACTOR)
        started(model, wire, CLOCK)
        station = ParticipantStation(wire.hub.port())
        wire.add(station)
        peer = station.participant
        peer.create_reader(dds_topic(TOPIC, "/place"), dds_type(COORDINATE), QOS, wire.now)
        writer = peer.create_writer(dds_topic(TOPIC, "/cmd_vel"), dds_type(TWIST), QOS, wire.now)

        def look() -> bool:
            while (event := peer.next_event()) is not None:
                if isinstance(event, events.EndpointMatched):
                    matched.append(event.data.topic)
                elif isinstance(event, events.SampleReceived):
                    got.append(coordinate.deserialize(event.payload))
            return False

        assert wire.run(20.0, lambda: look() or len(matched) >= 2), "they find each other"
        for number in (1.5, -2.25):
            message = twist()
            message.linear.x, message.angular.z = number, 1.875
            writer.write(message.serialize(), wire.now)
            before = len(got)
            assert wire.run(5.0, lambda before=before: look() or len(got) > before)  # type: ignore[misc]
        wire.close()
    # The upper half of 1.5 in 64 bits, 3ff80000, is 1.9375 in 32, and so on.
    assert [(one.x, one.y, one.z) for one in got] == [(1.9375, 1.0, 1.984375), (-2.03125, 1.0, 1.984375)]
    assert [(one.time.sec, one.time.nanosec) for one in got] == [(-7, 0), (-7, 0)]
