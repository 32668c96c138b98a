"""`roslet gateware`: hardware designs as Verilog, on FPGAs, and simulated."""

from __future__ import annotations

import dataclasses
import inspect
import pathlib
import runpy
from typing import TYPE_CHECKING, Any

from roslet.cli import gateware_sim
from roslet.cli.options import FAILED, OK, CommandError, Group, count, positive
from roslet.cli.output import emit_json, table

if TYPE_CHECKING:
    import argparse

TOP, ROS = "ethernet-udp", "ros2-ether"
TARGETS = ("verilog", "ecp5", "ice40", "arty-a7")
SERIAL = "serial"
"""What is told of a design without a PHY."""
PHY_MHZ = {"mii": 25.0, "gmii": 125.0}  # IEEE 802.3, 22.2.2.1 and 35.2.2.1
SETTINGS = (
    "mac_addr",
    "ip_addr",
    "gateway_ip_addr",
    "subnet_mask",
    "ros2_fragment_expiration",
    "arp_req_retry_count",
    "arp_req_retry_interval",
    "arp_req_timeout",
    "ros2_rx_udp_port",
)
"""Inputs of the top that are constants in use: packages have not as many pins."""
ROS_SETTINGS = (
    *(
        f"ros2_{name}{end}"
        for end in ("", "_len")
        for name in ("node_name", "pub_topic_name", "sub_topic_name")
    ),
    *(f"ros2_{name}{end}" for end in ("", "_len") for name in ("pub_topic_type_name", "sub_topic_type_name")),
    *(
        "ros2_node_udp_port",
        "ros2_port_num_seed",
        "ros2_guid_prefix",
        "ros2_pub_app_data",
        "ros2_pub_app_data_len",
    ),
    "prescaler_div",
    "tx_interval_count",
    *(
        f"tx_period_sedp_{kind}_count"
        for kind in ("pub_wr", "sub_wr", "pub_hb", "sub_hb", "pub_an", "sub_an")
    ),
    *("tx_period_spdp_wr_count", "tx_period_app_wr_count"),
)
"""The same of the larger one."""


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)
    build = group.command(
        "build",
        run_build,
        "write a design as Verilog, or place and route it",
        "roslet gateware build --top ros2_ether --output out\n"
        "roslet gateware build --top ros2_ether --config my_headers --output out\n"
        "roslet gateware build udp-tx-rx --target ecp5 --output out\n"
        "roslet gateware build udp-tx-rx --target arty-a7 --output out && vivado -mode batch -source out/arty_a7.tcl",
        "json",
    )
    build.description = (
        "Write a design as Verilog, or synthesize, place and route it, and report LUTs, flip-flops, block RAM and the\n"
        "frequency of each clock. The exit code is 1 where a clock is slower than it should be.\n\n"
        "DESIGN is ethernet-udp, the node of which user logic sends and receives UDP datagrams; ros2-ether, which is a\n"
        "ROS 2 node, too, with the module, ports, parameters and headers of the ROS2rapper manual; or an example with user\n"
        "logic, as udp-tx-rx, or serial-count, which has a serial line and fits an iCE40 HX8K. Pins of ecp5\n"
        "and ice40 are arbitrary; addresses and other settings of the first two come there from a shift register, since no\n"
        "package has so many pins. For arty-a7 a Vivado project is written, which nobody has run yet."
    )
    build.add_argument(
        "design", nargs="?", default=TOP, metavar="DESIGN", help=f"{TOP} (default), {ROS} or an example"
    )
    build.add_argument("--top", metavar="DESIGN", help="the same, as an option")
    build.add_argument(
        "--config",
        metavar="PATH",
        type=pathlib.Path,
        action="append",
        default=[],
        help="a header of the manual, or a folder of them, whose constants are those of the design (may be repeated)",
    )
    build.add_argument(
        "--target", choices=TARGETS, default=TARGETS[0], help=f"what for (default {TARGETS[0]})"
    )
    build.add_argument("--output", metavar="DIR", required=True, type=pathlib.Path, help="where the files go")
    build.add_argument(
        "--phy", choices=sorted(PHY_MHZ), default="mii", help="what the PHY speaks (default mii)"
    )
    build.add_argument(
        "--frequency",
        type=positive,
        metavar="MHZ",
        help="of the clock clk (default 100; on ice40 25, with gmii 125)",
    )
    build.add_argument(
        "--seed", type=count, default=1, metavar="N", help="where the placer begins (default 1)"
    )
    build.add_argument(
        "--seeds",
        type=count,
        default=1,
        metavar="N",
        help="of how many beginnings the best is taken, until the clocks are fast enough (default 1)",
    )

    gateware_sim.add(group)


def examples() -> dict[str, pathlib.Path]:
    """The examples for hardware by the names that commands have for them. Raises CommandError."""
    from roslet.cli.demo.programs import folder

    return {path.stem.replace("_", "-"): path for path in sorted((folder() / "gateware").glob("*.py"))}


def load(name: str) -> dict[str, Any]:
    """What the module of an example defines. Raises CommandError."""
    found = examples()
    if name not in found:
        raise CommandError(f"there is no design {name}: there are {', '.join([TOP, ROS, *found])}")
    return runpy.run_path(str(found[name]))


