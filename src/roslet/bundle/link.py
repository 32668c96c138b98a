"""Makes one module of many: each name is stored once, and an import costs nothing.

Top-level names that several modules have are told apart by a number; none is like a local variable or a builtin, so that
nothing is hidden. Modules follow each other as importing them would run them.
"""

from __future__ import annotations

import ast
import builtins

from roslet.bundle.short import shorten
from roslet.bundle.source import Scope, bound_names
from roslet.bundle.trim import trim

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    Alias = tuple[str, str]  # a module and a name in it, or a module and ""

ROOT = "roslet"


class Linker:
    """`trees`: module -> what is left of it, imports made direct; `program` the same of the program. `public` are names of
    the module `roslet` that keep their names, `first` the modules with which running begins."""

    def __init__(
        self,
        trees: Mapping[str, ast.Module],
        program: ast.Module,
        public: Iterable[str],
        first: Iterable[str],
    ) -> None:
        self._trees = trees
        self._aliases = {name: _aliases(tree, trees) for name, tree in trees.items()}
        self._tops = {name: _top_names(tree) for name, tree in trees.items()}
        self._spaces: set[str] = set()
        self.order: list[str] = []
        self._visiting: set[str] = set()
        for name in [*first, *sorted(trees)]:
            self._visit(name)
        self._globals: dict[str, dict[str, str]] = {}
        self._outer: dict[tuple[str, str], str] = {}  # of modules that are not roslet's
        self._imports: dict[str, ast.stmt] = {}
        taken = set(dir(builtins))
        for tree in [*trees.values(), program]:
            taken |= _locals(tree)
        self._name(taken, set(public))
        self.pieces: dict[str, ast.Module] = {}
        for name in self.order:
            body = _Rewriter(self, name).body(trees[name].body)
            if body:
                self.pieces[name] = ast.fix_missing_locations(ast.Module(body, []))
        self.program = self._rewritten(program)
        trim([self.pieces[name] for name in self.order if name in self.pieces], program)
        kept = {*public, *self._outer.values()}
        self._members, self._short = shorten(
            [self.pieces[name] for name in self.order if name in self.pieces], program, kept
        )

    def text(self) -> str:
        """The one module."""
        parts = [ast.unparse(ast.Module(list(self._imports.values()), []))]
        for name in self.order:
            if name in self.pieces:
                parts.append(ast.unparse(self.pieces[name]))
            if name in self._spaces:
                parts.append(self._space(name))
        return "\n".join(parts) + "\n"

    # -- order

    def _visit(self, name: str) -> None:
        if name in self.order or name not in self._trees or name in self._visiting:
            return
        self._visiting.add(name)
        for statement in self._trees[name].body:
            if isinstance(statement, ast.ImportFrom) and statement.module:
                for alias in statement.names:
                    inner = statement.module + "." + alias.name
                    self._visit(inner if inner in self._trees else statement.module)
        self.order.append(name)

    # -- names

    def _name(self, taken: set[str], public: set[str]) -> None:
        homes: dict[Alias, str] = {}
        for name in sorted(public):
            home = self._resolve(ROOT, name)
            if home is not None:
                homes[home] = name
                taken.add(name)
        for module in self.order:
            table = self._globals[module] = {}
            for name in self._tops[module]:
                table[name] = homes.get((module, name)) or _free(name, taken)
                taken.add(table[name])
        for module in self.order:
            for statement in self._trees[module].body:
                if isinstance(statement, ast.Import | ast.ImportFrom):
                    self._outside(statement, taken)

    def _outside(self, statement: ast.Import | ast.ImportFrom, taken: set[str]) -> None:
        source = statement.module or "" if isinstance(statement, ast.ImportFrom) else ""
        for alias in statement.names:
            if (source or alias.name).startswith(ROOT) or (source, alias.name) in self._outer:
                continue
            name = self._outer[source, alias.name] = _free(alias.asname or alias.name, taken)
            taken.add(name)
            made = ast.alias(alias.name, name if name != alias.name else None)
            self._imports[name] = ast.ImportFrom(source, [made], 0) if source else ast.Import([made])

    def _resolve(self, module: str, name: str) -> Alias | None:
        """Where a name of a module is defined."""
        if name in self._tops.get(module, ()):
            return module, name
        found = self._aliases.get(module, {}).get(name)
        if found is None:
            return None
        return self._resolve(*found) if found[1] else found

    def find(self, module: str, name: str) -> ast.expr | str | None:
        """What stands for a free name of a module: an expression, the module that it is, or None where it is a builtin."""
        outer = self._outside_of(module, name)
        if outer is not None:
            return ast.Name(outer, ast.Load())
        found = self._resolve(module, name)
        if found is None:
            return None
        if not found[1]:
            return found[0]
        return ast.Name(self._globals[found[0]][found[1]], ast.Load())

    def member(self, module: str, name: str) -> ast.expr | str | None:
        """What `name` of a module is, or the module below it."""
        if module + "." + name in self._trees:
            return module + "." + name
        return self.find(module, name)

    def top(self, module: str, name: str) -> str:
        """The name here of a name that a module defines."""
        return self._globals[module][name]

    def space(self, module: str) -> ast.expr:
        """A module as an object."""
        self._spaces.add(module)
        return ast.Name(_space_name(module), ast.Load())

    def _space(self, module: str) -> str:
        lines = ["class %s:" % _space_name(module)]
        for name in self._tops[module]:
            here = self._globals[module][name]
            lines.append("    %s = %s" % (self._members.get(name, name), self._short.get(here, here)))
        return "\n".join(lines)

    def _outside_of(self, module: str, name: str) -> str | None:
        for statement in self._trees[module].body:
            if isinstance(statement, ast.Import | ast.ImportFrom):
                source = statement.module or "" if isinstance(statement, ast.ImportFrom) else ""
                for alias in statement.names:
                    if (alias.asname or alias.name) == name and not (source or alias.name).startswith(ROOT):
                        return self._outer[source, alias.name]
        return None

    def _rewritten(self, program: ast.Module) -> ast.Module:
        """The program, which imports everything from the one module."""
        for node in ast.walk(program):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(ROOT):
                assert node.module is not None
                for alias in node.names:
                    home = self._resolve(node.module, alias.name)
                    if home is not None and home[1]:
                        alias.asname = alias.asname or alias.name
                        alias.name = self._globals[home[0]][home[1]]
                node.module = ROOT
        return program


