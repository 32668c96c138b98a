"""Short names for what the program does not name: a name costs a board its letters in flash and some thirty bytes of heap.

Private members get names that classes which have nothing to do with each other share; what modules define has a name of its
own. What is a text somewhere stays, and so do public members: who knows what of MicroPython itself is called so too.
"""

from __future__ import annotations

import ast
import builtins
import keyword

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable

_DIGITS = "abcdefghijklmnopqrstuvwxyz0123456789"


def shorten(
    pieces: Iterable[ast.Module], program: ast.Module, public: Iterable[str]
) -> tuple[dict[str, str], dict[str, str]]:
    """Rename what the classes in `pieces` have, and what the pieces define, but for the names in `public`; what
    became of the members, and of the modules' names."""
    names = _Names(pieces)
    names.keep(program)
    members = names.rename()
    return members, _shorten_globals(names.pieces, program, set(public), names.short)


def _shorten_globals(
    pieces: list[ast.Module], program: ast.Module, public: set[str], members: set[str]
) -> dict[str, str]:
    defined: dict[str, int] = {}
    taken = set(public) | members | set(dir(builtins))
    for piece in pieces:
        for node in ast.walk(piece):
            if isinstance(node, ast.Name):
                taken.add(node.id)
            elif isinstance(node, ast.arg):
                taken.add(node.arg)
            elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ExceptHandler):
                taken.add(node.name or "")
            elif isinstance(node, ast.alias):
                taken.add(node.asname or node.name)
        for statement in piece.body:
            if isinstance(statement, ast.ClassDef):
                if not _is_error(statement):
                    defined[statement.name] = 1
            else:
                defined.update(dict.fromkeys(_bound(statement), 1))
    chosen: dict[str, str] = {}
    number = 0
    for name in defined:
        if name in public or name.startswith("__"):
            continue
        while not _is_free(_short(number)[1:], taken):
            number += 1
        if len(_short(number)) - 1 < len(name):
            chosen[name] = _short(number)[1:]
            number += 1
    for piece in [*pieces, program]:
        _GlobalRenamer(chosen, piece is program).visit(piece)
    return chosen


def _is_free(name: str, taken: set[str]) -> bool:
    return name.isidentifier() and name not in taken and not keyword.iskeyword(name)


def _is_error(node: ast.ClassDef) -> bool:
    """Whether it may be an exception, which people read the name of."""
    return any(isinstance(base, ast.Name) and base.id[0].isupper() for base in node.bases)


class _GlobalRenamer(ast.NodeTransformer):
    def __init__(self, chosen: dict[str, str], program: bool) -> None:
        self._chosen = chosen
        self._program = program

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if not self._program and not getattr(node, "member", False):
            node.id = self._chosen.get(node.id, node.id)
        return node

    def visit_Global(self, node: ast.Global) -> ast.AST:
        node.names = [self._chosen.get(name, name) for name in node.names]
        return node

    def _named(self, node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) -> ast.AST:
        if not self._program and getattr(node, "top", True):
            node.name = self._chosen.get(node.name, node.name)
        for child in ast.walk(node):
            if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                child.top = False  # type: ignore[union-attr]
        if isinstance(node, ast.ClassDef):
            own = {name for statement in node.body for name in _bound(statement)}
            for name in _class_level(node):
                name.member = name.id in own  # type: ignore[attr-defined]
        self.generic_visit(node)
        return node

    visit_FunctionDef = visit_AsyncFunctionDef = visit_ClassDef = _named  # noqa: N815 - ast's names

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.AST:
        if self._program and node.module == "roslet":
            for alias in node.names:
                alias.asname = alias.asname or alias.name
                alias.name = self._chosen.get(alias.name, alias.name)
        return node


