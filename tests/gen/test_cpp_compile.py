"""Every type's C++ header compiles, by all compilers, without a warning."""

from __future__ import annotations

import subprocess
from typing import Any

import pytest

from gen.cpp_programs import COMPILERS, JOBS, begin, require, shared

pytestmark = pytest.mark.timeout(900)


@pytest.fixture(autouse=True, scope="module")
def begun() -> None:
    begin()


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
@pytest.mark.parametrize(("compiler", "source"), JOBS)
def test_every_bundled_type_compiles_without_a_warning(dialect: Any, compiler: str, source: str) -> None:
    require(compiler)
    build = shared(dialect)
    assert len(build.messages) > 290
    build.start(compiler, source).wait()


@pytest.mark.parametrize("compiler", ["Cortex-M4", "Cortex-A9"])
def test_nothing_is_called_but_memcpy_and_memset(compiler: str) -> None:
    require(compiler)
    build = shared("ros2")
    build.start(compiler, "table").wait()
    command = ["arm-none-eabi-nm", "-u", "-C", str(build.output(compiler, "table"))]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    called = {line.split(maxsplit=1)[1] for line in done.stdout.splitlines()}
    assert called <= {"memcpy", "memset", "memmove", "__aeabi_memcpy", "__aeabi_memset"}
    command = ["arm-none-eabi-size", "-A", str(build.output(compiler, "table"))]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    sizes = {
        line.split()[0]: int(line.split()[1]) for line in done.stdout.splitlines() if line.startswith(".")
    }
    assert (sizes[".data"], sizes[".bss"]) == (0, 0)
    assert not [section for section in sizes if section.startswith((".init_array", ".ARM.extab"))]


def test_the_compilers_are_those_of_the_jobs() -> None:
    assert {compiler for compiler, _ in JOBS} == set(COMPILERS)
