"""The constants of the manual, Tables A-2 and A-3, as one record; the Verilog headers that say them; the ports of RTPS."""

from __future__ import annotations

from dataclasses import dataclass, fields

from roslet.gateware.raw_udp import RX_HEADER, TX_HEADER, data_limit
from roslet.wire.net import ethernet, ipv4
from roslet.wire.rtps import locator

_FIFO_DEPTHS = ("mac_tx_fifo_depth", "mac_rx_fifo_depth", "ext_tx_fifo_depth", "ext_rx_fifo_depth")
_LENGTHS = (
    "ros2_max_node_name_len",
    "ros2_max_topic_name_len",
    "ros2_max_topic_type_name_len",
    "ros2_max_app_data_len",
)
_MAX_LENGTH = 255  # Table A-1: the ports that say how much of it is used have 8 bits
_MAX_PARTICIPANT = (
    119  # RTPS 9.6.1.1: with PG 2 and DG 250, the last whose unicast ports are its own domain's
)
_MAX_PORT = 0xFFFF


@dataclass(frozen=True)
class Config:
    """What a node in gates is built with. A field has the manual's name in lower case, and its default.

    The periods of Table A-2 are here in milliseconds, `tx_counts` has them as the manual does. Raises ValueError for what
    cannot be built.
    """

    # Table A-3, ros2_config.vh. Lengths of names count their NUL.
    ros2_max_node_name_len: int = 32
    ros2_max_topic_name_len: int = 32
    ros2_max_topic_type_name_len: int = 64
    ros2_max_app_data_len: int = 64
    target_participant_id: int = 1
    max_pendings: int = 1
    ip_max_payload_len: int = ethernet.MTU - ipv4.SIZE
    max_ip_fragments: int = 2
    ros2clk_hz: int = 100_000_000

    # Table A-3, ros2_ether_config.vh.
    udp_rxbuf_awidth: int = 6
    udp_txbuf_awidth: int = 6
    mac_tx_fifo_depth: int = 512
    mac_rx_fifo_depth: int = 2048
    ext_tx_fifo_depth: int = 2
    ext_rx_fifo_depth: int = 2048
    arp_cache_addr_width: int = 4

    # Table A-2.
    prescaler_div: int = 64
    tx_interval_ms: int = 10
    tx_period_spdp_wr_ms: int = 3000
    tx_period_sedp_pub_wr_ms: int = 3000
    tx_period_sedp_sub_wr_ms: int = 3000
    tx_period_sedp_pub_hb_ms: int = 3000
    tx_period_sedp_sub_hb_ms: int = 3000
    tx_period_sedp_pub_an_ms: int = 3000
    tx_period_sedp_sub_an_ms: int = 3000
    tx_period_app_wr_ms: int = 3000

    def __post_init__(self) -> None:
        for field in fields(self):
            if getattr(self, field.name) < (0 if field.name == "target_participant_id" else 1):
                raise ValueError(f"{field.name} is at least 1, not {getattr(self, field.name)}")
        for name in _FIFO_DEPTHS:
            if getattr(self, name) & (getattr(self, name) - 1):
                raise ValueError(f"{name} is a power of two, not {getattr(self, name)}")
        for name in _LENGTHS:
            if getattr(self, name) > _MAX_LENGTH:
                raise ValueError(f"{name} is at most {_MAX_LENGTH}, not {getattr(self, name)}")
        if self.target_participant_id > _MAX_PARTICIPANT:
            raise ValueError(
                f"target_participant_id is at most {_MAX_PARTICIPANT}, not {self.target_participant_id}"
            )
        data_limit(RX_HEADER, self.udp_rxbuf_awidth, None)
        data_limit(TX_HEADER, self.udp_txbuf_awidth, None)

    @property
    def payloadsmem_depth(self) -> int:
        """Octets of the memory in which fragments wait. The manual, 2."""
        return self.max_pendings * self.ip_max_payload_len * self.max_ip_fragments

    @property
    def payloadsmem_awidth(self) -> int:
        return (self.payloadsmem_depth - 1).bit_length()

    @property
    def ros2_app_data_awidth(self) -> int:
        """The width of `ros2_sub_app_data_addr`. Table A-1."""
        return (self.ros2_max_app_data_len - 1).bit_length()

    @property
    def tx_counts(self) -> dict[str, int]:
        """The periods in clocks divided by `prescaler_div`, by the names of Table A-2."""
        ticks = self.ros2clk_hz // self.prescaler_div
        return {
            field.name[: -len("_ms")].upper() + "_COUNT": ticks * getattr(self, field.name) // 1000
            for field in fields(self)
            if field.name.endswith("_ms")
        }


def ros2_config_vh(config: Config) -> str:
    """The header `ros2_config.vh`: what Table A-3 has outside of the Ethernet part, in whatever file."""
    return _header(
        "ros2_config.vh",
        config,
        *_LENGTHS,
        "target_participant_id",
        "payloadsmem_depth",
        "payloadsmem_awidth",
        "max_pendings",
        "ip_max_payload_len",
        "max_ip_fragments",
        "ros2clk_hz",
    )


def ros2_ether_config_vh(config: Config) -> str:
    """The header `ros2_ether_config.vh`."""
    return _header(
        "ros2_ether_config.vh",
        config,
        "udp_rxbuf_awidth",
        "udp_txbuf_awidth",
        *_FIFO_DEPTHS,
        "arp_cache_addr_width",
    )


def _header(file: str, config: Config, *names: str) -> str:
    guard = file.upper().replace(".", "_")
    width = max(map(len, names))
    lines = [
        f"// {file}: written by roslet; change the configuration, not this.",
        f"`ifndef {guard}",
        f"`define {guard}",
    ]
    lines += [f"`define {name.upper():{width}} {getattr(config, name)}" for name in names]
    return "\n".join([*lines, "`endif", ""])


def rtps_ports(domain: int, participant: int, seed: int | None = None) -> dict[str, int]:
    """The UDP ports on which RTPS receives. The manual, 7.3.

    `seed` is the manual's `ros2_port_num_seed`, any number, in place of that of the domain. Raises ValueError where a port
    would be none.
    """
    zero = locator.metatraffic_multicast_port(0)
    base = locator.metatraffic_multicast_port(domain) if seed is None else seed
    ports = {
        "SPDP_WELL_KNOWN_MULTICAST_PORT": base,
        "METATRAFFIC_UNICAST_LOCATOR": base + locator.metatraffic_unicast_port(0, participant) - zero,
        "DEFAULT_UNICAST_LOCATOR": base + locator.user_unicast_port(0, participant) - zero,
    }
    for name, port in ports.items():
        if not 0 < port <= _MAX_PORT:
            raise ValueError(f"the port {name} of RTPS would be {port}, which is none")
    return ports


def check_rx_udp_port(port: int, domain: int, participant: int, seed: int | None = None) -> None:
    """Raises ValueError where a user may not listen on `port`: for it is one on which RTPS receives, or none."""
    if not 0 < port <= _MAX_PORT:
        raise ValueError(f"a UDP port is from 1 to {_MAX_PORT}, not {port}")
    for name, taken in rtps_ports(domain, participant, seed).items():
        if port == taken:
            raise ValueError(f"UDP port {port} is taken by RTPS ({name}): user data need another one")
