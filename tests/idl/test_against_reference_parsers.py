"""Random definitions, read by us and by each dialect's own parser; a difference prints the text that shows it."""

from __future__ import annotations

import json
import math
import pathlib
import random
import subprocess
from typing import Any

import peers
from roslet.idl import Dialect, Message, TypeName, parse

COUNT = 600
PRIMITIVES = {
    "ros1": "bool int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64 string char byte time duration",
    "ros2": "bool int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64 string char byte wstring",
}
BITS = {"char": 8, "byte": 8, "int8": 8, "int16": 16, "int32": 32, "int64": 64}
BITS.update({"u" + name: bits for name, bits in list(BITS.items()) if name.startswith("int")})
WORDS = [
    "plain",
    "two words",
    "ünï",
    "don't",
    "a, b",
    "#",
    "=",
    "[x]",
    "-1",
    "true",
    'say "x"',
    "tab\there",
    "",
]


class Definitions:
    """Makes random texts that the dialect's own parser accepts, and reads them in the reference's terms."""

    def __init__(self, dialect: Dialect, seed: int) -> None:
        self.dialect: Dialect = dialect
        self.random = random.Random(seed)
        self.primitives = PRIMITIVES[dialect].split()

    def text(self) -> str:
        lines = []
        for number in range(self.random.randrange(8)):
            line = self.random.choice([self.field, self.constant, self.comment])(number)
            lines.append(line + self.random.choice(["", "", " ", "  # comment = 5", "#x", "\r"]))
        return "\n".join(lines) + self.random.choice(["", "\n", "\n\n"])

    def comment(self, number: int) -> str:
        return self.random.choice(["", " ", "# a comment", "  # int8 x", "#int8 X=1", "# @unit(m)", "#" * 80])

    def gap(self) -> str:
        return self.random.choice([" ", " ", "  ", "    "])

    def integer(self, spelled: str) -> str:
        signed = spelled[0] == "i" or (spelled == "byte" and self.dialect == "ros1")
        low, high = (
            (-(1 << BITS[spelled] - 1), (1 << BITS[spelled] - 1) - 1)
            if signed
            else (0, (1 << BITS[spelled]) - 1)
        )
        value = self.random.choice([low, high, 0, 1, self.random.randint(low, high)])
        if self.dialect == "ros2" and self.random.random() < 0.3:
            return self.random.choice([hex, oct, bin])(value)
        return str(value)

    def number(self) -> str:
        return self.random.choice(["0", "1.5", "-2.25e3", "1e-30", ".5", "5.", "inf", "-inf", "nan", "+1"])

    def value(self, spelled: str, element: bool = False) -> str:
        if spelled == "bool":
            return self.random.choice(
                ["True", "False", "0", "1"] + ["true", "FALSE"] * (self.dialect == "ros2")
            )
        if spelled.startswith("float"):
            return self.number()
        if "string" not in spelled:
            return self.integer(spelled)
        # What stands after # or between quotes is where references are whimsical; the hand-made cases cover it.
        words = [word for word in WORDS if self.dialect == "ros1" or not set(word) & set("#='\"\t")]
        if element:
            words = [word for word in words if word and "," not in word]
        word = self.random.choice(words)
        if self.dialect == "ros2" and (not word or word.startswith("[") or self.random.random() < 0.5):
            quote = self.random.choice("'\"")
            return quote + word + quote
        return word

    def constant(self, number: int) -> str:
        spelled = self.random.choice([one for one in self.primitives if one not in ("time", "duration")])
        equals = self.random.choice(["=", " = ", "= ", " ="])
        return f"{spelled}{self.gap()}NAME{number}{equals}{self.value(spelled)}"

    def field(self, number: int) -> str:
        nested = self.random.random() < 0.2
        spelled = self.random.choice(["Other", "std_msgs/String", "Header"] if nested else self.primitives)
        brackets = self.random.choice(["", "", "[]", f"[{self.random.randint(1, 300)}]"])
        bound = ""
        if self.dialect == "ros2":
            if brackets and self.random.random() < 0.3:
                brackets = "[<=3]"
            if "string" in spelled and self.random.random() < 0.3:
                bound = "<=12"
        line = f"{spelled}{bound}{brackets}{self.gap()}name{number}"
        if self.dialect == "ros2" and not nested and self.random.random() < 0.4:
            default = self.value(spelled)
            if brackets:
                count = int(brackets[1:-1]) if brackets[1:-1].isdigit() else self.random.randint(0, 3)
                default = "[" + ", ".join([self.value(spelled, True) for _ in range(count)]) + "]"
            line += self.gap() + default
        return line


def reference(python: pathlib.Path, script: str, texts: list[str]) -> list[dict[str, Any]]:
    command = [str(python), str(peers.ROOT / "tests/reference" / script), "values"]
    ran = subprocess.run(command, check=True, capture_output=True, input=json.dumps(texts).encode())
    answer: list[dict[str, Any]] = json.loads(ran.stdout)
    assert len(answer) == len(texts)
    return answer


def plain(value: object) -> object:
    """Values as JSON has them; a NaN, which equals nothing, by name."""
    if isinstance(value, tuple | list):
        return [plain(one) for one in value]
    return "nan" if isinstance(value, float) and math.isnan(value) else value


def parsed(text: str, dialect: Dialect) -> Message:
    message = parse(text, TypeName("pkg", "msg", "Thing"), dialect, "random.msg")
    assert isinstance(message, Message)
    return message


def test_random_ros1_definitions_are_read_as_genmsg_reads_them() -> None:
    peers.require("genpy")
    made = Definitions("ros1", 1)
    texts = [made.text() for _ in range(COUNT)]
    verdicts = reference(peers.DEBIAN_PYTHON, "genmsg_definitions.py", texts)
    for text, verdict in zip(texts, verdicts, strict=True):
        assert "error" not in verdict, f"the test made what genmsg refuses: {text!r}: {verdict['error']}"
        message = parsed(text, "ros1")
        fields = []
        for field in message.fields:
            full = str(field.type)
            if field.type.message is not None:
                full = field.type.message.text("ros1") + full[len(field.type.spelled) :]
            fields.append([field.name, full])
        constants = [[one.name, one.type.spelled, plain(one.value), one.text] for one in message.constants]
        expected = [[name, kind, plain(value), text] for name, kind, value, text in verdict["constants"]]
        assert (fields, constants) == (verdict["fields"], expected), f"reproducer: {text!r}"


def test_random_ros2_definitions_are_read_as_rosidl_reads_them() -> None:
    python = peers.require("kilted")
    made = Definitions("ros2", 2)
    texts = [made.text() for _ in range(COUNT)]
    verdicts = reference(python, "rosidl_definitions.py", texts)
    for text, verdict in zip(texts, verdicts, strict=True):
        assert "error" not in verdict, f"the test made what rosidl refuses: {text!r}: {verdict['error']}"
        message = parsed(text, "ros2")
        fields = []
        for field in message.fields:
            full = str(field.type)
            if field.type.message is not None:
                short = field.type.message.package + "/" + field.type.message.name
                full = short + full[len(field.type.spelled) :]
            fields.append([field.name, full, plain(field.default)])
        constants = [[one.name, one.type.spelled, plain(one.value)] for one in message.constants]
        wanted_fields = [[name, kind, plain(default)] for name, kind, default in verdict["fields"]]
        wanted_constants = [[name, kind, plain(value)] for name, kind, value in verdict["constants"]]
        assert (fields, constants) == (wanted_fields, wanted_constants), f"reproducer: {text!r}"
