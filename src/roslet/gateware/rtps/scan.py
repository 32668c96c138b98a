"""Looking for an endpoint of a peer among those that match ours."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Module, Signal, Value

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.tables import PeerMap


def find_endpoint(
    m: Module,
    peers: PeerMap,
    port: Any,
    matched: Value,
    key: Value,
    slot: Value,
    writer: Value,
    endpoint: Value,
    info: Value,
    found: Value,
    then: str,
) -> None:
    """The states SCAN and CHECK of an FSM: find participant `slot`'s writer, or reader, with entity id `key`, among those
    in `matched`, by the read port `port`.

    In state `then`, `found` says whether it is there; if so, it is `endpoint`, and `info` is its INFO. `found` must be low
    before. Takes one cycle for each endpoint, and one more for each with an equal id.
    """
    many = peers.endpoints
    step = Signal(range(many + 2))
    shown = Signal(range(many))  # whose word the memory gives
    with m.State("SCAN"):
        m.d.comb += port.addr.eq(peers.endpoint(step, tables.KEY))
        m.d.sync += [step.eq(step + 1), shown.eq(step)]
        with m.If(step == many + 1):
            m.d.sync += step.eq(0)
            m.next = then
        with m.Elif((step != 0) & (port.data == key) & matched.bit_select(shown, 1)):
            m.d.comb += port.addr.eq(peers.endpoint(shown, tables.INFO))
            m.d.sync += [endpoint.eq(shown), step.eq(step)]
            m.next = "CHECK"
    with m.State("CHECK"):
        m.d.sync += info.eq(port.data)
        m.d.comb += port.addr.eq(peers.endpoint(step, tables.KEY))
        m.d.sync += [step.eq(step + 1), shown.eq(step)]
        m.next = "SCAN"
        with m.If(
            (port.data[tables.INFO_SLOT : tables.INFO_SLOT + 8] == slot)
            & (port.data[tables.INFO_WRITER] == writer)
        ):
            m.d.sync += [found.eq(1), step.eq(0)]
            m.next = then
