"""Run under MicroPython by test_micropython.py: a generated package against bytes that CPython made.

Arguments: a folder that holds the generated packages `ros1_types` and `ros2_types`, and a file with one JSON line a
case: [dialect, package, kind, class, fields, hex]. Prints the number of cases that agreed.
"""

import json
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def find(dialect: str, package: str, kind: str, name: str) -> "Any":
    module = __import__("%s_types.%s.%s" % (dialect, package, kind), None, None, [name])
    return getattr(module, name)


def fill(kind: "Any", fields: "Any") -> "Any":
    message = kind()
    for position, (name, _text) in enumerate(kind._fields_and_types):
        attribute, base, array = kind._spec[position][:3]
        value = fields[name]
        value = [one(base, element) for element in value] if array else one(base, value)
        setattr(message, attribute, value)
    return message


def one(base: "Any", value: "Any") -> "Any":
    if base == "time" or base == "duration":
        from roslet.wire.time import Duration, Time

        return (Time if base == "time" else Duration)(value["secs"], value["nsecs"])
    return value if isinstance(base, str) else fill(base, value)


def check(dialect: str, package: str, kind_name: str, name: str, fields: "Any", data: str) -> None:
    kind = find(dialect, package, kind_name, name)
    wanted = bytes([int(data[at : at + 2], 16) for at in range(0, len(data), 2)])
    message = fill(kind, fields)
    made = message.serialize()
    if made != wanted:
        raise ValueError("%s: made %r, wanted %r" % (name, made, wanted))
    back = kind.deserialize(wanted)
    if back.serialize() != wanted:
        raise ValueError("%s: read otherwise" % name)
    if not back == message:
        raise ValueError("%s: not equal" % name)
    if message.serialized_size() != len(wanted) or not message.copy() == message:
        raise ValueError("%s: size or copy" % name)
    from roslet.errors import MalformedMessage

    start = 0 if dialect == "ros1" else 4
    for size in range(start, len(wanted), 1 + len(wanted) // 200):
        try:
            kind.deserialize(wanted[:size])
        except MalformedMessage:
            continue
        raise ValueError("%s: took %d of %d bytes" % (name, size, len(wanted)))


def main() -> None:
    sys.path.insert(0, sys.argv[1])
    cases = 0
    with open(sys.argv[2]) as lines:
        for line in lines:
            check(*json.loads(line))
            cases += 1
    print(cases)


main()
