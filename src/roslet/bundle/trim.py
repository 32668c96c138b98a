"""What a board can do without: the sentences of protocol errors, attributes that nobody reads, constants that serve once.

Works on the pieces of a linked module, whose names are those of the whole.
"""

from __future__ import annotations

import ast

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence


def trim(pieces: Sequence[ast.Module], program: ast.Module) -> None:
    """Trim the pieces, which follow each other in this order."""
    for piece in pieces:
        _Terse().visit(piece)
    for _ in range(2):  # what was stored may have been the last to read something else
        stores = _DeadStores([*pieces, program])
        for piece in pieces:
            stores.visit(piece)
    for _ in range(3):  # what was prepared for nobody may have been all that a function was for
        _drop_unread(pieces, program)
    _inline([*pieces, program])


# What makes functions of formats, and does nothing else.
_PREPARING = ("bytes_packer", "number_packers", "packer", "text_bytes_packers", "unpacker")


def _drop_unread(pieces: Sequence[ast.Module], program: ast.Module) -> None:
    """Take out what is prepared for methods that are not there: `_make0 = bytes_packer("<I")`."""
    read = {
        node.id
        for tree in [*pieces, program]
        for node in ast.walk(tree)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)
    }
    for piece in pieces:
        piece.body = [one for one in piece.body if _prepares(one) is None or _prepares(one) in read] or [
            ast.Pass()
        ]


def _prepares(statement: ast.stmt) -> str | None:
    """The name that a statement defines, if that is one of those functions, or what one of them makes."""
    if isinstance(statement, ast.FunctionDef) and statement.name in _PREPARING:
        return statement.name
    if isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Call):
        target, made = statement.targets[0], statement.value.func
        if isinstance(target, ast.Name) and isinstance(made, ast.Name) and made.id in _PREPARING:
            return target.id
    return None


class _Terse(ast.NodeTransformer):
    """Of a ProtocolError the reason is enough: it is counted under that name."""

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        if isinstance(node.func, ast.Name) and node.func.id == "ProtocolError" and len(node.args) > 1:
            node.args = node.args[:1]
        return node


class _DeadStores(ast.NodeTransformer):
    """Takes out `self.name = value` where nothing reads `name`, and making the value does nothing."""

    def __init__(self, trees: Sequence[ast.Module]) -> None:
        self._read: set[str] = set()
        for tree in trees:
            for node in ast.walk(tree):
                if isinstance(node, ast.Attribute) and not isinstance(node.ctx, ast.Store):
                    self._read.add(node.attr)
                elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Attribute):
                    self._read.add(node.target.attr)
                elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                    self._read.add(node.value)

    def visit_Assign(self, node: ast.Assign) -> ast.AST | None:
        target = node.targets[0]
        if (
            len(node.targets) == 1
            and isinstance(target, ast.Attribute)
            and isinstance(target.value, ast.Name)
            and target.attr not in self._read
            and _is_plain(node.value)
        ):
            return ast.Pass()
        return node


def _is_plain(node: ast.expr) -> bool:
    """Whether evaluating it does nothing."""
    if isinstance(node, ast.Attribute):
        return _is_plain(node.value)
    if isinstance(node, ast.Tuple | ast.List):
        return all(_is_plain(one) for one in node.elts)
    if isinstance(node, ast.Dict):
        return not node.keys
    return isinstance(node, ast.Name | ast.Constant)


def _inline(trees: Sequence[ast.Module]) -> None:
    """Put what a module's constant is where it is used, if that is one place outside of functions."""
    counts: dict[str, int] = {}
    for tree in trees:
        for node in ast.walk(tree):
            if isinstance(node, ast.Name):
                counts[node.id] = counts.get(node.id, 0) + 1
            elif isinstance(node, ast.alias):
                counts[node.name] = counts.get(node.name, 0) + 2
    for tree in trees[:-1]:
        values: dict[str, ast.expr] = {}
        kept: list[ast.stmt] = []
        for statement in tree.body:
            if (
                isinstance(statement, ast.Assign)
                and isinstance(statement.targets[0], ast.Name)
                and len(statement.targets) == 1
                and counts[statement.targets[0].id] == 2
            ):
                statement.value = _Placer(values).visit(statement.value)
                values[statement.targets[0].id] = statement.value
            else:
                _Placer(values).visit(statement)
            kept.append(statement)
        used = {name for name, value in values.items() if not _remains(tree, name)}
        tree.body = [
            one
            for one in kept
            if not (
                isinstance(one, ast.Assign)
                and isinstance(one.targets[0], ast.Name)
                and one.targets[0].id in used
            )
        ]


def _remains(tree: ast.Module, name: str) -> bool:
    """Whether a name is still used: in a function, or in another module."""
    return not any(getattr(node, "placed", "") == name for node in ast.walk(tree))


class _Placer(ast.NodeTransformer):
    """Puts values in the place of names, but in functions, which are called later and often."""

    def __init__(self, values: dict[str, ast.expr]) -> None:
        self._values = values

    def _leave(self, node: ast.AST) -> ast.AST:
        return node

    visit_FunctionDef = visit_AsyncFunctionDef = visit_Lambda = _leave  # noqa: N815 - ast's names
    visit_ListComp = visit_SetComp = visit_DictComp = visit_GeneratorExp = _leave  # noqa: N815

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if isinstance(node.ctx, ast.Load) and node.id in self._values:
            value = self._values[node.id]
            value.placed = node.id  # type: ignore[attr-defined]
            return value
        return node
