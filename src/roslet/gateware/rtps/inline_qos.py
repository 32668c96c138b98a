"""Inline QoS of DATA, and what lies before it. RTPS 2.3, 9.4.5.3 (octets), 9.6.3 (KEY_HASH, STATUS_INFO)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value

from roslet.gateware.rtps import tables
from roslet.wire.rtps import data as data_submessage
from roslet.wire.rtps.inline_qos import STATUS_DISPOSED, STATUS_UNREGISTERED
from roslet.wire.rtps.parameter_list import PID_KEY_HASH, PID_SENTINEL, PID_STATUS_INFO


def skip_inline_qos(
    m: Module,
    i: Any,
    meta: Any,
    keep: Any,
    take: Callable[[str], None],
    gone: Value,
    has_key: Value,
    skip: Value,
    odd: Value,
) -> tuple[Value, Value]:
    """The states SKIP and QOS of an FSM: take `skip` words from stream `i`, and one more if `odd`; then inline QoS, if the
    flags in `meta` say that there is some. In state COMPARE that is over. `take` takes a word and goes on.

    `gone` is as STATUS_INFO says, and KEY_HASH is in the scratch area, by `keep`, where `has_key` says so. These, `odd`, and
    what is given back must be zero before.
    """
    word, little = i.payload.data, meta.flags[0]
    came = i.valid & ~i.payload.end
    pid = Mux(little, word[:16], Cat(word[8:16], word[:8]))
    length = Mux(little, word[16:32], Cat(word[24:32], word[16:24]))
    is_status, is_key = Signal(), Signal()
    with m.State("SKIP"):
        with m.If((skip == 0) & ~odd):
            m.next = "COMPARE"
            with m.If((meta.flags & data_submessage.FLAG_Q).any()):
                m.next = "QOS"
        with m.Else():
            take("SKIP")
            with m.If(came):
                m.d.sync += [is_status.eq(0), has_key.eq(has_key | is_key), odd.eq(0)]
                with m.If(odd):
                    m.d.sync += skip.eq(skip)
                with m.If(is_status):  # four octets, whose last has the flags, in whatever byte order
                    m.d.sync += gone.eq((word[24:32] & (STATUS_DISPOSED | STATUS_UNREGISTERED)).any())
                with m.If(is_key):
                    m.d.comb += [keep.en.eq(1), keep.word.eq(Cat((-skip)[:2], C(tables.SCRATCH_KEY >> 2, 2)))]
    with m.State("QOS"):
        take("SKIP")
        m.d.sync += [
            is_status.eq((pid == PID_STATUS_INFO) & (length[:2] == 0)),
            is_key.eq((pid == PID_KEY_HASH) & (length == 16)),
            skip.eq(length[2:]),
            odd.eq(length[:2] != 0),
        ]
        with m.If(came & (pid == PID_SENTINEL)):
            m.next = "COMPARE"
    return is_status, is_key
