"""Modules as trees: without docstrings, annotations and what only runs on CPython; with constants as numbers."""

from __future__ import annotations

import ast
import re
from importlib.util import find_spec
from pathlib import Path

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping

_CONSTANT = re.compile(r"_?[A-Z][A-Z0-9_]*$")
_DROPPED = ("__slots__", "__all__", "TYPE_CHECKING")
Function = (ast.FunctionDef, ast.AsyncFunctionDef)


class Module:
    """`tree` is that of the module `name`; `package`: whether it is a package's `__init__`."""

    def __init__(self, name: str, text: str, package: bool = False) -> None:
        self.name = name
        self.package = package
        self.tree: ast.Module = _Stripper().visit(ast.parse(text))
        self.constants: dict[str, int] = {}


def locate(name: str) -> Path | None:
    """The file of a module of roslet, without importing it."""
    root = find_spec("roslet")
    assert root is not None and root.submodule_search_locations is not None
    base = Path(root.submodule_search_locations[0]).joinpath(*name.split(".")[1:])
    for path in (base.with_suffix(".py"), base / "__init__.py"):
        if path.is_file():
            return path
    return None


class _Stripper(ast.NodeTransformer):
    """Takes out docstrings, annotations, `__slots__`, what is only for type checkers, and `from __future__`."""

    def visit_Module(self, node: ast.Module) -> ast.AST:
        self.generic_visit(node)
        node.body = [one for one in node.body if not _is_text(one)]
        return node

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        self.generic_visit(node)
        node.body = [one for one in node.body if not _is_text(one)] or [ast.Pass()]
        return node

    def _function(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> ast.AST:
        self.generic_visit(node)
        node.returns = None
        arguments = node.args
        for one in [
            *arguments.posonlyargs,
            *arguments.args,
            *arguments.kwonlyargs,
            arguments.vararg,
            arguments.kwarg,
        ]:
            if one is not None:
                one.annotation = None
        # MicroPython knows no `/`.
        arguments.args = arguments.posonlyargs + arguments.args
        arguments.posonlyargs = []
        node.body = [one for one in node.body if not _is_text(one)] or [ast.Pass()]
        return node

    visit_FunctionDef = visit_AsyncFunctionDef = _function  # noqa: N815 - ast's names

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AST | None:
        if node.value is None or (isinstance(node.target, ast.Name) and node.target.id in _DROPPED):
            return None
        return ast.Assign([node.target], node.value, lineno=node.lineno)

    def visit_Assign(self, node: ast.Assign) -> ast.AST | list[ast.stmt] | None:
        target = node.targets[0]
        if isinstance(target, ast.Name) and target.id in _DROPPED:
            return None
        value = node.value
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and _all_constants(target, value):
            return [
                ast.Assign([one], what, lineno=node.lineno)
                for one, what in zip(target.elts, value.elts, strict=True)
            ]
        return node

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt]:
        if isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            return [made for one in node.orelse for made in _listed(self.visit(one))]
        self.generic_visit(node)
        return node

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.AST | None:
        return None if node.module == "__future__" else node


def _listed(made: ast.stmt | list[ast.stmt] | None) -> list[ast.stmt]:
    return made if isinstance(made, list) else [] if made is None else [made]


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _all_constants(target: ast.Tuple, value: ast.Tuple) -> bool:
    return len(target.elts) == len(value.elts) and all(
        isinstance(one, ast.Name) and _CONSTANT.match(one.id) for one in target.elts
    )


# -- constants


