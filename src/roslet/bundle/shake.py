"""What a program reaches, module by module and name by name; the rest is left out.

A name is live where live code mentions it, whoever's it is: a method is kept when any live code has an attribute of its
name. That is more than is needed, and never less, as long as names are not made up at run time; those given to `getattr`
are seen. Importing a module of roslet has no effect but its names, so a module of which no name is live is left out.
"""

from __future__ import annotations

import ast

from roslet.bundle.source import Function, Inliner, Module, collect_constants, locate, names_in

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

Statement = ast.stmt


class _Definition:
    """A function, class, method or constant that is kept if its name is live, within what `owner` says is live."""

    def __init__(self, node: Statement, scanned: list[ast.AST]) -> None:
        self.node = node
        self.scanned = scanned
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
        roots: Iterable[str] = (),
        names: Iterable[str] = (),
    ) -> None:
        self._texts = texts
        self._excluded = tuple(excluded)
        self._replaced = dict(replaced or {})
        self._bounds = bounds or {}
        self._folds = folds or {}
        self._stubs = frozenset(stubs)
        self._modules: dict[str, Module | None] = {}
        self._entered: dict[str, Module] = {}
        self._live: set[str] = set()
        self._by_name: dict[str, list[_Definition]] = {}
        self._of: dict[int, _Definition] = {}
        self._imports: dict[str, list[tuple[Module, str, str]]] = {}  # local name -> (module, imported from, name there)
        self._waiting: list[ast.AST] = []
        program = Module("__main__", entry)
        self._modules["__main__"] = program
        self._prepare(program)
        self._entered["__main__"] = program
        for statement in program.tree.body:
            self._scan_imports([statement], program)
        self._waiting.extend(program.tree.body)
        for name in names:
            self._reach(name)
        for name in roots:
            root = self.module(name)
            if root is not None:
                self._enter(root)
        self._run()

    # -- modules

    def module(self, name: str) -> Module | None:
        """A module that there is, and that is not excluded."""
        name = self._replaced.get(name, name)
        if name not in self._modules:
            self._modules[name] = self._load(name)
        return self._modules[name]

    def _load(self, name: str) -> Module | None:
        if not name.startswith("roslet") or any(name == one or name.startswith(one + ".") for one in self._excluded):
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
        module.tree.body = [
            made for one in module.tree.body for made in self._direct(one, module)
        ]
        for function in ast.walk(module.tree):
            if isinstance(function, (*Function, ast.If, ast.Try)):
                function.body = [made for one in function.body for made in self._direct(one, module)] or [ast.Pass()]
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
            piece = self._waiting.pop()
            for name in names_in([piece]):
                self._reach(name)

    def _reach(self, name: str) -> None:
        if name in self._live:
            return
        self._live.add(name)
        for definition in self._by_name.get(name, ()):
            self._keep(definition)
        for _, source, there in self._imports.get(name, ()):
            self._imported(source, there)

    def _keep(self, definition: _Definition) -> None:
        if not definition.live:
            definition.live = True
            self._waiting.extend(definition.scanned)
            for piece in definition.scanned:
                self._scan_imports([piece], None)
            if isinstance(definition.node, ast.ClassDef):
                self._enter_class(definition.node)

    def _imported(self, source: str, name: str) -> None:
        submodule = self.module(source + "." + name)
        if submodule is not None:
            self._enter(submodule)
            return
        module = self.module(source)
        if module is not None:
            self._enter(module)
            self._reach(name)

    def _enter(self, module: Module) -> None:
        if module.name in self._entered:
            return
        self._entered[module.name] = module
        parent = module.name.rpartition(".")[0]
        if parent:
            above = self.module(parent)
            if above is not None:
                self._enter(above)
        for statement in module.tree.body:
            self._define(statement, module)

    def _define(self, statement: Statement, module: Module | None) -> None:
        name = _defined(statement)
        if name is not None:
            self._add(name, statement)
        elif isinstance(statement, ast.ImportFrom | ast.Import):
            self._scan_imports([statement], module)
        else:
            self._scan_imports([statement], None)
            self._waiting.append(statement)

    def _add(self, name: str, statement: Statement) -> None:
        scanned: list[ast.AST] = [statement]
        if isinstance(statement, ast.ClassDef):
            scanned = [*statement.bases, *statement.decorator_list]
        definition = _Definition(statement, scanned)
        self._of[id(statement)] = definition
        self._by_name.setdefault(name, []).append(definition)
        if name in self._live or (name.startswith("__") and name not in ("__repr__", "__str__")):
            self._keep(definition)

    def _enter_class(self, node: ast.ClassDef) -> None:
        for statement in node.body:
            self._define(statement, None)

    def _scan_imports(self, pieces: Iterable[ast.AST], module: Module | None) -> None:
        """Imports that are always done (`module` None, or the program), or where their names are live."""
        for piece in pieces:
            for node in ast.walk(piece):
                if isinstance(node, ast.Import):
                    for alias in node.names:
                        found = self.module(alias.name)
                        if found is not None:
                            self._enter(found)
                elif isinstance(node, ast.ImportFrom) and node.module:
                    for alias in node.names:
                        here = alias.asname or alias.name
                        if module is None or module.name == "__main__" or here in self._live:
                            self._imported(node.module, alias.name)
                        else:
                            self._imports.setdefault(here, []).append((module, node.module, alias.name))

    # -- the result

    @property
    def modules(self) -> list[str]:
        """The modules that are needed, without the program."""
        return sorted(name for name in self._entered if name != "__main__")

    def is_package(self, name: str) -> bool:
        """Whether it is a package's `__init__`."""
        return self._entered[name].package

    def reaches(self, name: str) -> bool:
        """Whether live code mentions a name."""
        return name in self._live

    def text(self, name: str) -> str:
        """What is left of a module's text."""
        module = self._entered[name]
        if name == "__main__":
            return ast.unparse(module.tree) + "\n"
        body = module.tree.body
        if module.package and name != "roslet" and name not in self._texts:
            # Whoever wants what a package has from its modules was led there.
            body = [one for one in body if not isinstance(one, ast.ImportFrom)]
        body = self._filtered(body)
        return ast.unparse(ast.Module(body, [])) + "\n" if body else ""

    def _filtered(self, body: list[Statement]) -> list[Statement]:
        found: list[Statement] = []
        for statement in body:
            if isinstance(statement, ast.ImportFrom | ast.Import):
                kept = [alias for alias in statement.names if self._wanted(statement, alias)]
                if kept:
                    made: Statement = (
                        ast.Import(kept)
                        if isinstance(statement, ast.Import)
                        else ast.ImportFrom(statement.module, kept, 0)
                    )
                    found.append(made)
                continue
            definition = self._of.get(id(statement))
            if definition is not None and not definition.live:
                continue
            if isinstance(statement, ast.ClassDef):
                statement.body = self._filtered(statement.body) or [ast.Pass()]
            found.append(statement)
        return found

    def _wanted(self, statement: ast.ImportFrom | ast.Import, alias: ast.alias) -> bool:
        here = (alias.asname or alias.name).partition(".")[0]
        if here not in self._live:
            return False
        if isinstance(statement, ast.Import) or not (statement.module or "").startswith("roslet"):
            return True
        source = statement.module or ""
        if source + "." + alias.name in self._entered:
            return True
        home = self._entered.get(source)
        return home is not None and (
            home.name in self._texts or any(_defined(one) == alias.name and self._is_live(one) for one in _flat(home.tree.body))
        )

    def _is_live(self, statement: Statement) -> bool:
        definition = self._of.get(id(statement))
        return definition is None or definition.live


def _flat(body: list[Statement]) -> list[Statement]:
    found = []
    for one in body:
        found.append(one)
        if isinstance(one, ast.If):
            found += _flat(one.body) + _flat(one.orelse)
        elif isinstance(one, ast.Try):
            found += _flat(one.body)
            for handler in one.handlers:
                found += _flat(handler.body)
    return found


def _defined(statement: Statement) -> str | None:
    """The name that a statement defines and does nothing else."""
    if isinstance(statement, (*Function, ast.ClassDef)):
        return statement.name
    if isinstance(statement, ast.Assign) and len(statement.targets) == 1 and isinstance(statement.targets[0], ast.Name):
        return statement.targets[0].id
    return None
