"""The bytes of C++ headers, of every bundled type and of odd ones: equal to genpy's and rclpy's in both directions, on this
machine with sanitizers and on 32-bit ARM."""

from __future__ import annotations

import hashlib
import pathlib
import shutil
from collections.abc import Iterator
from typing import Any

import pytest

from gen.cpp_programs import BOUNDS, Program, begin, require, shared, words
from gen.test_bytes_equal_rclpy import masked
from oracle import Oracle
from peers import CACHE
from peers import require as require_peer
from random_values import STYLES, Values, fill, plain
from roslet.gen import runtime
from roslet.idl import Message, Registry, TypeName, md5sum, type_hash
from roslet.wire import cdr, ros1

pytestmark = pytest.mark.timeout(900)
HOST = "clang++ with sanitizers"
ARM = "32-bit ARM Linux"
NOT_FOREIGN = "odd_msgs"  # a package that no peer has


@pytest.fixture(scope="module")
def programs() -> Iterator[dict[Any, Program]]:
    """The programs of this machine: of what comes out of them every octet is checked for a step outside."""
    require(HOST)
    begin()
    made: dict[Any, Program] = {dialect: Program(shared(dialect), HOST) for dialect in ("ros1", "ros2")}
    yield made
    for program in made.values():
        program.close()


@pytest.fixture(autouse=True)
def the_same_definitions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Python's classes are of the registries that the headers were made of."""
    scopes = {dialect: runtime._Scope(shared(dialect).registry) for dialect in ("ros1", "ros2")}
    monkeypatch.setattr(runtime, "_scopes", scopes)


def cases(dialect: Any, styles: tuple[str, ...] = STYLES) -> Iterator[tuple[Message, Any, str, str]]:
    """Every message with seeded values, as a dictionary and as words, and a text that tells which it is."""
    build = shared(dialect)
    resolve = build.registry.message
    for message in build.messages:
        for seed, style in enumerate(styles):
            value = Values(resolve, seed, style).message(message)
            yield message, value, words(build.registry, message, value), f"{message.name} {seed} {style}"


def written(answer: str) -> bytes:
    """The octets of the answer to `write`, which must have gone well."""
    error, field, size, octets = answer.split(" ")
    data = bytes.fromhex(octets[1:])
    assert (error, field, int(size)) == ("none", "-", len(data))
    return data


def test_ros1_types_have_the_bytes_and_values_of_genpy(programs: dict[Any, Program]) -> None:
    require_peer("genpy")
    require_peer("ros1-definitions")
    unpacked = str(CACHE / "ros1-definitions/usr/share")
    oracle = Oracle(pathlib.Path("/usr/bin/python3"), "genpy_messages.py", unpacked)
    compared, unknown = 0, set()
    for message, value, text, case in cases("ros1"):
        name = message.name.text("ros1")
        if message.name.package == NOT_FOREIGN or name in unknown:
            continue
        data = written(programs["ros1"].ask("write", message, text))
        answer = oracle.ask(type=name, value=value, data=data.hex())
        if "error" in answer:
            assert answer["error"].startswith("KeyError"), (case, answer)  # Debian has no such package
            unknown.add(name)
            continue
        assert data.hex() == answer["data"], case
        assert answer["value"] == value, case
        read = programs["ros1"].ask("read", message, answer["data"])
        assert read == f"none - {len(data)} {text}".rstrip(), case
        compared += 1
    oracle.close()
    assert compared > 250 * len(STYLES), unknown


def test_ros2_types_have_the_bytes_and_values_of_rclpy(programs: dict[Any, Program]) -> None:
    python = require_peer("kilted")
    require_peer("kilted-test-msgs")
    oracle = Oracle(python, "rclpy_messages.py")
    compared, unknown = 0, set()
    for message, value, text, case in cases("ros2"):
        name = message.name.text("ros2")
        if message.name.package == NOT_FOREIGN or name in unknown:
            continue
        data = written(programs["ros2"].ask("write", message, text))
        answer = oracle.ask(type=name, value=value, data=data.hex())
        if "error" in answer:
            assert answer["error"].startswith("ModuleNotFoundError"), (
                case,
                answer,
            )  # the wheels have no such package
            unknown.add(name)
            continue
        theirs = bytes.fromhex(answer["data"])
        # Padding is as they found it in memory, and behind the message there is more.
        mine = fill(runtime.message_class("ros2", name), value)
        assert masked(mine, theirs)[: len(data)] == data, case
        assert answer["value"] == value, case
        read = programs["ros2"].ask("read", message, theirs.hex())
        assert read == f"none - {len(data)} {text}".rstrip(), case
        compared += 1
    oracle.close()
    assert compared > 260 * len(STYLES), unknown


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_types_that_no_peer_has_have_the_bytes_of_the_writer_in_python(
    dialect: Any, programs: dict[Any, Program]
) -> None:
    compared = 0
    for message, value, text, case in cases(dialect):
        if message.name.package != NOT_FOREIGN:
            continue
        mine = fill(runtime.message_class(dialect, message.name.text(dialect)), value)
        data = bytes(ros1.write(mine) if dialect == "ros1" else cdr.write(mine))
        assert written(programs[dialect].ask("write", message, text)) == data, case
        assert programs[dialect].ask("read", message, data.hex()) == f"none - {len(data)} {text}".rstrip(), (
            case
        )
        compared += 1
    assert compared >= 5 * len(STYLES)