def collect_constants(module: Module, given: Mapping[str, int]) -> None:
    """The module's integer constants, which are assigned once; those that are `given` have another value."""
    counts: dict[str, int] = {}
    for node in ast.walk(module.tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            counts[node.id] = counts.get(node.id, 0) + 1
    for statement in module.tree.body:
        if not isinstance(statement, ast.Assign) or not isinstance(statement.targets[0], ast.Name):
            continue
        name = statement.targets[0].id
        if len(statement.targets) > 1 or not _CONSTANT.match(name) or counts[name] > 1:
            continue
        value = given.get(name, _integer(statement.value, module.constants))
        if value is not None:
            module.constants[name] = value
            statement.value = ast.Constant(value)


def _integer(node: ast.expr, known: Mapping[str, int]) -> int | None:
    """The value of an expression of integers, None where it is something else."""
    if isinstance(node, ast.Constant):
        return node.value if type(node.value) is int else None
    if isinstance(node, ast.Name):
        return known.get(node.id)
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        value = _integer(node.operand, known)
        return None if value is None else -value
    if isinstance(node, ast.BinOp):
        left, right = _integer(node.left, known), _integer(node.right, known)
        if left is None or right is None:
            return None
        if isinstance(node.op, ast.LShift):
            return left << right
        if isinstance(node.op, ast.BitOr):
            return left | right
        if isinstance(node.op, ast.Mult):
            return left * right
        if isinstance(node.op, ast.Add):
            return left + right
        if isinstance(node.op, ast.Sub):
            return left - right
    return None


class Inliner(ast.NodeTransformer):
    """Puts numbers where their names stand. `names`: in this module; `modules`: by the name of a module here, its constants.
    `folds`: names that are true or false on MicroPython, whose branches are chosen now."""

    def __init__(
        self, names: Mapping[str, int], modules: Mapping[str, Mapping[str, int]], folds: Mapping[str, bool]
    ) -> None:
        self._names = names
        self._modules = modules
        self._folds = folds

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if isinstance(node.ctx, ast.Load) and node.id in self._names:
            return ast.Constant(self._names[node.id])
        return node

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        if isinstance(node.ctx, ast.Load) and isinstance(node.value, ast.Name):
            value = self._modules.get(node.value.id, {}).get(node.attr)
            if value is not None:
                return ast.Constant(value)
        self.generic_visit(node)
        return node

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt]:
        if isinstance(node.test, ast.Name) and node.test.id in self._folds:
            chosen = node.body if self._folds[node.test.id] else node.orelse
            return [made for one in chosen for made in _listed(self.visit(one))]
        self.generic_visit(node)
        return node


Scope = (*Function, ast.Lambda, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


def bound_names(scope: ast.AST) -> set[str]:
    """The names that a function or comprehension binds for itself: parameters, what is assigned, its inner functions."""
    found: set[str] = set()
    released: set[str] = set()
    pieces = list(ast.iter_child_nodes(scope))
    while pieces:
        node = pieces.pop()
        if isinstance(node, ast.arg):
            found.add(node.arg)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        elif isinstance(node, ast.ExceptHandler) and node.name:
            found.add(node.name)
        elif isinstance(node, ast.Global | ast.Nonlocal):
            released.update(node.names)
        elif isinstance(node, Function):
            found.add(node.name)
        elif isinstance(node, ast.ImportFrom | ast.Import):
            # What is imported is looked for by its name elsewhere.
            continue
        if not isinstance(node, Scope):
            pieces.extend(ast.iter_child_nodes(node))
    return found - released


class Mentions:
    """What a piece of code mentions. `names` that it has from outside; `attributes`: (name, attribute) for each attribute of
    what has a name from outside, ("", attribute) for all others, and for what `getattr` and its like are given;
    `imports`."""

    def __init__(self, piece: ast.AST) -> None:
        self.names: set[str] = set()
        self.attributes: set[tuple[str, str]] = set()
        self.imports: list[ast.Import | ast.ImportFrom] = []
        self._look(piece, frozenset())

    def _look(self, node: ast.AST, own: frozenset[str]) -> None:
        if isinstance(node, ast.Name):
            if node.id not in own:
                self.names.add(node.id)
            return
        if isinstance(node, Scope):
            own |= bound_names(node)
        elif isinstance(node, ast.Attribute):
            base = node.value.id if isinstance(node.value, ast.Name) and node.value.id not in own else ""
            self.attributes.add((base, node.attr))
            if base:
                return  # of a module only the attribute counts; of anything else the name does as well
        elif isinstance(node, ast.Import | ast.ImportFrom):
            self.imports.append(node)
        elif (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id in ("getattr", "hasattr", "setattr")
        ):
            given = [one.value for one in node.args if isinstance(one, ast.Constant)]
            self.attributes |= {("", one) for one in given if isinstance(one, str)}
        for child in ast.iter_child_nodes(node):
            self._look(child, own)
