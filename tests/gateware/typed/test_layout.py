"""Layouts, bounds and flat ports."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import pytest
from amaranth.hdl import signed, unsigned
from amaranth.lib import data

from gateware.frames import Bench
from gateware.typed.messages import receive_values, receive_words, send_values, send_words
from roslet.errors import UnknownType, Unsupported
from roslet.gateware.typed.deserializer import Deserializer
from roslet.gateware.typed.flat import Flat
from roslet.gateware.typed.layout import message_layout
from roslet.gateware.typed.serializer import Serializer
from roslet.gen.gateware import Bounds, plan
from roslet.gen.gateware_ports import document, flat_ports
from roslet.idl import Registry

DEFINITION = """\
bool yes
int16 small
float32 real
char letter
string<=5 name
string note
uint8[] octets
uint16[<=3] few
int32[2] pair
string[] names
builtin_interfaces/Time stamp
"""


@pytest.fixture
def registry(tmp_path: Path) -> Registry:
    folder = tmp_path / "my_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "All.msg").write_text(DEFINITION)
    (folder / "Wide.msg").write_text("wstring text\n")
    (folder / "Clash.msg").write_text("string data\nuint32 data_length\nbool valid\n")
    (tmp_path / "my_msgs" / "package.xml").write_text("<package format='3'><name>my_msgs</name></package>")
    made = Registry("ros2", environment=None)
    made.load(tmp_path / "my_msgs")
    return made


ALL = Bounds(20, 8, {"note": 7, "names": 2, "names[]": 6})


def test_every_kind_of_field_has_its_shape(registry: Registry) -> None:
    octets = data.ArrayLayout(unsigned(8), 6)
    assert message_layout(plan("my_msgs/All", ALL, registry)) == data.StructLayout(
        {
            "yes": unsigned(1),
            "small": signed(16),
            "real": unsigned(32),
            "letter": unsigned(8),
            "name": data.StructLayout({"length": unsigned(3), "data": data.ArrayLayout(unsigned(8), 5)}),
            "note": data.StructLayout({"length": unsigned(3), "data": data.ArrayLayout(unsigned(8), 7)}),
            "octets": data.StructLayout({"length": unsigned(4), "data": data.ArrayLayout(unsigned(8), 8)}),
            "few": data.StructLayout({"length": unsigned(2), "data": data.ArrayLayout(unsigned(16), 3)}),
            "pair": data.ArrayLayout(signed(32), 2),
            "names": data.StructLayout(
                {
                    "length": unsigned(2),
                    "data": data.ArrayLayout(data.StructLayout({"length": unsigned(3), "data": octets}), 2),
                }
            ),
            "stamp": data.StructLayout({"sec": signed(32), "nanosec": unsigned(32)}),
        }
    )


def test_what_gates_cannot_do_is_refused_with_a_sentence(registry: Registry) -> None:
    cases: list[tuple[type[Exception], str, str, Bounds]] = [
        (Unsupported, "text is a wstring", "my_msgs/Wide", Bounds(8)),
        (ValueError, "the string note has no bound", "my_msgs/All", Bounds()),
        (ValueError, "the sequence octets has no bound", "my_msgs/All", Bounds(8)),
        (ValueError, "no string or sequence header", "my_msgs/All", Bounds(8, 8, {"header": 3})),
        (UnknownType, "my_msgs/msg/None", "my_msgs/None", Bounds()),
    ]
    for error, sentence, name, bounds in cases:
        with pytest.raises(error, match=sentence):
            plan(name, bounds, registry)
    with pytest.raises(ValueError, match="the bound of a string is at least 1, not 0"):
        Bounds(0)
    with pytest.raises(ValueError, match="has its bounds already"):
        Serializer(plan("std_msgs/Empty"), Bounds(3))
    with pytest.raises(ValueError, match="no `big`"):
        Deserializer("std_msgs/Empty", meta=data.StructLayout({"small": 1}))
    with pytest.raises(ValueError, match="a prefix is a Verilog name"):
        Flat("9", "std_msgs/Empty")


def test_a_wstring_is_refused_for_what_it_is(registry: Registry) -> None:
    with pytest.raises(Unsupported, match="wstring"):
        plan("my_msgs/Wide", Bounds(8, 8), registry)


def test_flat_ports_have_the_names_and_widths_of_the_fields(registry: Registry) -> None:
    ports = flat_ports("all", plan("my_msgs/All", ALL, registry))
    assert {name: (port.width, port.signed) for name, port in ports.items()} == {
        "all_yes": (1, False),
        "all_small": (16, True),
        "all_real": (32, False),
        "all_letter": (8, False),
        "all_name": (40, False),
        "all_name_length": (3, False),
        "all_note": (56, False),
        "all_note_length": (3, False),
        "all_octets": (64, False),
        "all_octets_length": (4, False),
        "all_few": (48, False),
        "all_few_length": (2, False),
        "all_pair": (64, False),
        "all_names": (96, False),
        "all_names_item_length": (6, False),
        "all_names_length": (2, False),
        "all_stamp_sec": (32, True),
        "all_stamp_nanosec": (32, False),
    }
    assert list(flat_ports("a", plan("my_msgs/Clash", Bounds(4), registry))) == [
        "a_data",
        "a_data_length",
        "a_data_length_",
        "a_valid_",
    ]


def test_the_documentation_of_flat_ports_is_a_table() -> None:
    assert document("chatter", plan("std_msgs/String", Bounds(8))) == (
        "// chatter: std_msgs/msg/String, at most 13 octets\n"
        "// port                 bits  meaning                                   field\n"
        "// chatter_data         64    octets[8] of string                       data\n"
        "// chatter_data_length  4     its octets, at most 8                     data\n"
        "// chatter_valid        1     there is a message\n"
        "// chatter_ready        1     it is taken at this clock edge, if valid\n"
        "// Of several values in a port the first is in the lowest bits; floats are the bits of IEEE 754;\n"
        "// what is behind a length means nothing.\n"
    )
    fields = {
        name: port.field
        for name, port in flat_ports("m", plan("sensor_msgs/JointState", Bounds(8, 3))).items()
    }
    assert fields["m_name_item_length"] == fields["m_name"] == "name[]"
    assert fields["m_header_stamp_sec"] == "header.stamp.sec"


def test_flat_ports_carry_a_message_either_way() -> None:
    bounds = Bounds(5, 2)
    name = "sensor_msgs/JointState"
    layout: Any = message_layout(name, bounds)
    text = {"length": 1, "data": [97]}
    value = {
        "header": {"stamp": {"sec": -3, "nanosec": 9}, "frame_id": {"length": 2, "data": [98, 99]}},
        "name": {"length": 2, "data": [text, {"length": 2, "data": [100, 101]}]},
        "position": {"length": 2, "data": [7, 8]},
    }
    raw = layout.const(value).as_value().value
    expected = {
        "j_header_stamp_sec": -3,
        "j_header_frame_id": 0x6362,
        "j_header_frame_id_length": 2,
        "j_name": 0x6564 << 40 | 0x61,
        "j_name_item_length": 2 << 3 | 1,
        "j_name_length": 2,
        "j_position": 8 << 64 | 7,
        "j_effort_length": 0,
    }
    out = Flat("j", name, bounds, gives=True)
    bench = Bench(out)

    async def look(ctx: Any) -> None:
        ctx.set(out.i.payload.as_value(), raw)
        ctx.set(out.i.valid, 1)
        ctx.set(out.j_ready, 1)
        await ctx.tick()
        assert (ctx.get(out.j_valid), ctx.get(out.i.ready)) == (1, 1)
        assert {port: ctx.get(getattr(out, port)) for port in expected} == expected

    bench.drive(look)
    bench.run()

    into = Flat("j", name, bounds)
    bench = Bench(into, 0)
    got = receive_values(bench, "o")

    async def give(ctx: Any) -> None:
        for port, number in expected.items():
            ctx.set(getattr(into, port), number)
        ctx.set(into.j_header_stamp_nanosec, 9)
        ctx.set(into.j_position_length, 2)
        ctx.set(into.j_valid, 1)
        (_, _, ready) = await ctx.tick().sample(into.j_ready)
        assert ready
        ctx.set(into.j_valid, 0)

    bench.drive(give)
    bench.run(lambda: bool(got))
    assert got[0] == layout.const(value)


MSGS = Path(__file__).parents[3] / "examples" / "msgs"


def test_a_type_of_the_users_goes_through_and_back() -> None:
    registry = Registry("ros2", environment=None)
    registry.load(MSGS)
    coordinate = plan("mros_comm_measure/Coordinate", registry=registry)
    assert coordinate.maximum == 20
    dut = Serializer(coordinate)
    fields = {"x": 0x3F800000, "y": 0xC0000000, "z": 1, "time": {"sec": -2, "nanosec": 0x12345678}}
    bench = Bench(dut)
    send_values(bench, "i", [dut.layout.const(fields).as_value().value])
    sent = receive_words(bench, "o")
    bench.run(lambda: bool(sent))
    assert sent == [bytes.fromhex("0000803f 000000c0 01000000 feffffff 78563412")]

    bench = Bench(Deserializer(coordinate))
    send_words(bench, "i", [*sent, bytes.fromhex("3f800000 c0000000 00000001 fffffffe 12345678")], [0, 1])
    got = receive_values(bench, "o")
    bench.run(lambda: len(got) == 2)
    assert got == [dut.layout.const(fields)] * 2


@pytest.mark.parametrize(
    ("name", "bounds", "words"),
    [("geometry_msgs/Twist", Bounds(), 12), ("std_msgs/String", Bounds(25), 8)],
)
def test_a_message_takes_a_cycle_a_word_and_one_for_its_end(name: str, bounds: Bounds, words: int) -> None:
    dut = Serializer(name, bounds)
    bench = Bench(dut, 0)
    value = (1 << 205) - 1 & ~31 | 25 if "String" in name else 5
    times: list[int] = []
    got = receive_words(bench, "o")
    send_values(bench, "i", [value] * 3)

    async def watch(ctx: Any) -> None:
        cycle = 0
        while True:
            (_, _, valid, item) = await ctx.tick().sample(dut.o.stream.valid, dut.o.stream.payload)
            cycle += 1
            if valid and item.end:
                times.append(cycle)

    bench.watch(watch)
    bench.run(lambda: len(got) == 3)
    assert [late - early for early, late in itertools.pairwise(times)] == [words + 1] * 2
