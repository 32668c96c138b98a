"""Invariant: any bytes are a call, a response or a fault that reads the same when written again, or are refused
with a ProtocolError of a known reason.

    python fuzz/fuzz_xmlrpc.py [libFuzzer options] [corpus]     coverage-guided; needs atheris
    python fuzz/fuzz_xmlrpc.py --smoke N                        N seeded random inputs; needs nothing
"""

from __future__ import annotations

import pathlib
import random
import re
import sys
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from roslet.errors import Fault, ProtocolError
from roslet.wire import xmlrpc

_DESCRIBED = re.search(r"these reasons:\n\n(.*?)\n\n", xmlrpc.__doc__ or "", re.DOTALL)
REASONS = frozenset(_DESCRIBED.group(1).split() if _DESCRIBED else ())

# What the smoke mode strings together; a coverage-guided fuzzer finds these by itself.
PIECES = (
    b"<methodCall> <methodName> m </methodName> </methodCall> <methodResponse> </methodResponse> <fault> </fault> "
    b"<params> <param> </param> </params> <value> </value> <int> </int> <i4> </i4> <i8> <double> </double> <string> "
    b"</string> <boolean> </boolean> <base64> </base64> <dateTime.iso8601> <array> <data> </data> </array> <struct> "
    b"<member> <name> </name> </member> </struct> <value/> <nil/> <data/> <params/> <?xml?> <!-- <![CDATA[ &amp; "
    b"&#65; &#x0; & ; < > 1 -5 1e9 AAEC faultCode faultString \r \n \t \xc3\xa9 \xff \0"
).split(b" ")
VALUES: tuple[Any, ...] = (
    None,
    True,
    -5,
    1 << 40,
    0.5,
    "a<&>\xe9",
    b"\0\1",
    [],
    {},
    [1, [2]],
    {"k": {"": [""]}},
)


def check(data: bytes) -> None:
    """Raises if the invariant does not hold."""
    try:
        method, params = xmlrpc.parse_call(data)
        same(xmlrpc.parse_call(xmlrpc.emit_call(method, params)), (method, params))
    except ProtocolError as error:
        known(error)
    try:
        value = xmlrpc.parse_response(data)
        same(xmlrpc.parse_response(xmlrpc.emit_response(value)), value)
    except ProtocolError as error:
        known(error)
    except Fault:
        pass


def known(error: ProtocolError) -> None:
    if error.reason not in REASONS:
        raise AssertionError(
            f"{error.reason!r} is not among the reasons that the module describes"
        ) from error


def same(again: Any, first: Any) -> None:
    # Not ==: a value may be NaN. A bare carriage return arrives as a line feed.
    if repr(again).replace("\\r", "\\n") != repr(first).replace("\\r", "\\n"):
        raise AssertionError(f"{first!r} came back as {again!r}")


def smoke(count: int) -> None:
    """`count` random inputs, always the same: strings of pieces, and good documents with a few bytes changed."""
    source = random.Random(0)
    for _ in range(count):
        if source.randrange(2):
            data = b"".join(source.choice(PIECES) for _ in range(source.randrange(40)))
        else:
            values = [source.choice(VALUES) for _ in range(source.randrange(4))]
            changed = bytearray(
                xmlrpc.emit_call("m", values) if source.randrange(2) else xmlrpc.emit_response(values)
            )
            for _ in range(source.randrange(4)):
                at = source.randrange(len(changed))
                changed[at : at + source.randrange(3)] = source.choice(PIECES)
            data = bytes(changed)
        check(data)
    print(f"{count} inputs, no finding")


def main() -> None:
    """The command."""
    if sys.argv[1:2] == ["--smoke"]:
        smoke(int(sys.argv[2]))
        return
    import atheris

    atheris.instrument_all()
    atheris.Setup(sys.argv, check)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