class _Rewriter(ast.NodeTransformer):
    """Gives the names of one module their names in the whole."""

    def __init__(self, linker: Linker, module: str) -> None:
        self._linker = linker
        self._module = module
        self._own: list[set[str]] = []

    def body(self, statements: list[ast.stmt]) -> list[ast.stmt]:
        """Of the module."""
        found = []
        for statement in statements:
            if not isinstance(statement, ast.Import | ast.ImportFrom):
                found.append(self.visit(statement))
        return found

    def _is_own(self, name: str) -> bool:
        return any(name in names for names in self._own)

    def _scope(self, node: ast.AST) -> ast.AST:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) and not self._own:
            node.name = self._linker.top(self._module, node.name)
        if isinstance(node, ast.ClassDef):
            return self._class(node)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            node.decorator_list = [self.visit(one) for one in node.decorator_list]
            node.args.defaults = [self.visit(one) for one in node.args.defaults]
            node.args.kw_defaults = [
                None if one is None else self.visit(one) for one in node.args.kw_defaults
            ]
            self._own.append(bound_names(node))
            node.body = [made for one in node.body for made in _listed(self.visit(one))] or [ast.Pass()]
            self._own.pop()
            return node
        self._own.append(bound_names(node))
        self.generic_visit(node)
        self._own.pop()
        return node

    visit_FunctionDef = visit_AsyncFunctionDef = visit_Lambda = _scope  # noqa: N815 - ast's names
    visit_ListComp = visit_SetComp = visit_DictComp = visit_GeneratorExp = _scope  # noqa: N815
    visit_ClassDef = _scope  # noqa: N815

    def _class(self, node: ast.ClassDef) -> ast.AST:
        node.bases = [self.visit(one) for one in node.bases]
        node.decorator_list = [self.visit(one) for one in node.decorator_list]
        # What the class's own statements say of its names is not for its methods.
        names = {one.name for one in node.body if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)}
        for one in node.body:
            if isinstance(one, ast.Assign):
                names |= {target.id for target in one.targets if isinstance(target, ast.Name)}
        made: list[ast.stmt] = []
        for one in node.body:
            if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef):
                self._own.append(set())
            else:
                self._own.append(names)
            made += _listed(self.visit(one))
            self._own.pop()
        node.body = made or [ast.Pass()]
        return node

    def visit_Global(self, node: ast.Global) -> ast.AST:
        node.names = [self._linker.top(self._module, name) for name in node.names]
        return node

    def visit_ExceptHandler(self, node: ast.ExceptHandler) -> ast.AST:
        self.generic_visit(node)
        if node.name is not None and not self._own:
            node.name = self._linker.top(self._module, node.name)
        return node

    def visit_Name(self, node: ast.Name) -> ast.AST:
        if self._is_own(node.id):
            return node
        if not isinstance(node.ctx, ast.Load):
            return ast.Name(self._linker.top(self._module, node.id), node.ctx)
        found = self._linker.find(self._module, node.id)
        if isinstance(found, str):
            return self._linker.space(found)
        return found or node

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        if isinstance(node.value, ast.Name) and not self._is_own(node.value.id):
            found = self._linker.find(self._module, node.value.id)
            if isinstance(found, str):
                inner = self._linker.member(found, node.attr)
                if inner is None:
                    raise NameError(f"{self._module}: {found} has no {node.attr} in this bundle")
                return self._linker.space(inner) if isinstance(inner, str) else inner
        self.generic_visit(node)
        return node

    def visit_Import(self, node: ast.Import) -> ast.AST:
        for alias in node.names:
            if not self._own:
                alias.asname = self._linker.top(self._module, alias.asname or alias.name)
        return node

    def visit_ImportFrom(self, node: ast.ImportFrom) -> ast.AST | None:
        """One within a function, or an attempt at one."""
        if (node.module or "").startswith(ROOT):
            return None
        for alias in node.names:
            if not self._own:
                alias.asname = self._linker.top(self._module, alias.asname or alias.name)
        return node