class _Names:
    def __init__(self, pieces: Iterable[ast.Module]) -> None:
        self.pieces = list(pieces)
        self.short: set[str] = set()
        self._kept: set[str] = set()
        self._families: dict[str, str] = {}  # class -> the first of its relatives
        self._users: dict[str, set[str]] = {}  # member -> families that use it on themselves
        self._defined: set[str] = set()
        self._foreign: set[str] = set()  # members that are used on something else
        for piece in self.pieces:
            for node in ast.walk(piece):
                if isinstance(node, ast.ClassDef):
                    self._relate(node)
                elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                    self._kept.add(node.value)
        for piece in self.pieces:
            for statement in piece.body:
                if isinstance(statement, ast.ClassDef):
                    self._look(statement, self._family(statement.name))
                else:
                    self._look(statement, "")

    def _family(self, name: str) -> str:
        while self._families.get(name, name) != name:
            name = self._families[name]
        return name

    def _relate(self, node: ast.ClassDef) -> None:
        for base in node.bases:
            if isinstance(base, ast.Name):
                self._families[self._family(base.id)] = self._family(node.name)

    def _look(self, node: ast.AST, family: str) -> None:
        for one in ast.walk(node):
            if isinstance(one, ast.Attribute):
                own = isinstance(one.value, ast.Name) and one.value.id in ("self", "cls") and family
                self._used(one.attr, family if own else "")
                if own and isinstance(one.ctx, ast.Store):
                    self._defined.add(one.attr)
            elif isinstance(one, ast.ClassDef):
                for statement in one.body:
                    for name in _bound(statement):
                        self._used(name, family)
                        self._defined.add(name)
            elif isinstance(one, ast.keyword) and one.arg:
                self._kept.add(one.arg)

    def _used(self, name: str, family: str) -> None:
        if family and _is_private(name):
            self._users.setdefault(name, set()).add(family)
        else:
            self._foreign.add(name)

    def keep(self, program: ast.Module) -> None:
        for node in ast.walk(program):
            if isinstance(node, ast.Attribute):
                self._kept.add(node.attr)
            elif isinstance(node, ast.FunctionDef | ast.ClassDef):
                self._kept.add(node.name)

    def rename(self) -> dict[str, str]:
        taken: dict[str, set[str]] = {}  # short name -> families that have it
        chosen: dict[str, str] = {}
        every = sorted(set(self._users) | self._foreign)
        # The widely used first: they leave the fewest choices.
        every.sort(key=lambda name: (name not in self._foreign, -len(self._users.get(name, ()))))
        families = {self._family(name) for name in self._families} | {""}
        for users in self._users.values():
            families |= users
        for name in every:
            if name in self._kept or name not in self._defined or not _is_private(name):
                continue
            # What is used on something else might be anybody's.
            users = families if name in self._foreign else self._users[name]
            number = 0
            while taken.get(_short(number), set()) & users or _short(number) in self._kept:
                number += 1
            self.short.add(_short(number))
            if len(_short(number)) >= len(name):
                continue
            chosen[name] = _short(number)
            taken.setdefault(chosen[name], set()).update(users)
        for piece in self.pieces:
            _Renamer(chosen).visit(piece)
        return chosen


class _Renamer(ast.NodeTransformer):
    def __init__(self, chosen: dict[str, str]) -> None:
        self._chosen = chosen

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        self.generic_visit(node)
        node.attr = self._chosen.get(node.attr, node.attr)
        return node

    def visit_ClassDef(self, node: ast.ClassDef) -> ast.AST:
        renamed = {}
        for statement in node.body:
            for name in _bound(statement):
                if name in self._chosen:
                    renamed[name] = self._chosen[name]
            if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef):
                statement.name = renamed.get(statement.name, statement.name)
        for one in _class_level(node):
            one.id = renamed.get(one.id, one.id)
        self.generic_visit(node)
        return node


def _class_level(node: ast.ClassDef) -> list[ast.Name]:
    """The names in a class's own statements, and in the decorators of its methods."""
    pieces: list[ast.AST] = []
    for statement in node.body:
        if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef):
            pieces += statement.decorator_list
        else:
            pieces.append(statement)
    return [one for piece in pieces for one in ast.walk(piece) if isinstance(one, ast.Name)]


def _bound(statement: ast.stmt) -> list[str]:
    if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef):
        return [statement.name]
    if isinstance(statement, ast.Assign):
        return [one.id for one in statement.targets if isinstance(one, ast.Name)]
    return []


def _is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__") and name.isidentifier()


def _short(number: int) -> str:
    found = ""
    while True:
        number, digit = divmod(number, len(_DIGITS))
        found = _DIGITS[digit] + found
        if not number:
            return "_" + found
        number -= 1