def test_big_endian_is_read(programs: dict[Any, Program]) -> None:
    for message, value, text, case in cases("ros2"):
        mine = fill(runtime.message_class("ros2", message.name.text("ros2")), value)
        data = bytes(cdr.write(mine, cdr.CDR_BE))
        read = programs["ros2"].ask("read", message, data.hex())
        assert read == f"none - {len(data)} {text}".rstrip(), case


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_too_short_a_buffer_is_refused_at_every_octet(dialect: Any, programs: dict[Any, Program]) -> None:
    for message, _, text, case in cases(dialect, ("random",)):
        assert programs[dialect].ask("cut", message, text) == "ok", case


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_32_bit_arm_reads_and_writes_the_same(dialect: Any) -> None:
    require(ARM)
    emulator = shutil.which("qemu-arm")
    if emulator is None:
        pytest.skip("the program qemu-arm is absent; `make peers` installs it")
    program = Program(shared(dialect), ARM, emulator)
    for message, value, text, case in cases(dialect, ("random",)):
        mine = fill(runtime.message_class(dialect, message.name.text(dialect)), value)
        data = bytes(ros1.write(mine) if dialect == "ros1" else cdr.write(mine))
        assert written(program.ask("write", message, text)) == data, case
        expected = f"none - {len(data)} {text}".rstrip()
        assert program.ask("read", message, data.hex()) == expected, case
        if dialect == "ros2":
            assert program.ask("read", message, bytes(cdr.write(mine, cdr.CDR_BE)).hex()) == expected, case
    program.close()


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_a_new_message_has_the_defaults_of_its_definition(dialect: Any, programs: dict[Any, Program]) -> None:
    build = shared(dialect)
    for message in build.messages:
        value = plain(runtime.message_class(dialect, message.name.text(dialect))())
        expected = words(build.registry, message, value)
        assert programs[dialect].ask("default", message).strip() == expected, message.name


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_name_hash_and_definition_are_those_that_peers_compare(
    dialect: Any, programs: dict[Any, Program]
) -> None:
    build = shared(dialect)
    for message in build.messages:
        name, identity, _, coded = programs[dialect].ask("facts", message).split(" ")
        definition = bytes.fromhex(coded[1:])
        assert name == message.name.text(dialect)
        if dialect == "ros2":
            assert identity == type_hash(build.registry, message.name)
            assert identity == "RIHS01_" + hashlib.sha256(definition).hexdigest()
        else:
            assert identity == md5sum(build.registry, message.name)
            heard = Registry("ros1", None)
            heard.load_full_text(message.name, definition.decode())
            assert identity == md5sum(heard, message.name), message.name


def longest(registry: Registry, name: TypeName) -> dict[str, Any]:
    """The value that has most octets: every string and sequence as long as it may be."""

    def one(kind: Any) -> Any:
        if kind.message is not None:
            return longest(registry, kind.message)
        if kind.primitive in ("string", "wstring"):
            return "x" * (kind.string_bound or BOUNDS.string)
        if kind.primitive in ("time", "duration"):
            return {"secs": 1, "nsecs": 1}
        return kind.primitive == "bool" or 1

    value = {}
    for field in registry.message(name).fields:
        kind, array = field.type, field.type.array
        count = 1 if array is None else (array.size if array.size is not None else BOUNDS.sequence)
        made = [one(kind) for _ in range(count)]
        value[field.name] = made[0] if array is None else made
    return value


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_the_longest_message_has_max_serialized_size(dialect: Any, programs: dict[Any, Program]) -> None:
    build = shared(dialect)
    compared = 0
    for message in build.messages:
        maximum = int(programs[dialect].ask("facts", message).split(" ")[2])
        if maximum > 40_000:
            continue
        text = words(build.registry, message, longest(build.registry, message.name))
        answer = programs[dialect].ask("room", message, f"{maximum} {text}")
        assert answer == f"none - {maximum}", message.name
        compared += 1
    assert compared > 200
