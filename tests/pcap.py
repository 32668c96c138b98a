"""Classic pcap files of UDP over IPv4: written for tshark to judge, read back as (source, destination, payload)."""

from __future__ import annotations

import pathlib
import struct

Endpoint = tuple[str, int]

_ETHERNET, _RAW = 1, 101


def write(path: pathlib.Path, payloads: list[bytes], port: int = 7400) -> None:
    """Each payload as a UDP datagram from 127.0.0.1 to 127.0.0.1:`port`, which tshark takes for RTPS."""
    with path.open("wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 262144, _RAW))
        for number, payload in enumerate(payloads):
            udp = struct.pack(">HHHH", 50000, port, 8 + len(payload), 0) + payload
            address = bytes((127, 0, 0, 1))
            front = struct.pack(
                ">BBHHHBBH4s4s", 0x45, 0, 20 + len(udp), number & 0xFFFF, 0x4000, 64, 17, 0, address, address
            )
            total = sum(struct.unpack(">10H", front))
            total = (total & 0xFFFF) + (total >> 16)
            total = (total & 0xFFFF) + (total >> 16)
            front = front[:10] + struct.pack(">H", total ^ 0xFFFF) + front[12:]
            packet = front + udp
            file.write(struct.pack("<IIII", number, 0, len(packet), len(packet)) + packet)


def write_frames(path: pathlib.Path, frames: list[tuple[float, bytes]]) -> None:
    """Ethernet frames with the times they were seen at."""
    with path.open("wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 262144, _ETHERNET))
        for when, frame in frames:
            seconds = int(when)
            file.write(
                struct.pack("<IIII", seconds, int((when - seconds) * 1e6), len(frame), len(frame)) + frame
            )


def read(path: pathlib.Path) -> list[tuple[Endpoint, Endpoint, bytes]]:
    """The UDP datagrams of a file that this module wrote, in order; anything else in it is left out."""
    data = path.read_bytes()
    link = struct.unpack_from("<I", data, 20)[0]
    found = []
    at = 24
    while at < len(data):
        length = struct.unpack_from("<I", data, at + 8)[0]
        packet = data[at + 16 : at + 16 + length]
        at += 16 + length
        if link == _ETHERNET:
            if packet[12:14] != b"\x08\x00":
                continue
            packet = packet[14:]
        header = (packet[0] & 15) * 4
        if packet[9] != 17 or struct.unpack_from(">H", packet, 6)[0] & 0x3FFF:
            continue
        source_port, port, size = struct.unpack_from(">HHH", packet, header)
        source = ".".join(map(str, packet[12:16])), source_port
        destination = ".".join(map(str, packet[16:20])), port
        found.append((source, destination, packet[header + 8 : header + size]))
    return found
