"""What the proofs say, and that they would say otherwise of a wrong block."""

from __future__ import annotations

import pytest

from gateware import formal
from gateware.formal import Spec
from gateware.proofs import (
    app_data,
    arbiter,
    arp_cache,
    checksum,
    discovery,
    fifo,
    header,
    mac,
    raw_udp,
    reassembly,
    rtps,
    slip,
    typed,
)

SPECS = (
    *arbiter.SPECS,
    *arp_cache.SPECS,
    *header.SPECS,
    *checksum.SPECS,
    *fifo.SPECS,
    *mac.SPECS,
    *raw_udp.SPECS,
    *reassembly.SPECS,
    *rtps.SPECS,
    *discovery.SPECS,
    *typed.SPECS,
    *app_data.SPECS,
    *slip.SPECS,
)


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.__name__)
def test_the_properties_hold(spec: type[Spec]) -> None:
    formal.prove(spec())


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.__name__)
def test_what_is_assumed_leaves_the_ordinary_possible(spec: type[Spec]) -> None:
    formal.prove(spec(), mode="cover")


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.__name__)
def test_every_property_fails_for_a_planted_bug(spec: type[Spec]) -> None:
    verdicts = formal.judge([spec(bug) for bug in spec.bugs], spec.quick)
    for bug, verdict in zip(spec.bugs, verdicts, strict=True):
        failed = verdict.failed
        if bug.property not in failed:  # maybe it does later than another
            (verdict,) = formal.judge([spec(bug)], spec.quick, keep_going=True)
            failed = verdict.failed
        assert bug.property in failed, f"{bug} is caught by {failed or 'nothing'}"
    assert {bug.property for bug in spec.bugs} == verdicts[0].properties
