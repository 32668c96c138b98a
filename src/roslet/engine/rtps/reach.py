"""Which of a peer's locators to use: the one that it was heard from, else those on our own networks.

A peer with several interfaces announces an address for each. Most lead nowhere from here: networks of containers, a second
cable, its loopback. A datagram to each of them would multiply the traffic, and some may be somebody else's.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.engine.rtps.outbox import Address
    from roslet.wire.rtps.locator import Locator

    # The address of one of our interfaces, and how many of its bits are the network's.
    Network = tuple[str, int]

# Addresses of one peer that everything is sent to, where none is known to be the right one.
MAX_ADDRESSES = 4


def number(host: str) -> int:
    """A dotted address as an integer of 32 bits. Raises ValueError for other text."""
    value = 0
    for part in host.split("."):
        value = value << 8 | int(part)
    return value


def near(host: str, networks: "tuple[Network, ...]") -> bool:
    """Whether an address is on one of the networks."""
    value = number(host)
    return any((value ^ number(address)) >> (32 - bits) == 0 for address, bits in networks)


def addresses_of(
    locators: "tuple[Locator, ...]", heard_from: str, networks: "tuple[Network, ...]" = ()
) -> "tuple[Address, ...]":
    """Where to send to a peer of these locators that was heard from an address ("" where that is not known).

    The very address, if it is among them. Else, of a peer on this host, one of our own addresses; of another host's those
    on our networks; else the first few. Where our networks are known, the loopback of another host, and what is
    our own address here, are never used.
    """
    usable = [(one.host, one.port) for one in locators if one.usable]
    same = [one for one in usable if one[0] == heard_from]
    if same:
        return tuple(same[:1])
    if networks and heard_from:
        own = [address for address, _ in networks]
        here = [one for one in usable if one[0] in own or one[0].startswith("127.")]
        # 0.0.0.0 is how multicast comes over a loopback without a route.
        if heard_from in own or heard_from.startswith("127.") or heard_from == "0.0.0.0":
            return tuple((here or usable)[:1])
        usable = [one for one in usable if one not in here]
        usable = [one for one in usable if near(one[0], networks)] or usable
    return tuple(usable[:MAX_ADDRESSES])
