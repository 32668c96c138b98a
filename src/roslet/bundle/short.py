"""Short names for private members. Classes that have nothing to do with each other share them: each name that there is costs a
board some thirty bytes of its heap, and its letters in flash.
"""

from __future__ import annotations

import ast

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable

_DIGITS = "abcdefghijklmnopqrstuvwxyz0123456789"


def shorten(pieces: Iterable[ast.Module], program: ast.Module) -> None:
    """Rename the private members of the classes in `pieces`. Names that the program has, and those that are somewhere a text,
    stay."""
    names = _Names(pieces)
    names.keep(program)
    names.rename()


class _Names:
    def __init__(self, pieces: Iterable[ast.Module]) -> None:
        self._pieces = list(pieces)
        self._kept: set[str] = set()
        self._families: dict[str, str] = {}  # class -> the first of its relatives
        self._users: dict[str, set[str]] = {}  # member -> families that use it on themselves
        self._foreign: set[str] = set()  # members that are used on something else
        for piece in self._pieces:
            for node in ast.walk(piece):
                if isinstance(node, ast.ClassDef):
                    self._relate(node)
                elif isinstance(node, ast.Constant) and isinstance(node.value, str) and _is_private(node.value):
                    self._kept.add(node.value)
        for piece in self._pieces:
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
            if isinstance(one, ast.Attribute) and _is_private(one.attr):
                own = isinstance(one.value, ast.Name) and one.value.id in ("self", "cls") and family
                self._used(one.attr, family if own else "")
            elif isinstance(one, ast.ClassDef):
                for statement in one.body:
                    for name in _bound(statement):
                        if _is_private(name):
                            self._used(name, family)
            elif isinstance(one, ast.keyword) and one.arg and _is_private(one.arg):
                self._kept.add(one.arg)

    def _used(self, name: str, family: str) -> None:
        if family:
            self._users.setdefault(name, set()).add(family)
        else:
            self._foreign.add(name)

    def keep(self, program: ast.Module) -> None:
        for node in ast.walk(program):
            if isinstance(node, ast.Attribute):
                self._kept.add(node.attr)
            elif isinstance(node, ast.FunctionDef | ast.ClassDef):
                self._kept.add(node.name)

    def rename(self) -> None:
        taken: dict[str, set[str]] = {}  # short name -> families that have it
        chosen: dict[str, str] = {}
        every = sorted(set(self._users) | self._foreign)
        # The widely used first: they leave the fewest choices.
        every.sort(key=lambda name: (name not in self._foreign, -len(self._users.get(name, ()))))
        families = {self._family(name) for name in self._families} | {""}
        for users in self._users.values():
            families |= users
        for name in every:
            if name in self._kept:
                continue
            # What is used on something else might be anybody's.
            users = families if name in self._foreign else self._users[name]
            number = 0
            while taken.get(_short(number), set()) & users or _short(number) in self._kept:
                number += 1
            chosen[name] = _short(number)
            taken.setdefault(chosen[name], set()).update(users)
        for piece in self._pieces:
            _Renamer(chosen).visit(piece)


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
        for statement in node.body:
            if not isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef):
                for one in ast.walk(statement):
                    if isinstance(one, ast.Name) and one.id in renamed:
                        one.id = renamed[one.id]
        self.generic_visit(node)
        return node


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
