"""Reads ARP messages. RFC 826."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Module, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.compare import above
from roslet.gateware.ethernet import GROUP_BIT
from roslet.gateware.meta import ADDRESSES, ETHERNET_RX
from roslet.gateware.octets import octets, pick
from roslet.gateware.stream import FrameSignature
from roslet.wire.net import arp, ethernet

MESSAGE = data.StructLayout({"mac": 48, "ip": 32, "probe": 1, "for_us": 1, "request": 1})
"""Who sent a message; whether it has no address yet, its `ip` being 0 (a probe of RFC 5227, 1.1); whether the message is
about our address; whether it asks."""

FIXED = arp.FIELDS[:5]
"""What comes before the addresses: hardware and protocol types and sizes, and the operation."""

FIXED_SIZE = sum(field.bits // 8 for field in FIXED)
MAC_SIZE, IP_SIZE = 6, 4
SENDER_SIZE = MAC_SIZE + IP_SIZE
"""Octets of the sender's addresses; the target's are alike."""

_BEGIN = SENDER_SIZE - FIXED_SIZE
"""Octets are counted so that what is before the addresses ends with the same number as each ten of these."""

CONSTANTS = {
    "hardware": arp.ETHERNET,
    "protocol": ethernet.IPV4,
    "hardware_size": MAC_SIZE,
    "protocol_size": IP_SIZE,
    "operation": 0,
}
"""Of which the last octet, of the operation, is the one that differs."""


def fixed() -> list[int]:
    """The octets before the addresses."""
    return list(b"".join(CONSTANTS[field.name].to_bytes(field.bits // 8, "big") for field in FIXED))


class ArpRx(wiring.Component):
    """Reads messages for IPv4 over Ethernet, and shows the last one.

    Ports: `i`, messages, with any padding; `message`, and `seen`, high for one cycle when a message has ended well and is
    what `message` shows. That stays until `overwritten` is high, in the cycle in which the sender's address of another one
    comes; where `hold` is high then, the other one is dropped instead. So it stays for 8 cycles at least. With `take` the
    octet at `i` is number `place` of the ten of `message.mac` and `message.ip`, from `overwritten` on.

    `i` is always ready: an octet each cycle. A message is seen one cycle after its end.

    Dropped, and counted where they end well: `drop_arp`: other hardware or protocol types, or sizes of addresses, than
    Ethernet's and IPv4's; another operation than request and reply; a sender whose hardware address is a group's, or whose
    IP address is ours (a conflict, or a spoof: RFC 5227, 2.4); a message that is cut off. `drop_busy`: `hold` was high.
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "i": In(FrameSignature(ETHERNET_RX)),
                "addresses": In(ADDRESSES),
                "hold": In(1),
                "overwritten": Out(1),
                "take": Out(1),
                "place": Out(range(SENDER_SIZE), init=_BEGIN),
                "seen": Out(1),
                "message": Out(MESSAGE),
                "drop_arp": Out(1),
                "drop_busy": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i = self.i.stream
        octet, end = i.payload.data, i.payload.end
        ended = i.valid & end & ~i.payload.bad
        message = self.message
        sender = Cat(message.mac, message.ip)
        at = self.place  # within the state's octets
        in_ip = above(at[:4], MAC_SIZE - 1)
        first = at == MAC_SIZE
        last = at == SENDER_SIZE - 1
        own = pick(octets(Value.cast(self.addresses.ip)), at[:2] ^ MAC_SIZE % IP_SIZE)
        same = Signal()  # as our address, until here
        same_now = (octet == own) & (same | first)
        busy = Signal()  # why the message is dropped
        constants = fixed()
        constant = pick([Const(constants[(n - _BEGIN) % FIXED_SIZE], 8) for n in range(8)], at[:3])
        m.d.comb += i.ready.eq(1)

        with m.If(self.take):
            m.d.sync += sender.eq(Cat(sender[8:], octet))

        with m.If(i.valid):
            m.d.sync += [at.eq(at + 1), same.eq(same_now)]
            with m.If(last):
                m.d.sync += at.eq(0)
            with m.If(end):
                m.d.sync += at.eq(_BEGIN)
        with m.FSM() as fsm:
            with m.State("FIXED"), m.If(i.valid & ~end):
                with m.If(last):
                    m.d.sync += message.request.eq(octet == arp.REQUEST)
                    m.next = "SENDER"
                    with m.If((octet != arp.REQUEST) & (octet != arp.REPLY)):
                        m.next = "DROP"
                with m.Elif(octet != constant):
                    m.next = "DROP"
            with m.State("SENDER"), m.If(i.valid):
                with m.If(end):
                    m.next = "FIXED"
                with m.Elif((at == 0) & (self.hold | octet[GROUP_BIT])):
                    m.d.sync += busy.eq(self.hold)
                    m.next = "DROP"
                with m.Else():
                    m.d.comb += [self.take.eq(1), self.overwritten.eq(at == 0)]
                    with m.If(in_ip):
                        m.d.sync += message.probe.eq((octet == 0) & (message.probe | first))
                    with m.If(last):
                        m.next = "TARGET"
                        with m.If(same_now):
                            m.next = "DROP"
            with m.State("TARGET"), m.If(i.valid):
                with m.If(end):
                    m.next = "FIXED"
                with m.Elif(last):
                    m.d.sync += message.for_us.eq(same_now)
                    m.next = "PADDING"
            for state in ("PADDING", "DROP"):
                with m.State(state), m.If(i.valid & end):
                    m.next = "FIXED"
        good = fsm.ongoing("PADDING")
        m.d.sync += self.seen.eq(ended & good)
        m.d.comb += [self.drop_arp.eq(ended & ~good & ~busy), self.drop_busy.eq(ended & busy)]
        with m.If(fsm.ongoing("FIXED")):
            m.d.sync += busy.eq(0)
        return m