def _listed(made: object) -> list[ast.stmt]:
    return made if isinstance(made, list) else [] if made is None else [made]  # type: ignore[list-item]


def _space_name(module: str) -> str:
    return "_" + module.replace(".", "_")


def _free(name: str, taken: set[str]) -> str:
    number = 1
    found = name
    while found in taken:
        number += 1
        found = "%s%d" % (name, number)
    return found


def _aliases(tree: ast.Module, trees: Mapping[str, ast.Module]) -> dict[str, Alias]:
    """What the imports of a module, wherever they are, call by which name."""
    found: dict[str, Alias] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(ROOT):
            assert node.module is not None
            for alias in node.names:
                inner = node.module + "." + alias.name
                found[alias.asname or alias.name] = (
                    (inner, "") if inner in trees else (node.module, alias.name)
                )
    return found


def _top_names(tree: ast.Module) -> list[str]:
    """What a module binds, but for its own imports."""
    found: dict[str, None] = {}
    for statement in tree.body:
        if isinstance(statement, ast.Import | ast.ImportFrom):
            continue
        pieces: list[ast.AST] = [statement]
        while pieces:
            node = pieces.pop()
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
                found[node.name] = None
                continue
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                found[node.id] = None
            elif isinstance(node, ast.ExceptHandler) and node.name:
                found[node.name] = None
            elif isinstance(node, ast.Import | ast.ImportFrom):
                found.update(dict.fromkeys(alias.asname or alias.name for alias in node.names))
            if not isinstance(node, Scope):
                pieces.extend(ast.iter_child_nodes(node))
    return list(found)


def _locals(tree: ast.Module) -> set[str]:
    """The names of all local variables."""
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, Scope):
            found |= bound_names(node)
            for inner in ast.walk(node):
                if isinstance(inner, ast.Import | ast.ImportFrom) and not _of_roslet(inner):
                    found |= {alias.asname or alias.name for alias in inner.names}
    return found


def _of_roslet(node: ast.Import | ast.ImportFrom) -> bool:
    return isinstance(node, ast.ImportFrom) and (node.module or "").startswith(ROOT)
