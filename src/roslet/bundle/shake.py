"""What a program reaches, module by module and name by name; the rest is left out.

What a module defines is live where live code mentions it. A method or class attribute of a live class is live where live
code has an attribute of its name, whoever's: more than is needed, and never less, as long as names are not made up at run
time; those given to `getattr` are seen. Importing a module of roslet has no effect but its names, so a module of
which no name is live is left out.
"""

from __future__ import annotations

import ast

from roslet.bundle.source import (
    Function,
    Inliner,
    Mentions,
    Module,
    collect_constants,
    locate,
)

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

Statement = ast.stmt


class _Definition:
    """A function, class, method or constant that is kept if its name is live, within what `owner` says is live."""

    def __init__(
        self, node: Statement, scanned: list[ast.AST], module: Module, owner: ast.ClassDef | None
    ) -> None:
        self.node = node
        self.scanned = scanned
        self.module = module
        self.owner = owner
        self.live = False


class Shaker:
    """`entry` is the program, all of which is live; `texts` are modules that are made, by name; `excluded` those that are
    never taken, nor what is below them; `replaced`: the module that stands for another; `bounds`: by module, constants that
    have another value here; `folds`: names of flags; `stubs`: functions ("module:name") that are never reached here."""

    def __init__(
        self,
        entry: str,
        texts: Mapping[str, str],
        *,
        excluded: Iterable[str] = (),
        replaced: Mapping[str, str] | None = None,
        bounds: Mapping[str, Mapping[str, int]] | None = None,
        folds: Mapping[str, bool] | None = None,
        stubs: Iterable[str] = (),
        dropped: Iterable[str] = (),
        roots: Iterable[str] = (),
        known: dict[str, Module | None] | None = None,
    ) -> None:
        self._texts = texts
        self._excluded = tuple(excluded)
        self._replaced = dict(replaced or {})
        self._bounds = bounds or {}
        self._folds = folds or {}
        self._stubs = frozenset(stubs)
        self._dropped = frozenset(dropped)
        self._modules: dict[str, Module | None] = {} if known is None else known
        for name in texts:
            self._modules.pop(name, None)
        self._entered: dict[str, Module] = {}
        self._tops: dict[tuple[str, str], _Definition] = {}  # by module and name
        self._members: dict[str, list[_Definition]] = {}  # of live classes, by name
        self._members_live: set[str] = set()
        self._escaped: set[str] = set()
        self._of: dict[int, _Definition] = {}  # by statement
        self._alias_tables: dict[str, dict[str, list[tuple[str, str]]]] = {}
        self._waiting: list[tuple[ast.AST, Module, ast.ClassDef | None]] = []
        program = Module("__main__", entry)
        self._modules["__main__"] = program
        self._prepare(program)
        self._entered["__main__"] = program
        for statement in program.tree.body:
            self._waiting.append((statement, program, None))
        for name in roots:
            root = self.module(name)
            if root is not None:
                self._enter(root)
                for (module, _), definition in list(self._tops.items()):
                    if module == name and name != "roslet":
                        self._keep(definition)
        self._run()

    # -- modules

    def module(self, name: str) -> Module | None:
        """A module that there is, and that is not excluded."""
        name = self._replaced.get(name, name)
        if name not in self._modules:
            self._modules[name] = self._load(name)
        return self._modules[name]

    def _load(self, name: str) -> Module | None:
        if not name.startswith("roslet") or any(
            name == one or name.startswith(one + ".") for one in self._excluded
        ):
            return None
        if name in self._texts:
            package = any(other.startswith(name + ".") for other in self._texts)
            module = Module(name, self._texts[name], package)
        else:
            path = locate(name)
            if path is None:
                return None
            module = Module(name, path.read_text(encoding="utf-8"), path.name == "__init__.py")
        self._modules[name] = module
        self._prepare(module)
        return module

    def _prepare(self, module: Module) -> None:
        """Make imports absolute and direct, and constants numbers."""
        module.tree.body = [made for one in module.tree.body for made in self._direct(one, module)]
        for function in ast.walk(module.tree):
            if isinstance(function, (*Function, ast.If, ast.Try)):
                function.body = [made for one in function.body for made in self._direct(one, module)] or [
                    ast.Pass()
                ]
        names: dict[str, int] = {}
        modules: dict[str, Mapping[str, int]] = {}
        for statement in module.tree.body:
            if isinstance(statement, ast.ImportFrom) and statement.module:
                for alias in statement.names:
                    here = alias.asname or alias.name
                    other = self.module(statement.module + "." + alias.name)
                    if other is not None:
                        modules[here] = other.constants
                    else:
                        source = self.module(statement.module)
                        if source is not None and alias.name in source.constants:
                            names[here] = source.constants[alias.name]
        module.constants.update(names)
        collect_constants(module, self._bounds.get(module.name, {}))
        names = dict(module.constants)
        Inliner(names, modules, self._folds).visit(module.tree)
        if self._stubs:
            for node in ast.walk(module.tree):
                if isinstance(node, ast.FunctionDef) and module.name + ":" + node.name in self._stubs:
                    node.body = [ast.Raise(ast.Name("NotImplementedError", ast.Load()), None)]
        ast.fix_missing_locations(module.tree)

    def _direct(self, node: Statement, module: Module) -> list[Statement]:
        """An import of roslet, from where each name is defined; nothing where that is excluded."""
        if not isinstance(node, ast.ImportFrom):
            return [node]
        source = self._absolute(node, module)
        if not source.startswith("roslet"):
            return [node]
        made: dict[str, list[ast.alias]] = {}
        for alias in node.names:
            home = self._home(source, alias.name)
            if home is not None:
                made.setdefault(home, []).append(alias)
        if not made and any(source == one or source.startswith(one + ".") for one in self._excluded):
            said = ast.Constant("%s is not in this bundle" % source)
            if node in module.tree.body:
                return []
            return [ast.Raise(ast.Call(ast.Name("ImportError", ast.Load()), [said], []), None)]
        return [ast.ImportFrom(home, names, 0) for home, names in made.items()]

    def _absolute(self, node: ast.ImportFrom, module: Module) -> str:
        if not node.level:
            return node.module or ""
        parts = module.name.split(".")
        parts = parts[: len(parts) - node.level + module.package]
        return ".".join(parts + ([node.module] if node.module else []))

    def _home(self, source: str, name: str) -> str | None:
        """The module in which `name` of `source` is to be found; None where it is excluded."""
        if locate(source + "." + name) is not None or source + "." + name in self._texts:
            replaced = self._replaced.get(source + "." + name)
            if replaced is not None:
                return replaced.rpartition(".")[0]
            return source if self.module(source + "." + name) is not None else None
        source = self._replaced.get(source, source)
        found = self.module(source)
        if found is None:
            return None
        if found.package:
            for statement in found.tree.body:
                if isinstance(statement, ast.ImportFrom) and statement.module:
                    for alias in statement.names:
                        if (alias.asname or alias.name) == name and alias.name == name:
                            return self._home(statement.module, name)
        return source

    # -- marking

    def _run(self) -> None:
        while self._waiting:
            piece, module, owner = self._waiting.pop()
            mentions = Mentions(piece)
            for name in mentions.names:
                self._name(name, module, owner)
            for base, attribute in mentions.attributes:
                self._attribute(base, attribute, module)
            for node in mentions.imports:
                self._import(node)

    def _name(self, name: str, module: Module, owner: ast.ClassDef | None) -> None:
        """A free name in a module, or in the body of a class."""
        found = self._tops.get((module.name, name))
        if found is not None:
            self._keep(found)
        if owner is not None and name not in self._members_live:
            self._member(name)
        for source, there in self._aliases(module).get(name, ()):
            self._imported(source, there)
            escaped = self.module(source + "." + there)
            if escaped is not None and escaped.name not in self._escaped:
                # A module as an object: what it defines is like the members of a class.
                self._escaped.add(escaped.name)
                for (home, member), definition in list(self._tops.items()):
                    if home == escaped.name:
                        self._members.setdefault(member, []).append(definition)
                        if member in self._members_live:
                            self._keep(definition)

    def _attribute(self, base: str, attribute: str, module: Module) -> None:
        """`base.attribute`, where `base` is the name of a module, else "" and anything may have the attribute."""
        sources = self._aliases(module).get(base, ()) if base else ()
        modules = [source + "." + there if there else source for source, there in sources]
        modules = [one for one in modules if self.module(one) is not None]
        if not modules:
            self._member(attribute)
            if base:
                self._name(base, module, None)
        for one in modules:
            self._imported(one, attribute)

    def _member(self, name: str) -> None:
        if name not in self._members_live:
            self._members_live.add(name)
            for definition in self._members.get(name, ()):
                self._keep(definition)

    def _keep(self, definition: _Definition) -> None:
        if not definition.live:
            definition.live = True
            for piece in definition.scanned:
                self._waiting.append((piece, definition.module, definition.owner))
            if isinstance(definition.node, ast.ClassDef):
                for statement in definition.node.body:
                    self._define_member(statement, definition.module, definition.node)

    def _aliases(self, module: Module) -> dict[str, list[tuple[str, str]]]:
        """What imports of a module, wherever they are, call by which name: (module, name in it), or (module, "")."""
        found = self._alias_tables.get(module.name)
        if found is None:
            found = self._alias_tables[module.name] = {}
            for node in ast.walk(module.tree):
                if isinstance(node, ast.ImportFrom) and node.module:
                    for alias in node.names:
                        found.setdefault(alias.asname or alias.name, []).append((node.module, alias.name))
                elif isinstance(node, ast.Import):
                    for alias in node.names:
                        found.setdefault(alias.asname or alias.name.partition(".")[0], []).append(
                            (alias.name, "")
                        )
        return found

    def _import(self, node: ast.Import | ast.ImportFrom) -> None:
        """One that is always done when its statement is reached: the module is entered, what is named is looked at when it
        is used."""
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else [node.module or ""]
        for name in names:
            found = self.module(name)
            if found is not None:
                self._enter(found)

    def _imported(self, source: str, name: str) -> None:
        submodule = self.module(source + "." + name) if name else self.module(source)
        if submodule is not None:
            self._enter(submodule)
            return
        module = self.module(source)
        if module is not None:
            self._enter(module)
            found = self._tops.get((module.name, name))
            if found is not None:
                self._keep(found)
            else:
                for there, other in self._aliases(module).get(name, ()):
                    self._imported(there, other)

    def _enter(self, module: Module) -> None:
        if module.name in self._entered:
            return
        self._entered[module.name] = module
        for statement in module.tree.body:
            name = _defined(statement)
            if name is not None:
                self._tops[module.name, name] = self._definition(statement, module, None)
            elif not isinstance(statement, ast.ImportFrom | ast.Import):
                self._waiting.append((statement, module, None))

    def _definition(self, statement: Statement, module: Module, owner: ast.ClassDef | None) -> _Definition:
        scanned: list[ast.AST] = [statement]
        if isinstance(statement, ast.ClassDef):
            scanned = [*statement.bases, *statement.decorator_list]
        definition = self._of[id(statement)] = _Definition(statement, scanned, module, owner)
        return definition

    def _define_member(self, statement: Statement, module: Module, owner: ast.ClassDef) -> None:
        name = _defined(statement)
        if name is None:
            self._waiting.append((statement, module, owner))
            return
        definition = self._definition(statement, module, owner)
        if module.name + ":" + name in self._dropped:
            return
        self._members.setdefault(name, []).append(definition)
        if name in self._members_live or name.startswith("__"):
            self._keep(definition)

    # -- the result

    def reaches(self, module: str) -> bool:
        """Whether a module is needed."""
        return module in self._entered

    @property
    def program(self) -> ast.Module:
        """The program's tree."""
        return self._entered["__main__"].tree

    def trees(self) -> dict[str, ast.Module]:
        """What is left of each module that is needed."""
        found = {}
        for name, module in sorted(self._entered.items()):
            if name == "__main__":
                continue
            found[name] = ast.Module(self._filtered(module.tree.body), [])
        return found

    def _filtered(self, body: list[Statement]) -> list[Statement]:
        found: list[Statement] = []
        for statement in body:
            definition = self._of.get(id(statement))
            if definition is not None and not definition.live:
                continue
            if isinstance(statement, ast.ClassDef):
                statement.body = self._filtered(statement.body) or [ast.Pass()]
            found.append(statement)
        return found


def _defined(statement: Statement) -> str | None:
    """The name that a statement defines and does nothing else."""
    if isinstance(statement, (*Function, ast.ClassDef)):
        return statement.name
    if (
        isinstance(statement, ast.Assign)
        and len(statement.targets) == 1
        and isinstance(statement.targets[0], ast.Name)
    ):
        return statement.targets[0].id
    return None
