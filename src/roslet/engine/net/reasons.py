"""What each counted reason of a host means: names in `Host.counters`. Nothing that comes is dropped without one."""

REASONS = {
    # Ethernet
    "ethernet-truncated": "a frame shorter than a header",
    "ethernet-without-type": "a frame with a length where Ethernet II has a type",
    "ethernet-type-unknown": "a frame that holds neither IPv4 nor ARP",
    "ethernet-not-for-us": "a frame to another host, or to a group that is not joined",
    "ethernet-source-a-group": "a frame that says to come from a group address",
    # SLIP
    "slip-escape": "a packet with an ESC that neither ESC_END nor ESC_ESC follows",
    "slip-too-long": "a packet longer than the line's MTU, or octets without END",
    # ARP
    "arp-truncated": "ARP shorter than 28 octets",
    "arp-not-ipv4": "ARP for something else than IPv4 over Ethernet",
    "arp-operation-unknown": "ARP that is neither request nor reply",
    "arp-sender-a-group": "ARP in the name of a group",
    "arp-from-ourselves": "ARP with our hardware address, which somebody sent back",
    "arp-conflict": "ARP of another who says to have our address",
    "arp-from-another-network": "ARP of an address that is not of our network",
    "arp-waiting-full": "a packet beyond those that wait for a hardware address",
    "arp-unanswered": "a packet to an address that nobody has, or that had to make room",
    "neighbours-full": "a neighbour that made room for another",
    # IPv4
    "ipv4-truncated": "a packet shorter than a header",
    "ipv4-version": "a packet of another version",
    "ipv4-header-length": "a header of fewer than 20 octets",
    "ipv4-total-length": "a packet that says it is shorter than its header, or longer than its frame",
    "ipv4-checksum": "a wrong checksum",
    "ipv4-fragment-length": "a fragment, not the last, of no multiple of 8 octets, or of none",
    "ipv4-fragment-beyond-end": "a fragment that ends beyond octet 65,535",
    "ipv4-not-for-us": "a packet to another address, or to a group that is not joined",
    "ipv4-source-a-group": "a packet that says to come from many",
    "ipv4-protocol-unknown": "a packet of no protocol that is spoken here",
    "no-way": "a packet for another network, without a gateway",
    # fragments
    "fragment-repeated": "a fragment that was there already",
    "fragment-overlaps": "a fragment over another: its datagram is dropped",
    "fragment-beyond-last": "a fragment that ends behind the last one, or a second last one: its datagram is dropped",
    "fragments-full": "a datagram of more fragments than are taken",
    "datagram-too-long": "a datagram that no header could describe",
    "assemblies-full": "the oldest incomplete datagram made room for a newer one",
    "assembly-bytes-full": "a datagram in fragments for which there is no room",
    "assembly-expired": "a datagram of which not all fragments came in time",
    # ICMP
    "icmp-truncated": "ICMP shorter than 8 octets",
    "icmp-checksum": "a wrong checksum",
    "icmp-not-echo": "ICMP that is no echo",
    "icmp-to-a-group": "an echo request to many",
    "icmp-reply-unasked": "a reply that no request waits for",
    # IGMP
    "igmp-truncated": "IGMP shorter than 8 octets",
    "igmp-checksum": "a wrong checksum",
    "igmp-type-unknown": "IGMP that is neither query nor report nor leave",
    # UDP
    "udp-truncated": "UDP shorter than a header",
    "udp-length": "a datagram that says it is shorter than its header, or longer than its packet",
    "udp-checksum": "a wrong checksum",
    "udp-port-closed": "a datagram to a port that nobody has opened, or that has not joined the group",
    "datagrams-full": "a datagram beyond those that an endpoint holds",
    "received-bytes-full": "the same, by octets",
    # what goes to the owner and the wire
    "frames-full": "a frame beyond those that wait to be sent",
    "events-full": "an event that its owner did not take in time",
}
