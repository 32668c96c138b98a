"""ARP for IPv4 over Ethernet. RFC 826."""

from roslet.wire.fields import OCTETS, Field

FIELDS = (
    Field("hardware", 0, 16),
    Field("protocol", 2, 16),
    Field("hardware_size", 4, 8),
    Field("protocol_size", 5, 8),
    Field("operation", 6, 16),
    Field("sender_mac", 8, 48, OCTETS),
    Field("sender_ip", 14, 32, OCTETS),
    Field("target_mac", 18, 48, OCTETS),
    Field("target_ip", 24, 32, OCTETS),
)
SIZE = 28
ETHERNET = 1
REQUEST, REPLY = 1, 2
