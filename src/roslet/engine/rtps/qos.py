"""Do the policies of a writer and a reader go together? DDS 1.4, 2.2.3 (RxO), DDS-XTypes 1.3, 7.6.3.1 (representation)."""

from roslet.wire.rtps import qos as policies

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.wire.rtps.qos import Qos


def matches_pattern(text: str, pattern: str) -> bool:
    """Whether `text` is what the pattern of `*` and `?` says; work is bounded by the product of their lengths."""
    at = here = 0
    star = back = -1
    while at < len(text):
        if here < len(pattern) and pattern[here] == "*":
            star, back = here, at
            here += 1
        elif here < len(pattern) and (pattern[here] == "?" or pattern[here] == text[at]):
            here += 1
            at += 1
        elif star >= 0:
            back += 1
            at = back
            here = star + 1
        else:
            return False
    while here < len(pattern) and pattern[here] == "*":
        here += 1
    return here == len(pattern)


def _share_a_partition(one: "tuple[str, ...]", other: "tuple[str, ...]") -> bool:
    for first in one or ("",):
        for second in other or ("",):
            if first == second:
                return True
            wild = "*" in first or "?" in first
            if wild and ("*" in second or "?" in second):
                continue
            if matches_pattern(second, first) if wild else matches_pattern(first, second):
                return True
    return False


def incompatible(offered: "Qos", requested: "Qos") -> "tuple[str, ...]":
    """The names of the policies in which a writer does not offer what a reader requests; empty: they match."""
    found = []
    if offered.reliability[0] < requested.reliability[0]:
        found.append("reliability")
    if offered.durability < requested.durability:
        found.append("durability")
    if offered.deadline > requested.deadline:
        found.append("deadline")
    if offered.latency_budget > requested.latency_budget:
        found.append("latency_budget")
    if offered.liveliness[0] < requested.liveliness[0] or offered.liveliness[1] > requested.liveliness[1]:
        found.append("liveliness")
    if offered.ownership != requested.ownership:
        found.append("ownership")
    if offered.destination_order < requested.destination_order:
        found.append("destination_order")
    give, want = offered.presentation, requested.presentation
    if give[0] < want[0] or (want[1] and not give[1]) or (want[2] and not give[2]):
        found.append("presentation")
    if not _share_a_partition(offered.partition, requested.partition):
        found.append("partition")
    writes = offered.representation[0] if offered.representation else policies.XCDR1
    if writes not in (requested.representation or (policies.XCDR1,)):
        found.append("representation")
    return tuple(found)
