"""The manual's module in Verilog, and its headers read back."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from gateware.tops.test_ros2_ether import LIFTED, TABLE_A_2, wanted_ports
from roslet.gateware.config import Config, ros2_config_vh, ros2_ether_config_vh
from roslet.gateware.tops.ros2_ether import Ros2Ether
from roslet.gateware.verilog import read_headers, write_ros2_ether


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """From headers in which constants have been lifted."""
    folder = tmp_path_factory.mktemp("verilog")
    text = ros2_config_vh(Config()) + ros2_ether_config_vh(Config())
    for name, old, new in (
        ("ROS2_MAX_NODE_NAME_LEN", 32, 40),
        ("ROS2_MAX_TOPIC_NAME_LEN", 32, 48),
        ("ROS2_MAX_TOPIC_TYPE_NAME_LEN", 64, 80),
        ("ROS2_MAX_APP_DATA_LEN", 64, 200),
        ("UDP_RXBUF_AWIDTH", 6, 8),
        ("UDP_TXBUF_AWIDTH", 6, 7),
        ("MAX_IP_FRAGMENTS", 2, 4),
    ):
        text, changed = re.subn(rf"(`define {name} +){old}\n", rf"\g<1>{new}\n", text)
        assert changed == 1
    text = re.sub(r"`define PAYLOADSMEM_.*\n", "", text)
    (folder / "lifted.vh").write_text(text)
    write_ros2_ether(Ros2Ether(read_headers([folder / "lifted.vh"])), folder)
    return folder


def test_the_module_has_the_ports_and_the_parameters_of_the_manual(built: Path) -> None:
    text = (built / "ros2_ether.v").read_text()
    body = re.search(r"^module ros2_ether #\((.*?)\n\) \(\n(.*?)^\);", text, re.MULTILINE | re.DOTALL)
    assert body is not None
    found = re.findall(r"^ +(input|output) +wire (?:\[(\d+):0\] )?(\w+)", body[2], re.MULTILINE)
    assert {(name, way, int(high or 0) + 1) for way, high, name in found} == wanted_ports(**LIFTED)
    parameters = set(re.findall(r"parameter (\w+) =", body[1]))
    assert parameters == {"PRESCALAR_DIV", *(name.upper() for name in TABLE_A_2.split())}


@pytest.mark.parametrize("set_", ["", "PRESCALER_DIV(32)", "PRESCALAR_DIV(32)"])
def test_icarus_verilog_accepts_it_with_its_headers(built: Path, set_: str) -> None:
    if shutil.which("iverilog") is None:
        pytest.skip("no Icarus Verilog: tools/debian.sh installs it")
    (built / "user.v").write_text(
        f"module user; ros2_ether {f'#(.{set_})' if set_ else ''} node(); endmodule\n"
    )
    command = [
        "iverilog",
        "-g2005-sv",
        "-t",
        "null",
        "-s",
        "user",
        "-I",
        str(built),
        "user.v",
        "ros2_ether.v",
    ]
    subprocess.run(command, cwd=built, check=True, timeout=100)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("`define ROS2_MAX_APP_DATA_LEN many", "which is no number"),
        ("`define PAYLOADSMEM_DEPTH 100", "follows from other constants"),
        ("`define ROS2_MAX_APP_DATA_LEN 300", "at most 255"),
    ],
)
def test_headers_that_cannot_be_built_are_refused(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "some.vh").write_text(text + "\n")
    with pytest.raises(ValueError, match=said):
        read_headers([tmp_path])


def test_headers_say_what_they_were_written_from(tmp_path: Path) -> None:
    config = Config(ros2_max_app_data_len=128, ros2clk_hz=50_000_000, udp_txbuf_awidth=7)
    (tmp_path / "ros2_config.vh").write_text(ros2_config_vh(config))
    (tmp_path / "ros2_ether_config.vh").write_text(ros2_ether_config_vh(config))
    assert read_headers([tmp_path]) == config
