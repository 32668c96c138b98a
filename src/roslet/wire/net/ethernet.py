"""The Ethernet II header. IEEE 802.3, 3.1.1.

    0            6       12
    destination  source  type

A frame here has no preamble and no frame check sequence; `MIN_SIZE` counts header and padding.
"""

from roslet.wire.fields import OCTETS, Field

FIELDS = (
    Field("destination", 0, 48, OCTETS),
    Field("source", 6, 48, OCTETS),
    Field("type", 12, 16),
)
SIZE = 14
MIN_SIZE = 60
MTU = 1500
IPV4, ARP = 0x0800, 0x0806
