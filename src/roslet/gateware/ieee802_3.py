"""What IEEE 802.3 fixes about the octets on the wire. Clauses of IEEE 802.3-2018.

    7           1    6            6       2     46 .. 1500         4    12
    preamble    SFD  destination  source  type  data and padding   FCS  gap

Sizes of frames are counted from the destination to the FCS.
"""

from __future__ import annotations

PREAMBLE = 0x55  # 3.2.1, its first bit in the lowest
PREAMBLE_SIZE = 7
SFD = 0xD5  # 3.2.2, start frame delimiter
FCS_SIZE = 4  # 3.2.9
MIN_SIZE = 64  # 4.4.2, minFrameSize of 512 bits
MAX_SIZE = 1518  # 4.4.2, maxBasicFrameSize
GAP_SIZE = 12  # 4.4.2, interPacketGap of 96 bits