def _example(name: str, hz: int, phy: str) -> Any:
    """The design of an example, for a clock of `hz`. Raises CommandError."""
    design = load(name)["Design"]
    has_phy = "phy" in inspect.signature(design).parameters
    if not has_phy and phy != "mii":
        raise CommandError(f"{name} has a serial line and no PHY: --phy is not for it")
    try:
        return design(hz, phy=phy) if has_phy else design(hz)
    except ValueError as error:
        raise CommandError(str(error)) from None


def run_build(arguments: argparse.Namespace) -> int:
    """`roslet gateware build`."""
    name, target = (arguments.top or arguments.design).replace("_", "-"), arguments.target
    if arguments.config and name not in (TOP, ROS):
        raise CommandError(f"an example has constants of its own: --config is for {TOP} and {ROS}")
    if target == "arty-a7" and (arguments.phy != "mii" or name in (TOP, ROS)):
        raise CommandError("the Arty A7 has a PHY with MII, and takes an example with LEDs: udp-tx-rx")
    mhz = arguments.frequency or _default_mhz(target, arguments.phy)
    if target == "arty-a7" and mhz != 100:
        raise CommandError("the Arty A7 has a clock of 100 MHz")
    try:
        from roslet.gateware.tops.ethernet_udp import EthernetUdp
        from roslet.gateware.tops.ros2_ether import Ros2Ether
        from roslet.gateware.verilog import HEADERS, read_headers, write_ros2_ether
    except ModuleNotFoundError as error:
        raise CommandError(f"{error.name} is not installed: pip install 'roslet[gateware]'") from None
    try:
        config = read_headers(arguments.config)
    except (ValueError, OSError) as error:
        raise CommandError(str(error)) from None
    if arguments.frequency or not arguments.config:
        config = dataclasses.replace(config, ros2clk_hz=round(mhz * 1e6))
    mhz, hz = config.ros2clk_hz / 1e6, config.ros2clk_hz
    if name in (TOP, ROS):
        top: Any = (EthernetUdp if name == TOP else Ros2Ether)(config, arguments.phy)
    else:
        top = _example(name, hz, arguments.phy)
    has_phy = "phy_rx_clk" in top.signature.members
    if target == "arty-a7" and not has_phy:
        raise CommandError("the Arty A7 takes an example with a PHY: udp-tx-rx")
    identifier, folder = name.replace("-", "_"), arguments.output
    folder.mkdir(parents=True, exist_ok=True)
    link = arguments.phy if has_phy else SERIAL
    result: dict[str, Any] = {"design": name, "target": target, "phy": link}
    if target == "verilog":
        from roslet.gateware.toolchain import write_verilog

        if name == ROS:
            result["files"] = write_ros2_ether(top, folder)
        else:
            for file, text in HEADERS.items():
                (folder / file).write_text(text(config), encoding="utf-8")
            result["files"] = [write_verilog(top, identifier, folder).name, *HEADERS]
    elif target == "arty-a7":
        from roslet.gateware.boards import arty_a7

        result["files"] = arty_a7.build(top, identifier, folder)
    else:
        from roslet.gateware.boards import lattice
        from roslet.gateware.boards.pinned import Pinned

        chip = {"ecp5": lattice.ECP5, "ice40": lattice.ICE40}[target]
        if name in (TOP, ROS):
            top = Pinned(top, SETTINGS if name == TOP else (*SETTINGS, *ROS_SETTINGS))
            result["settings_flip_flops"] = top.bits
        goals = {"clk": mhz}
        if has_phy:
            goals |= dict.fromkeys(("phy_rx_clk", "phy_tx_clk"), PHY_MHZ[arguments.phy])
        tries = {"seed": arguments.seed, "seeds": arguments.seeds}
        result.update(lattice.build(chip, top, identifier, folder, goals, **tries))
    _show(arguments, result)
    return OK if result.get("met", True) else FAILED


def _default_mhz(target: str, phy: str) -> float:
    if phy == "gmii":
        return 125.0  # the least with which the core takes every octet
    return 25.0 if target == "ice40" else 100.0


def _show(arguments: argparse.Namespace, result: dict[str, Any]) -> None:
    if arguments.json:
        emit_json(result)
        return
    if "files" in result:
        for file in result["files"]:
            print(arguments.output / file)
        return
    print(f"{result['design']} ({result['phy']}) on {result['device']}")
    uses = ", ".join(f"{use} {number}" for use, number in result["luts"].items() if use != "total")
    print(f"LUT4        {result['luts']['total']} ({uses})")
    set_up = result.get("settings_flip_flops")
    print(f"flip-flops  {result['flip_flops']}" + (f" ({set_up} of them for settings)" if set_up else ""))
    print(f"block RAM   {result['block_rams']}")
    if "seed" in result:
        print(f"seed        {result['seed']}")
    rows = [
        (
            name,
            f"{clock['fmax']:.1f}",
            f"{clock['goal']:.1f}",
            "" if clock["fmax"] >= clock["goal"] else "too slow",
        )
        for name, clock in result["clocks"].items()
    ]
    table(("clock", "MHz", "goal", ""), rows)
