"""What a writer knows of one matched reader. RTPS 2.3, 8.4.7.5."""

from roslet.engine.rtps.outbox import WHOLE
from roslet.wire.rtps import info_dst

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.rtps.outbox import Address
    from roslet.wire.rtps.data import Preface
    from roslet.wire.rtps.endpoint_data import EndpointData


class ReaderProxy:
    """A matched remote reader. `acked`: it has every sample up to this number; `vendor`: that of its participant; `late`:
    whether it gets what was written before it came."""

    __slots__ = (
        "acked",
        "addresses",
        "count",
        "data",
        "frag_count",
        "guid",
        "info_dst",
        "late",
        "next_preface",
        "parts",
        "preface",
        "reliable",
        "resent",
        "sent",
        "start",
        "vendor",
    )

    def __init__(
        self,
        remote: "EndpointData",
        addresses: "tuple[Address, ...]",
        start: int,
        reliable: bool,
        vendor: bytes,
        late: bool,
    ) -> None:
        self.data = remote
        self.guid = remote.guid
        self.addresses = addresses
        self.reliable = reliable
        self.vendor = vendor
        self.late = late
        self.start = start  # samples before this one are not for it
        self.acked = start - 1
        self.sent = start - 1  # up to here it was told of every number, where some were for others
        self.count = -1
        self.frag_count = -1
        self.info_dst = bytes(info_dst.InfoDestination(remote.guid[:12]).emit())
        self.preface: Preface | None = None  # of a datagram with one sample for it
        self.next_preface: Preface | None = None  # of one more sample in a datagram
        self.resent: dict[int, float] = {}
        self.parts = (
            0,
            0,
        )  # the sample that it is putting together, and the fragments of it that it has or knows to be lost

    @property
    def progress(self) -> "tuple[int, int]":
        """The sample, and the fragments of it, up to which everything has reached it."""
        return max((self.acked, WHOLE), self.parts)


def addresses_for_all(proxies: "list[ReaderProxy]") -> "tuple[Address, ...]":
    """Where a sample goes that is for all of them, each address once.

    Readers that announce the same multicast locator are reached by one datagram there, if they would take more by unicast.
    """
    groups: dict[Address, list[ReaderProxy]] = {}
    for proxy in proxies:
        for one in proxy.data.multicast:
            if one.usable and one.multicast:
                groups.setdefault((one.host, one.port), []).append(proxy)
                break
    reached: set[bytes] = set()
    found: dict[Address, bool] = {}
    order: list[Address] = []
    for group in sorted(groups):
        together = groups[group]
        if len({address for proxy in together for address in proxy.addresses}) > 1:
            reached.update([proxy.guid for proxy in together])
            found[group] = True
            order.append(group)
    for proxy in proxies:
        if proxy.guid in reached:
            continue
        for address in proxy.addresses:
            if address not in found:
                found[address] = True
                order.append(address)
    return tuple(order)
