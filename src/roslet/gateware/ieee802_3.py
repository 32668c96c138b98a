"""What IEEE 802.3 fixes about the octets on the wire. Clauses of IEEE 802.3-2018.

    7           1    6            6       2     46 .. 1500         4    12
    preamble    SFD  destination  source  type  data and padding   FCS  gap

Sizes of frames are counted from the destination to the FCS.
"""

from __future__ import annotations

from amaranth.lib.crc import Processor
from amaranth.lib.crc.catalog import CRC32_ETHERNET

PREAMBLE = 0x55  # 3.2.1, its first bit in the lowest
PREAMBLE_SIZE = 7
SFD = 0xD5  # 3.2.2, start frame delimiter
FCS_SIZE = 4  # 3.2.9
MIN_SIZE = 64  # 4.4.2, minFrameSize of 512 bits
MAX_SIZE = 1518  # 4.4.2, maxBasicFrameSize
GAP_SIZE = 12  # 4.4.2, interPacketGap of 96 bits


def frame_check(width: int) -> Processor:
    """What computes the frame check sequence, 3.2.9, from `width` bits a cycle, the lower ones first.

    `crc` is the sequence as it is sent, from its lowest bits on: it belongs behind the data of the cycles before. Fed with
    `~crc[:width]`, `crc` shifts down by `width`, so that it can be sent without a register of its own.
    """
    return CRC32_ETHERNET(data_width=width).create()
