"""What the mROS paper published, on other hardware: not comparable with ours in absolute terms.

Section 5.4, Tables 1 to 3: the mean of 200 messages in microseconds, of an echo node on a board (Cortex-A9, 400 MHz) and a
laptop, over Ethernet (rosserial: a serial line of 115,200 bit/s). Section 5.5, Table 4: bytes of the echo node with its
system. Section 5.6, Table 5: lines added, changed and deleted at the edge and at the host.
"""

from __future__ import annotations

MARK = "other hardware, published"
SIZES = tuple(1 << power for power in range(16))
COORDINATE = "coordinate"

_OLD = (1149.32, 1059.83, 1181.51, 1196.54, 1184.94, 1123.38, 1173.78, 1159.18, 1178.44, 1245.17)
_OLD_LARGE = (1395.18, 2085.42, 2547.91, 3797.71, 5962.55, 13409.56)
_NEW = (1029.19, 1043.86, 1075.62, 1044.64, 1023.44, 1051.23, 1076.88, 1087.85, 1114.79, 1170.59)
_NEW_LARGE = (1318.13, 1913.39, 2379.44, 3539.96, 5599.99, 15983.26)
_SERIAL = (9133.36, 9121.31, 9387.14, 9575.56, 10031.84, 11615.23, 14237.36, 19861.96, 30803.89, 30878.46)


def _row(values: tuple[float, ...], point: float) -> dict[str, float]:
    return {**{str(size): value for size, value in zip(SIZES, values, strict=False)}, COORDINATE: point}


# rosserial takes no message of 1,024 bytes or more.
MEANS = {
    "rosserial": _row(_SERIAL, 11572.43),
    "mROS, before": _row(_OLD + _OLD_LARGE, 1597.27),
    "mROS, the paper's": _row(_NEW + _NEW_LARGE, 995.46),
}

# text, data, bss
PROGRAM_BYTES = {
    "rosserial": (125860, 2660, 63012),
    "mROS, before": (427684, 2964, 4693728),
    "mROS, the paper's": (418500, 2932, 3645156),
}

# added, changed, deleted at the edge; the same at the host
PORTING = {
    ("rosserial", "publisher"): ((1, 6, 1), (0, 0, 0)),
    ("rosserial", "subscriber"): ((3, 4, 1), (0, 0, 0)),
    ("mROS, before", "publisher"): ((19, 3, 0), (2, 1, 0)),
    ("mROS, before", "subscriber"): ((13, 1, 0), (2, 1, 0)),
    ("mROS, the paper's", "publisher"): ((2, 2, 0), (0, 0, 0)),
    ("mROS, the paper's", "subscriber"): ((2, 2, 0), (0, 0, 0)),
}
