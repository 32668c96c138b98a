"""A small host without sockets or clocks: ARP, IPv4, ICMP echo, IGMP, UDP. Runs on MicroPython.

`host.Host` on an Ethernet and `slip_host.SlipHost` on a serial line are what a runtime drives, frame by frame; the other
modules are their parts. Times are float seconds of any monotonic clock. Addresses are text at the edge ("192.168.1.2"),
octets within.
"""
