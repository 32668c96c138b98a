"""Messages for the typed blocks: neutral values (`random_values`) as bits and as rosbags has them, and words on a bench."""

from __future__ import annotations

import struct
from typing import Any

import numpy
from rosbags.typesys import Stores, get_typestore

from gateware.frames import Bad, Bench, taken
from roslet.idl import FieldType, Message, Registry

REGISTRY = Registry("ros2", environment=None)
STORE = get_typestore(Stores.ROS2_JAZZY)


def bits(message: Message, value: dict[str, Any]) -> dict[str, Any]:
    """What `layout.const` of the message takes."""
    return {field.name: _field(field.type, value[field.name]) for field in message.fields}


def _field(kind: FieldType, value: Any) -> Any:
    if kind.array is None:
        return _one(kind, value)
    elements = [_one(kind, one) for one in value]
    return elements if kind.array.kind == "fixed" else {"length": len(elements), "data": elements}


def _one(kind: FieldType, value: Any) -> Any:
    if kind.message is not None:
        return bits(REGISTRY.message(kind.message), value)
    if kind.primitive == "string":
        data = value.encode()
        return {"length": len(data), "data": list(data)}
    if kind.primitive in ("float32", "float64"):
        code = {"float32": "f", "float64": "d"}[kind.primitive]
        return int.from_bytes(struct.pack("<" + code, value), "little")
    return int(value)


def seen(message: Message, view: Any) -> dict[str, Any]:
    """What `bits` would have made of the value in a view of the layout."""
    return {field.name: _seen_field(field.type, view[field.name]) for field in message.fields}


def _seen_field(kind: FieldType, view: Any) -> Any:
    if kind.array is None:
        return _seen_one(kind, view)
    if kind.array.kind == "fixed":
        return [_seen_one(kind, view[n]) for n in range(kind.array.size or 0)]
    length = view["length"]
    return {"length": length, "data": [_seen_one(kind, view["data"][n]) for n in range(length)]}


def _seen_one(kind: FieldType, view: Any) -> Any:
    if kind.message is not None:
        return seen(REGISTRY.message(kind.message), view)
    if kind.primitive == "string":
        return {"length": view["length"], "data": [view["data"][n] for n in range(view["length"])]}
    return int(view)


def reference(name: str, value: dict[str, Any], big: bool = False) -> bytes:
    """The body as rosbags writes it."""
    data = bytes(STORE.serialize_cdr(_build(name, value), name, little_endian=not big))
    return data[4:]


def _build(name: str, value: dict[str, Any]) -> Any:
    made = {}
    for field, (kind, detail) in STORE.fielddefs[name][1]:
        made[field] = _build_one(int(kind), detail, value.get(field, 0))
    return STORE.types[name](**made)


def _build_one(kind: int, detail: Any, value: Any) -> Any:
    if kind == 1:
        return value - 256 if detail[0] == "byte" and value > 127 else value  # signed, to rosbags
    if kind == 2:
        return _build(detail, value)
    (element, inner), _size = detail
    if int(element) == 1 and inner[0] != "string":
        if inner[0] == "byte":
            return numpy.array(value, "int64").astype("uint8")
        return numpy.array(value, {"char": "uint8"}.get(inner[0], inner[0]))
    return [_build_one(int(element), inner, one) for one in value]


def known(name: str) -> bool:
    """Whether rosbags has the type with the same fields."""
    message = REGISTRY.message(name)
    if name not in STORE.fielddefs:
        return False
    theirs = [field[0] for field in STORE.fielddefs[name][1]]
    if [field.name for field in message.fields] != [one for one in theirs if one != _DUMMY]:
        return False
    return all(known(str(field.type.message)) for field in message.fields if field.type.message is not None)


_DUMMY = "structure_needs_at_least_one_member"


def send_values(bench: Bench, name: str, values: list[int]) -> None:
    """Put messages, as numbers of all their bits, into the stream `name`."""
    port = bench._port(name)

    async def process(ctx: Any) -> None:
        for value in values:
            while bench.random.randrange(100) < bench.stalls:
                await ctx.tick()
            ctx.set(port.payload.as_value(), value)
            ctx.set(port.valid, 1)
            await taken(ctx, port)
            ctx.set(port.valid, 0)
            ctx.set(port.payload.as_value(), bench.random.getrandbits(max(1, len(port.payload.as_value()))))

    bench.drive(process)


def receive_values(bench: Bench, name: str) -> list[Any]:
    """Take messages from the stream `name`, now and then."""
    port = bench._port(name)
    got: list[Any] = []
    bench._received[name] = got

    async def process(ctx: Any) -> None:
        held: Any = None
        while True:
            ready = int(bench.random.randrange(100) >= bench.stalls)
            ctx.set(port.ready, ready)
            (_, _, valid, raw, view) = await ctx.tick().sample(
                port.valid, port.payload.as_value(), port.payload
            )
            if held is not None and (not valid or raw != held):
                bench._faults.append(f"{name}: a message was withdrawn")
            held = raw if valid and not ready else None
            if valid and ready:
                got.append(view)

    bench.watch(process)
    return got


def send_words(bench: Bench, name: str, bodies: list[bytes], big: list[int]) -> None:
    """Send bodies (a `Bad` one ends badly) as words, `big[n]` beside the nth; what is not of a body is random."""
    port = bench._port(name)

    async def process(ctx: Any) -> None:
        for body, order in zip(bodies, big, strict=True):
            ctx.set(port.meta.big, order)
            padded = body + bench.random.randbytes(-len(body) % 4)
            items = [
                {"data": int.from_bytes(padded[n : n + 4], "little"), "end": 0, "bad": 0, "padding": 0}
                for n in range(0, len(padded), 4)
            ]
            end = {"data": bench.random.getrandbits(32), "end": 1, "padding": -len(body) % 4}
            items.append({**end, "bad": int(isinstance(body, Bad))})
            for item in items:
                while bench.random.randrange(100) < bench.stalls:
                    await ctx.tick()
                ctx.set(port.stream.payload, item)
                ctx.set(port.stream.valid, 1)
                await taken(ctx, port.stream)
                ctx.set(port.stream.valid, 0)

    bench.drive(process)


def receive_words(bench: Bench, name: str) -> list[bytes]:
    """Take bodies from the port `name`, now and then. Octets that are not of a body must be zero."""
    port = bench._port(name)
    got: list[bytes] = []
    bench._received[name] = got  # type: ignore[assignment]

    async def process(ctx: Any) -> None:
        held: Any = None
        octets = bytearray()
        while True:
            ready = int(bench.random.randrange(100) >= bench.stalls)
            ctx.set(port.stream.ready, ready)
            (_, _, valid, item) = await ctx.tick().sample(port.stream.valid, port.stream.payload)
            now = (item.data, item.end, item.bad, item.padding) if valid else None
            if held is not None and now != held:
                bench._faults.append(f"{name}: {held} was withdrawn for {now}")
            held = now if not ready else None
            if now is None or not ready:
                continue
            if not item.end:
                if item.bad or item.padding:
                    bench._faults.append(f"{name}: {now} is no end")
                octets += item.data.to_bytes(4, "little")
                continue
            body = bytes(octets[: len(octets) - item.padding])
            if not item.bad and octets[len(body) :] != bytes(item.padding):
                bench._faults.append(f"{name}: padding of {bytes(octets[len(body) :])!r}")
            got.append(Bad(body) if item.bad else body)
            octets.clear()

    bench.watch(process)
    return got
