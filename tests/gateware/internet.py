"""Datagrams for tests of IPv4 and above: scapy makes them and takes them apart, the gateware's metas are spelled here."""

from __future__ import annotations

import random
from collections.abc import Sequence
from ipaddress import IPv4Address
from itertools import pairwise
from typing import Any

from scapy.layers.inet import IP
from scapy.packet import Raw

OWN, PEER, GATEWAY, MASK = "192.168.7.2", "192.168.7.9", "192.168.7.1", "255.255.255.0"
OWN_MAC, PEER_MAC = bytes.fromhex("020000000002"), bytes.fromhex("0200000000aa")


def octets(address: str) -> int:
    """An IPv4 address as gateware holds it: the first octet in the lowest bits."""
    return int.from_bytes(IPv4Address(address).packed, "little")


def mac(address: bytes) -> int:
    return int.from_bytes(address, "little")


def addresses(ip: str = OWN, mask: str = MASK) -> dict[str, int]:
    return {"mac": mac(OWN_MAC), "ip": octets(ip), "gateway": octets(GATEWAY), "mask": octets(mask)}


def own_addresses(dut: Any, ip: str = OWN, mask: str = MASK) -> Any:
    """A testbench that gives a block the node's addresses."""

    async def process(ctx: Any) -> None:
        ctx.set(dut.addresses, addresses(ip, mask))

    return process


def datagram(payload: bytes, **fields: Any) -> bytes:
    return bytes(IP(**{"src": PEER, "dst": OWN, "proto": 17, **fields}) / Raw(payload))


def ethernet_rx(group: int = 0) -> dict[str, int]:
    return {"source": mac(PEER_MAC), "group": group}


def ipv4_rx(
    length: int, protocol: int = 17, source: str = PEER, destination: str = OWN, group: int = 0
) -> dict[str, int]:
    return {
        "mac": mac(PEER_MAC),
        "source": octets(source),
        "destination": octets(destination),
        "protocol": protocol,
        "length": length,
        "group": group,
    }


def lead(destination: str = PEER, protocol: int = 17, length: int = 0, hop: bytes = PEER_MAC) -> bytes:
    """What begins a payload on its way to IPv4."""
    return hop + IPv4Address(destination).packed + bytes([0, protocol]) + length.to_bytes(2, "big")


def turning(dut: Any) -> Any:
    """A testbench that turns the addresses beside `dut.i` as Ipv4Rx does."""

    async def process(ctx: Any) -> None:
        meta = dut.i.meta
        while True:
            (_, _, turn, source, destination) = await ctx.tick().sample(
                dut.turn, meta.source, meta.destination
            )
            if turn:
                ring = source | destination << 32
                ring = ring >> 8 | (ring & 0xFF) << 56
                ctx.set(meta.source, ring & 0xFFFF_FFFF)
                ctx.set(meta.destination, ring >> 32)

    return process


def fields(meta: Any) -> dict[str, int]:
    """A meta that was received as a dict, to compare."""
    return {name: int(getattr(meta, name)) for name, _ in meta.shape()}


def noise(count: int, seed: int = 1) -> bytes:
    return random.Random(seed).randbytes(count)


def pieces(payload: bytes, *starts: int) -> Sequence[tuple[int, bytes, bool]]:
    """(offset in octets, data, more) of a payload that is cut at `starts`."""
    edges = [0, *starts, len(payload)]
    return [(a, payload[a:b], b < len(payload)) for a, b in pairwise(edges)]
