"""Hardware, described in Amaranth: stream blocks from MII pins to topics.

Every block is a `wiring.Component` whose docstring is a contract. Here `wire` (field tables) and `layout` may be imported,
and nothing of `engine io node`: a node in gates is judged by them, and shares no code with them but the tables.

Words used in every block:

- *Streams of frames*, octet by octet (`stream.FrameSignature`), run between blocks; what is known of the frame that is
  passing runs beside it as `meta`.
- Addresses are kept in the order of the wire, the first octet in the lowest bits, as the ports `mac_addr` and `ip_addr` have
  them. Numbers (ports, lengths, types) are numbers.
- What is dropped is dropped whole, in a state named DROP, for a named reason: an output `drop_<reason>` is high for one
  cycle.
- The core clock domain is `sync`; a MAC adds `phy_rx` and `phy_tx`.
"""
