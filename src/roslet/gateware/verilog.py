"""Nodes in Verilog. The module `ros2_ether`: the manual's ports and parameters around what Amaranth made; and its headers,
read. A node with typed ports, and the header that says what they are."""

from __future__ import annotations

import pathlib
import re
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from amaranth.lib.wiring import Out

from roslet.gateware.config import Config, ros2_config_vh, ros2_ether_config_vh
from roslet.gateware.toolchain import write_verilog
from roslet.gateware.tops.ros2_ether import Ros2Ether
from roslet.gateware.tops.ros_node import RosNode

NAME = "ros2_ether"
HEADERS = {"ros2_config.vh": ros2_config_vh, "ros2_ether_config.vh": ros2_ether_config_vh}

_DEFINE = re.compile(r"^[ \t]*`define[ \t]+(\w+)[ \t]+(.+?)[ \t\r]*(?://.*)?$", re.MULTILINE)
_DERIVED = ("payloadsmem_depth", "payloadsmem_awidth")


def read_headers(paths: Sequence[pathlib.Path]) -> Config:
    """What the headers of the manual, files or folders with `*.vh`, define, over the defaults.

    Other definitions are left alone. Raises ValueError where one of ours is no number, or says something else than
    those from which it follows.
    """
    found: dict[str, int] = {}
    known = {field.name for field in fields(Config)}
    derived: dict[str, str] = {}
    for path in paths:
        for file in sorted(path.glob("*.vh")) if path.is_dir() else [path]:
            for name, text in _DEFINE.findall(file.read_text(encoding="utf-8")):
                field = name.lower()
                if field in known:
                    if not re.fullmatch(r"[0-9_]+", text):
                        raise ValueError(f"{file}: {name} is {text}, which is no number")
                    found[field] = int(text)
                elif field in _DERIVED:
                    derived[field] = text
    config = Config(**found)
    for field, text in derived.items():
        if text.isdecimal() and int(text) != getattr(config, field):
            raise ValueError(
                f"{field.upper()} is {text}, but follows from other constants: {getattr(config, field)}"
            )
    return config


def write_ros2_ether(top: Ros2Ether, folder: pathlib.Path) -> list[str]:
    """Write ros2_ether.v and the two headers; their names."""
    config = top.config
    core = write_verilog(top, f"{NAME}_core", folder)
    text = wrapper(top) + "\n" + core.read_text(encoding="utf-8")
    (folder / f"{NAME}.v").write_text(text, encoding="utf-8")
    core.unlink()
    core.with_suffix(".il").unlink()
    for file, header in HEADERS.items():
        (folder / file).write_text(header(config), encoding="utf-8")
    return [f"{NAME}.v", *HEADERS]


def write_ros_node(top: RosNode, name: str, folder: pathlib.Path) -> list[str]:
    """Write `name`.v, a module `name` with a port for each field of the node's messages, and `name`.vh, which documents
    these; their names. Raises ValueError where the node was not made with `flat`."""
    if len(top.texts) != len(top.topics):
        raise ValueError(
            "the topics of this node are streams; RosNode(..., flat=True) has a port for each field"
        )
    folder.mkdir(parents=True, exist_ok=True)
    write_verilog(top, name, folder).with_suffix(".il").unlink()
    text = "\n".join(
        [f"// What the topics' ports of the module {name} are; all are of the clock clk.\n", *top.texts]
    )
    (folder / f"{name}.vh").write_text(text, encoding="utf-8")
    return [f"{name}.v", f"{name}.vh"]


def wrapper(top: Ros2Ether) -> str:
    """The module itself, whose parameters are those of Table A-2."""
    config = top.config
    counts = {name.lower(): name for name in config.tx_counts}
    periods = {
        field.name[: -len("_ms")].upper() + "_COUNT": getattr(config, field.name)
        for field in fields(config)
        if field.name.endswith("_ms")
    }
    members: dict[str, Any] = dict(top.signature.members)
    ports = [name for name in members if name not in counts and name != "prescaler_div"]
    lines = [
        f"// {NAME}: written by roslet. Parameters and ports are those of the ROS2rapper manual, Tables A-1 and A-2.",
        '`include "ros2_config.vh"',
        '`include "ros2_ether_config.vh"',
        "",
        f"module {NAME} #(",
        f"  parameter PRESCALER_DIV = {config.prescaler_div},",
        "  parameter PRESCALAR_DIV = PRESCALER_DIV, // the manual has both spellings; this one counts",
        ",\n".join(
            f"  parameter {name} = (`ROS2CLK_HZ / PRESCALAR_DIV) {_scale(period)}"
            for name, period in periods.items()
        ),
        ") (",
    ]
    declared = []
    for name in ports:
        width = len(getattr(top, name))
        direction = "output" if members[name].flow == Out else "input "
        declared.append(f"  {direction} wire {f'[{width - 1}:0] ' if width > 1 else ''}{name}")
    lines += [",\n".join(declared), ");"]
    lines += [
        "  // What the hardware was built with must be what user logic is built with: build it again with these headers,",
        "  // by roslet gateware build --top ros2_ether --config.",
        "  generate",
    ]
    for name in (
        "ros2_max_node_name_len",
        "ros2_max_topic_name_len",
        "ros2_max_topic_type_name_len",
        "ros2_max_app_data_len",
        "udp_rxbuf_awidth",
        "udp_txbuf_awidth",
        "payloadsmem_awidth",
        "ros2clk_hz",
    ):
        value = getattr(config, name)
        lines.append(f"    if (`{name.upper()} != {value}) {name}_is_not_{value} differs();")
    lines += ["  endgenerate", "", f"  {NAME}_core core ("]
    connected = [f"    .{name}({name})" for name in ports]
    connected += ["    .prescaler_div(PRESCALAR_DIV[15:0])"]
    connected += [f"    .{name}({parameter}[31:0])" for name, parameter in counts.items()]
    lines += [",\n".join(connected), "  );", "endmodule"]
    return "\n".join(lines)


def _scale(milliseconds: int) -> str:
    """Of a second. The manual has / 100 and * 3."""
    if milliseconds % 1000 == 0:
        return f"* {milliseconds // 1000}"
    return f"/ {1000 // milliseconds}" if 1000 % milliseconds == 0 else f"* {milliseconds} / 1000"
