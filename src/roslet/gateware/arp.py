"""ARP for IPv4 over Ethernet: the node's own address, and everybody else's. RFC 826."""

from __future__ import annotations

from amaranth.hdl import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware.arp_cache import INTERVAL, TRIES, ArpCache
from roslet.gateware.arp_rx import ArpRx
from roslet.gateware.arp_tx import ArpTx
from roslet.gateware.fifo import FrameStage
from roslet.gateware.meta import ADDRESSES, ETHERNET_RX, ETHERNET_TX, LookupSignature
from roslet.gateware.stream import FrameSignature


class Arp(wiring.Component):
    """Answers who has our address, and finds out who has others.

    Ports: `i`, messages that came, `o`, those to be sent (without padding, without a pause within a message); `lookup`,
    questions for hardware addresses (see `ArpCache`, whose parameters are `cache_width` and `resolving`); `addresses`, ours,
    steady while `enable` is high.

    Three ports of the manual, and what they mean here where it leaves a choice: `retry_count` is how many requests are sent
    in all for one address, one at least; `retry_interval` is the time from one to the next, and from the last to giving up,
    in cycles; `timeout` is how long an address is remembered after it was last learned, in cycles.

    When `enable` rises our address is announced, once. Before, messages are ignored and questions have `failed`.

    What is learned: an address that is in the cache follows any message of its owner, be it a reply, an announcement or a
    request for somebody else, as in RFC 826. Other addresses are remembered only if they ask for ours and there is room,
    never from a reply that was not asked for; a probe (from 0.0.0.0) is answered and not remembered.

    `i` is always ready, an octet each cycle, one message after another. A message is learned from and then answered, which
    begins up to 130 cycles after its end, with 16 entries. One reply is being sent and one waits; when the next message
    comes, that which waits is given up: `drop_busy`. So is a message that comes so soon that the one before it is still
    being learned from. Replies and requests are sent in turn. `drop_arp`: see `ArpRx`.
    """

    def __init__(self, cache_width: int = 4, resolving: int | None = None) -> None:
        self._cache = ArpCache(cache_width, resolving)
        super().__init__(
            {
                "i": In(FrameSignature(ETHERNET_RX)),
                "o": Out(FrameSignature(ETHERNET_TX)),
                "lookup": In(LookupSignature()),
                "addresses": In(ADDRESSES),
                "enable": In(1),
                "retry_count": In(TRIES),
                "retry_interval": In(INTERVAL),
                "timeout": In(INTERVAL),
                "drop_arp": Out(1),
                "drop_busy": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.rx = rx = ArpRx()
        m.submodules.cache = cache = self._cache
        m.submodules.tx = tx = ArpTx()
        connect(m, flipped(self.i), rx.i)
        connect(m, flipped(self.lookup), cache.lookup)
        # Between block RAM and whoever chooses whose frame goes out
        m.submodules.register = register = FrameStage(ETHERNET_TX)
        connect(m, tx.o, register.i)
        connect(m, register.o, flipped(self.o))
        message = rx.message
        m.d.comb += [
            rx.addresses.eq(self.addresses),
            cache.addresses.eq(self.addresses),
            tx.addresses.eq(self.addresses),
            cache.enable.eq(self.enable),
            cache.retry_count.eq(self.retry_count),
            cache.retry_interval.eq(self.retry_interval),
            cache.timeout.eq(self.timeout),
            cache.ip.eq(message.ip),
            cache.mac.eq(message.mac),
            cache.create.eq(message.for_us & message.request),
            self.drop_arp.eq(rx.drop_arp),
        ]

        # A message is learned from first, and then answered to the addresses that were written as they came.
        m.d.comb += [
            rx.hold.eq(cache.learn | tx.reply),
            tx.write.eq(rx.take),
            tx.place.eq(rx.place),
            tx.octet.eq(self.i.stream.payload.data),
        ]
        with m.If(cache.learned):
            m.d.sync += cache.learn.eq(0)
        replying = Signal()
        with m.If(rx.seen & self.enable):
            m.d.sync += [cache.learn.eq(~message.probe), replying.eq(message.for_us & message.request)]

        asking, ask_ip = Signal(), Signal(32)
        m.d.comb += cache.ask_ready.eq(~asking & ~tx.requesting)
        with m.If(cache.ask):
            m.d.sync += [asking.eq(1), ask_ip.eq(cache.ask_ip)]

        enabled, announcing = Signal(), Signal()
        m.d.sync += enabled.eq(self.enable)
        with m.If(self.enable & ~enabled):
            m.d.sync += announcing.eq(1)

        replied = Signal()  # the last was a reply
        m.d.comb += tx.ip.eq(ask_ip)
        with m.If(tx.ready):
            with m.If(announcing):
                m.d.comb += tx.announce.eq(1)
                m.d.sync += announcing.eq(0)
            with m.Elif(replying & ~cache.learn & ~(replied & asking)):
                m.d.comb += tx.reply.eq(1)
                m.d.sync += [replying.eq(0), replied.eq(1)]
            with m.Elif(asking):
                m.d.comb += tx.request.eq(1)
                m.d.sync += [asking.eq(0), replied.eq(0)]
        with m.If(rx.overwritten):
            m.d.sync += replying.eq(0)
        m.d.comb += self.drop_busy.eq(rx.drop_busy | (rx.overwritten & replying))
        return m
