"""`roslet run`: an unmodified rospy or rclpy program, without ROS."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
import traceback
from types import ModuleType
from typing import TYPE_CHECKING

from roslet.compat import finder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from roslet.idl.records import Dialect

# Folders above the script in which its package is looked for: pkg/scripts/x.py, pkg/src/pkg/x.py.
ABOVE = 4


def run(
    script: str | os.PathLike[str],
    arguments: Sequence[str] = (),
    types: Sequence[str | os.PathLike[str]] = (),
    master: str | None = None,
    real: bool = False,
) -> int:
    """Run `script` as `__main__` with `arguments`; its exit code.

    types   packages, workspaces or folders of definitions that come before all others, before those of $ROSLET_TYPES
            (separated as in $PATH), the script's own package, and $ROS_PACKAGE_PATH or $AMENT_PREFIX_PATH
    master  ros1://host:port or http://host:port in place of $ROS_MASTER_URI
    real    let `import rospy` or `import rclpy` find an installed one

    As with the interpreter itself: an exception that the program does not catch is printed and gives 1, sys.exit what it
    says, a Ctrl-C that it does not catch 130. SIGTERM ends a program as it does under rospy. Whatever the end, the node is
    unregistered when this returns. What the program did to the interpreter, its modules for example, stays.
    """
    path = os.fspath(script)
    sys.argv = [path, *arguments]
    sys.path.insert(0, os.path.dirname(os.path.abspath(path)))
    if master:
        from roslet.names import parse_host_port

        host, port = parse_host_port(
            master if ":" in master.partition("://")[2] else master.rstrip("/") + ":11311"
        )
        os.environ["ROS_MASTER_URI"] = f"http://{host}:{port}"
    try:
        with open(path, "rb") as file:
            source = file.read()
    except OSError as error:
        print(f"roslet run: cannot read {path}: {error.strerror}", file=sys.stderr)
        return 2
    dialect = finder.dialect_of(source)
    _find_definitions(dialect, path, types)
    if not real:
        finder.install(dialect)
    if threading.current_thread() is threading.main_thread():
        # As the interpreter starts a program, whatever our caller does with signals.
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
    code = _run_main(path, source)
    _end()
    return code


def _find_definitions(dialect: Dialect, path: str, types: Sequence[str | os.PathLike[str]]) -> None:
    """Load, the last to come first, the script's own package, $ROSLET_TYPES and `types`."""
    from roslet.errors import DefinitionError
    from roslet.gen.runtime import registry

    own = package_of(path)
    if own is not None:
        with contextlib.suppress(DefinitionError):  # a package need not have definitions
            registry(dialect).load(own)
        code = os.path.join(own, "src")
        if os.path.isdir(code) and code not in sys.path:
            # Where catkin_python_setup would have installed the package's modules from.
            sys.path.insert(1, code)
    given = [part for part in os.environ.get("ROSLET_TYPES", "").split(os.pathsep) if part]
    for one in [*given, *types][::-1]:
        registry(dialect).load(one)


def package_of(path: str) -> str | None:
    """The folder of the ROS package that a file is in; None where it is in none."""
    folder = os.path.dirname(os.path.abspath(path))
    for _ in range(ABOVE):
        if os.path.isfile(os.path.join(folder, "package.xml")):
            return folder
        folder = os.path.dirname(folder)
    return None


def _run_main(path: str, source: bytes) -> int:
    main = ModuleType("__main__")
    main.__file__ = path
    main.__builtins__ = __builtins__  # type: ignore[attr-defined]
    sys.modules["__main__"] = main
    try:
        exec(compile(source, path, "exec"), main.__dict__)
    except SystemExit as error:
        return _exit_code(error.code)
    except KeyboardInterrupt as error:
        if type(error) is not KeyboardInterrupt:
            _print_exception(error)
            return 1
        return 128 + signal.SIGINT
    except BaseException as error:
        _print_exception(error)
        return 1
    return 0


def _print_exception(error: BaseException) -> None:
    """The traceback, from the program's own first line on."""
    inner = error.__traceback__.tb_next if error.__traceback__ is not None else None
    traceback.print_exception(type(error), error, inner)


def _exit_code(code: object) -> int:
    if code is None:
        return 0
    if isinstance(code, int):
        return code & 0xFF
    print(code, file=sys.stderr)
    return 1


def _end() -> None:
    """Unregister, where the program has a node. At once: what it still has to say it has said by now."""
    module = sys.modules.get("roslet.compat.session")
    if module is not None:
        module.session.shut_down("atexit")
    module = sys.modules.get("roslet.compat.rclpy.context")
    if module is not None:
        module.close_all()
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            continue


__all__ = ["package_of", "run"]
