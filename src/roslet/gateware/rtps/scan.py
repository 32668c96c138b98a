"""Looking for one among several: an endpoint of a peer among those that match ours, a bit among bits."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.tables import PeerMap


def find_endpoint(
    m: Module,
    peers: PeerMap,
    address: Value,
    given: Value,
    matched: Value,
    key: Value,
    slot: Value,
    writer: Value,
    endpoint: Value,
    info: Value,
    found: Value,
    then: str,
    same: Value | None = None,
) -> None:
    """The states from SCAN to CHECK of an FSM: find participant `slot`'s writer, or reader, with entity id `key`, among
    those in `matched`, by `address` and `given` of a read port.

    In state `then`, `found` says whether it is there; if so, it is `endpoint`, and `info` is its INFO. `found` and
    `endpoint` must be zero before. Takes one cycle for each endpoint, and three more for each of those in `matched`. `same`,
    where somebody compares `given` with `key` anyway: whether they were equal a cycle before.
    """
    last = endpoint == peers.endpoints - 1
    if same is None:
        same = Signal()
        m.d.sync += same.eq(given == key)
    with m.State("SCAN"):
        m.d.comb += address.eq(peers.endpoint(endpoint, tables.KEY))
        with m.If(matched.bit_select(endpoint, 1)):
            m.next = "ITS INFO"
        with m.Elif(last):
            m.next = then
        with m.Else():
            m.d.sync += endpoint.eq(endpoint + 1)
    with m.State("ITS INFO"):
        m.d.comb += address.eq(peers.endpoint(endpoint, tables.INFO))
        m.next = "ITS KEY"
    with m.State("ITS KEY"):
        m.next = "CHECK"
    with m.State("CHECK"):
        its_slot, is_writer = given[tables.INFO_SLOT : tables.INFO_SLOT + 8], given[tables.INFO_WRITER]
        ours = same & (its_slot == slot) & (is_writer == writer)
        m.d.sync += [info.eq(given), found.eq(ours)]
        with m.If(ours | last):
            m.next = then
        with m.Else():
            m.d.sync += endpoint.eq(endpoint + 1)
            m.next = "SCAN"


def lowest(bits: Value) -> Value:
    """The number of the lowest bit that is high; of none, 0. Halves are judged side by side: no chain of all bits."""
    if len(bits) == 1:
        return C(0, 1)
    half = 1 << ((len(bits) - 1).bit_length() - 1)
    below, above = bits[:half], bits[half:]
    number = Mux(below.any(), lowest(below), lowest(above))
    return Cat(number[: (half - 1).bit_length()], ~below.any() & above.any())
