"""UDP over a serial line: in place of a MAC and `stack.UdpStack`, for one peer, without Ethernet and ARP."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware import multicast
from roslet.gateware.drops import drop_outputs
from roslet.gateware.icmp import MAX_DATA
from roslet.gateware.ip_stack import IpStack
from roslet.gateware.ipv4_tx import LONGEST
from roslet.gateware.meta import ADDRESSES, LookupSignature
from roslet.gateware.octets import octets, pick
from roslet.gateware.stream import FrameSignature
from roslet.gateware.wires import expose
from roslet.wire.net import ethernet, ipv4, udp

_DESTINATION = next(field.offset for field in ipv4.FIELDS if field.name == "destination")


class GroupFilter(wiring.Component):
    """Lets packets pass but for those to multicast groups that are not joined. RFC 1122, 3.3.6.

    Ports: `i` and `o`, IPv4 packets; `groups`, of which there are `count`; 224.0.0.1 is always one of them.

    An octet passes in the cycle in which it comes; the destination is compared meanwhile, and a packet that is not wanted
    ends badly. `drop_group` is high for one cycle if its end was good.
    """

    def __init__(self, count: int) -> None:
        super().__init__(
            {
                "i": In(FrameSignature()),
                "o": Out(FrameSignature()),
                "groups": In(multicast.groups(count)),
                "drop_group": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        octet = i.payload.data
        behind = _DESTINATION + 4
        at = Signal(range(behind + 1))
        moved, comparing, to_group = Signal(), Signal(), Signal()
        m.d.comb += [
            moved.eq(i.valid & i.ready),
            comparing.eq(moved & ~i.payload.end & (at[2:] == _DESTINATION // 4)),
        ]
        with m.If(moved & i.payload.end):
            m.d.sync += [at.eq(0), to_group.eq(0)]
        with m.Elif(moved & (at != behind)):
            m.d.sync += at.eq(at + 1)

        with m.If(comparing & (at == _DESTINATION)):
            m.d.sync += to_group.eq(multicast.is_multicast(octet))
        wanted: list[tuple[Any, Any]] = [(1, list(multicast.ALL_HOSTS))]
        for group in self.groups:
            wanted.append((group.valid, octets(Value.cast(group.ip))))
        joined = Signal(len(wanted))
        for bit, (valid, address) in zip(joined, wanted, strict=True):
            with m.If(comparing):
                first = at == _DESTINATION
                m.d.sync += bit.eq(
                    (octet == pick([Value.cast(one) for one in address], at[:2]))
                    & ((first & valid) | (~first & bit))
                )
        unwanted = Signal()
        m.d.comb += [
            unwanted.eq(to_group & ~joined.any() & i.payload.end),
            o.payload.eq(i.payload),
            o.payload.bad.eq(i.payload.bad | unwanted),
            o.valid.eq(i.valid),
            i.ready.eq(o.ready),
            self.drop_group.eq(moved & unwanted & ~i.payload.bad),
        ]
        return m


class SlipStack(wiring.Component):
    """UDP over IPv4 over a line to one peer, with ICMP echo and reassembly: upward as `stack.UdpStack`.

    groups      how many multicast groups may be joined
    askers      how many ask for hardware addresses
    the others  as `IpStack` has them

    Ports: `rx` and `tx`, IP packets from and to a link, such as `slip.SlipLink`; `udp_rx`, `udp_tx`, `addresses`, `groups`,
    `expiration`, `ip_payloadsmem` as `UdpStack` has them, of `addresses` neither `mac` nor `gateway`: everything goes to the
    other end, whatever its address. So `lookup0 ..` are answered in the next cycle, always with `found` and a `mac` of
    zeros, and `mac` stands in `udp_rx` too. There is no switch that would have to hear of groups: IGMP is neither spoken nor
    taken.

    Drops are `UdpStack`'s of IPv4 and above, and `drop_groups_group` (see `GroupFilter`).
    """

    def __init__(
        self,
        groups: int = 0,
        askers: int = 1,
        echo_data: int | None = MAX_DATA,
        pendings: int = 1,
        fragments: int = 2,
        fragment_size: int = 1480,
        mtu: int = ethernet.MTU,
        longest: int = LONGEST - udp.SIZE,
        registers: bool = True,
    ) -> None:
        if mtu > ethernet.MTU:
            raise ValueError(f"a packet has {ethernet.MTU} octets at most, not {mtu}")
        self._askers = askers
        self._groups = GroupFilter(groups)
        self._ip = ip = IpStack(
            echo_data, pendings, fragments, fragment_size, mtu, False, longest, registers, hop=False
        )
        self._drops = drop_outputs({"groups": self._groups})
        self._ip_drops = [name for name in ip.signature.members if name.startswith("drop_")]
        members = ip.signature.members
        super().__init__(
            {
                "rx": In(FrameSignature()),
                "tx": Out(FrameSignature()),
                **{name: members[name] for name in ("udp_rx", "udp_tx")},
                **{f"lookup{n}": In(LookupSignature()) for n in range(askers)},
                "addresses": In(ADDRESSES),
                "groups": In(multicast.groups(groups)),
                **ip.memory,
                **{name: Out(1) for name in (*self._drops, *self._ip_drops)},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.ip = ip = self._ip
        m.submodules.filter = groups = self._groups
        connect(m, flipped(self.rx), groups.i)
        connect(m, groups.o.stream, ip.rx.stream)
        connect(m, ip.tx.stream, flipped(self.tx).stream)
        connect(m, flipped(self.udp_tx), ip.udp_tx)
        connect(m, ip.udp_rx, flipped(self.udp_rx))
        expose(m, ip, self, ip.memory)
        m.d.comb += [
            ip.rx.meta.eq(0),
            ip.addresses.eq(self.addresses),
            groups.groups.eq(self.groups),
        ]
        for name, (_, output) in self._drops.items():
            m.d.comb += getattr(self, name).eq(getattr(groups, output))
        m.d.comb += [getattr(self, name).eq(getattr(ip, name)) for name in self._ip_drops]
        for n in range(self._askers):
            lookup = getattr(self, f"lookup{n}")
            m.d.comb += lookup.found.eq(lookup.done)
            m.d.sync += lookup.done.eq(lookup.valid & ~lookup.done)
        return m
