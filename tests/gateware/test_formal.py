"""What the proofs say, and that they would say otherwise of a wrong block."""

from __future__ import annotations

import pytest

from gateware import formal
from gateware.formal import Spec
from gateware.proofs import arbiter, checksum, fifo, header, mac, raw_udp, reassembly, rtps

SPECS = (
    *arbiter.SPECS,
    *header.SPECS,
    *checksum.SPECS,
    *fifo.SPECS,
    *mac.SPECS,
    *raw_udp.SPECS,
    *reassembly.SPECS,
    *rtps.SPECS,
)


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.__name__)
def test_the_properties_hold(spec: type[Spec]) -> None:
    formal.prove(spec())


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.__name__)
def test_what_is_assumed_leaves_the_ordinary_possible(spec: type[Spec]) -> None:
    formal.prove(spec(), mode="cover")


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.__name__)
def test_every_property_fails_for_a_planted_bug(spec: type[Spec]) -> None:
    wrong = [spec(bug) for bug in spec.bugs]
    verdicts = formal.judge(wrong, spec.quick, keep_going=True)
    for bug, verdict in zip(spec.bugs, verdicts, strict=True):
        assert bug.property in verdict.failed, f"{bug} is caught by {verdict.failed or 'nothing'}"
    assert {bug.property for bug in spec.bugs} == verdicts[0].properties
