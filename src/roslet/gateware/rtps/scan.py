"""Looking for one among several: an endpoint of a peer among those that match ours, a bit among bits."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.ports import READ_LATENCY
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
) -> None:
    """The states from SCAN to CHECK of an FSM: find participant `slot`'s writer, or reader, with entity id `key`, among
    those in `matched`, by `address` and `given` of a read port.

    In state `then`, `found` says whether it is there; if so, it is `endpoint`, and `info` is its INFO. `found` must be low
    before. Takes one cycle for each endpoint and three more, and six for each other endpoint with an equal id.
    """
    many = peers.endpoints
    latency = READ_LATENCY + 1  # until it is known whether it is the one
    step = Signal(range(many + latency))
    # Whose word the memory gives next, gives now, and gave before
    addressed, given_of, shown = (Signal(range(many)) for _ in range(3))
    same = Signal()
    reads = Signal(range(latency + 1))  # under way, since the scan began or went on
    m.d.sync += same.eq((given == key) & matched.bit_select(given_of, 1))
    last = shown == many - 1
    with m.State("SCAN"):
        m.d.comb += address.eq(peers.endpoint(step, tables.KEY))
        m.d.sync += [step.eq(step + 1), addressed.eq(step), given_of.eq(addressed), shown.eq(given_of)]
        with m.If(reads != latency):
            m.d.sync += reads.eq(reads + 1)
        with m.Elif(same):
            m.d.sync += [endpoint.eq(shown), step.eq(shown + 1), reads.eq(0), shown.eq(shown)]
            m.next = "INFO"
        with m.Elif(last):
            m.d.sync += [step.eq(0), reads.eq(0)]
            m.next = then
    with m.State("INFO"):
        m.d.comb += address.eq(peers.endpoint(shown, tables.INFO))
        m.next = "INFO COMES"
    with m.State("INFO COMES"):
        m.next = "CHECK"
    with m.State("CHECK"):
        m.d.sync += info.eq(given)
        m.next = "SCAN"
        ours = (given[tables.INFO_SLOT : tables.INFO_SLOT + 8] == slot) & (
            given[tables.INFO_WRITER] == writer
        )
        m.d.sync += found.eq(ours)
        with m.If(ours | last):
            m.d.sync += step.eq(0)
            m.next = then


def lowest(bits: Value) -> Value:
    """The number of the lowest bit that is high; of none, 0. Halves are judged side by side: no chain of all bits."""
    if len(bits) == 1:
        return C(0, 1)
    half = 1 << ((len(bits) - 1).bit_length() - 1)
    below, above = bits[:half], bits[half:]
    number = Mux(below.any(), lowest(below), lowest(above))
    return Cat(number[: (half - 1).bit_length()], ~below.any() & above.any())
