"""A node's parameters: declared, typed, ranged, and told of. rcl_interfaces, and what rclpy's Node does with them.

Values are plain: None, bool, int, float, str, bytes, and lists of bool, int, float or str. Results are pairs
(successful, reason). Where a caller breaks a contract an exception says so; what a value is refused for is a reason.
"""

from roslet.errors import (
    InvalidName,
    ParameterAlreadyDeclared,
    ParameterNotDeclared,
    ParameterReadOnly,
    ParameterRefused,
    ParameterUninitialized,
)
from roslet.record import Names, Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    Result = tuple[bool, str]
    PreSet = Callable[["list[Parameter]"], "list[Parameter]"]
    OnSet = Callable[["list[Parameter]"], Result]
    PostSet = Callable[["list[Parameter]"], None]

# rcl_interfaces/msg/ParameterType
NOT_SET, BOOL, INTEGER, DOUBLE, STRING = 0, 1, 2, 3, 4
BYTE_ARRAY, BOOL_ARRAY, INTEGER_ARRAY, DOUBLE_ARRAY, STRING_ARRAY = 5, 6, 7, 8, 9

TYPES = Names(
    "type",
    {
        NOT_SET: "not set",
        BOOL: "bool",
        INTEGER: "integer",
        DOUBLE: "double",
        STRING: "string",
        BYTE_ARRAY: "byte array",
        BOOL_ARRAY: "bool array",
        INTEGER_ARRAY: "integer array",
        DOUBLE_ARRAY: "double array",
        STRING_ARRAY: "string array",
    },
)

# Parameters of a node that allows undeclared ones: others could make it hold any number.
MAX_UNDECLARED = 4096
# By how much, of itself, a double may miss the end or a step of its range.
TOLERANCE = 1e-6

_INFINITE = float("inf")
_SUCCESS: "Result" = (True, "")


def _is_number(value: "Any") -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and -(1 << 63) <= value < 1 << 63


def _of_elements(value: "Any") -> "int | None":
    kind: int | None = None
    for element in value:
        if isinstance(element, bool):
            found = BOOL_ARRAY
        elif _is_number(element):
            found = INTEGER_ARRAY
        elif isinstance(element, float):
            found = DOUBLE_ARRAY
        elif isinstance(element, str):
            found = STRING_ARRAY
        elif isinstance(element, bytes) and len(element) == 1:
            found = BYTE_ARRAY
        else:
            return None
        if kind is not None and kind != found:
            return None
        kind = found
    return BYTE_ARRAY if kind is None else kind


def type_of(value: "Any") -> int:
    """The type of a plain value. An empty list has the type of an empty list in rclpy, BYTE_ARRAY.

    Raises TypeError where no parameter can have it; integers have 64 bits.
    """
    found: int | None = None
    if value is None:
        found = NOT_SET
    elif isinstance(value, bool):
        found = BOOL
    elif _is_number(value):
        found = INTEGER
    elif isinstance(value, float):
        found = DOUBLE
    elif isinstance(value, str):
        found = STRING
    elif isinstance(value, (bytes, bytearray, memoryview)):
        found = BYTE_ARRAY
    elif not isinstance(value, dict):
        try:
            found = _of_elements(value)
        except TypeError:
            found = None  # not iterable
    if found is None:
        raise TypeError("no parameter can have the value %r" % (value,))
    return found


class Parameter(Record):
    """A name, a value, and its type; where the type is not given it is that of the value. Lists are copied.

    Raises TypeError where value and type do not agree. An empty list agrees with every array.
    """

    _fields = ("name", "value", "type")
    __slots__ = _fields

    def __init__(self, name: str, value: "Any" = None, type: "int | None" = None) -> None:  # noqa: A002 - as rcl has it
        found = type_of(value)
        if found == BYTE_ARRAY:
            value = bytes(value) if isinstance(value, (bytes, bytearray, memoryview)) else b"".join(value)
        elif found >= BOOL_ARRAY:
            value = list(value)
        if type is not None and type != found:
            if not (found == BYTE_ARRAY and not value and type >= BYTE_ARRAY):
                raise TypeError("%s: a value of type %s is no %s" % (name, TYPES[found], TYPES[type]))
            value = []
            found = type
        self.name = name
        self.value = value
        self.type = found


class Descriptor(Record):
    """rcl_interfaces/msg/ParameterDescriptor. The ranges are (from, to, step), a step of 0 for none, or None."""

    _fields = (
        "name",
        "type",
        "description",
        "constraints",
        "read_only",
        "dynamic_typing",
        "floating_point_range",
        "integer_range",
    )
    __slots__ = _fields

    def __init__(
        self,
        name: str = "",
        type: int = NOT_SET,  # noqa: A002 - as the message has it
        description: str = "",
        constraints: str = "",
        read_only: bool = False,
        dynamic_typing: bool = False,
        floating_point_range: "tuple[float, float, float] | None" = None,
        integer_range: "tuple[int, int, int] | None" = None,
    ) -> None:
        self.name = name
        self.type = type
        self.description = description
        self.constraints = constraints
        self.read_only = read_only
        self.dynamic_typing = dynamic_typing
        self.floating_point_range = floating_point_range
        self.integer_range = integer_range


class Change(Record):
    """What rcl_interfaces/msg/ParameterEvent tells: the parameters that are new, changed and deleted."""

    _fields = ("new", "changed", "deleted")
    __slots__ = _fields

    def __init__(
        self, new: "list[Parameter]", changed: "list[Parameter]", deleted: "list[Parameter]"
    ) -> None:
        self.new = new
        self.changed = changed
        self.deleted = deleted


def _near(one: float, other: float) -> bool:
    apart = abs(one - other)
    return one == other or (apart < _INFINITE and apart <= TOLERANCE * max(abs(one), abs(other)))


def _outside(parameter: Parameter, descriptor: Descriptor) -> str:
    """Why a value is not in its range, "" where it is."""
    value = parameter.value
    if parameter.type == INTEGER and descriptor.integer_range is not None:
        limits: tuple[float, float, float] = descriptor.integer_range
    elif parameter.type == DOUBLE and descriptor.floating_point_range is not None:
        limits = descriptor.floating_point_range
    else:
        return ""
    low, high, step = min(limits[:2]), max(limits[:2]), abs(limits[2])
    exact = parameter.type == INTEGER
    if value in (low, high) or (not exact and (_near(value, low) or _near(value, high))):
        return ""
    if not low < value < high:
        return "%s is out of range: from %s to %s" % (value, low, high)
    if not step or _on_a_step(value - low, step, value, exact):
        return ""
    return "%s is not on a step: from %s to %s in steps of %s" % (value, low, high, step)


def _on_a_step(distance: float, step: float, value: float, exact: bool) -> bool:
    if exact:
        return distance % step == 0
    steps = distance / step
    # So far out doubles lie further apart than the tolerance.
    return steps > 1e15 or _near(value - distance + round(steps) * step, value)


class Parameters:
    """The parameters of one node.

    overrides          name -> value, from arguments and files; they win over the value of a declaration
    allow_undeclared   anybody may set what was not declared, MAX_UNDECLARED at most
    on_change          called with a Change after each successful set or declaration, before post_set
    """

    def __init__(
        self,
        overrides: "dict[str, Any] | None" = None,
        allow_undeclared: bool = False,
        on_change: "Callable[[Change], None] | None" = None,
    ) -> None:
        self.overrides: dict[str, Any] = overrides or {}
        self.allow_undeclared = allow_undeclared
        self.on_change = on_change
        self._values: dict[str, Parameter] = {}
        self._descriptors: dict[str, Descriptor] = {}
        self._order: list[str] = []
        self._pre: list[PreSet] = []
        self._on: list[OnSet] = []
        self._post: list[PostSet] = []

    # -- callbacks; the newest is called first

    def add_pre_set(self, function: "PreSet") -> None:
        """`function(parameters)` gives those to be set in their place; of several, all they give together."""
        self._pre.insert(0, function)

    def add_on_set(self, function: "OnSet") -> None:
        """`function(parameters)` gives (successful, reason); the first that does not succeed refuses them all."""
        self._on.insert(0, function)

    def add_post_set(self, function: "PostSet") -> None:
        """`function(parameters)` is called when they have been set."""
        self._post.insert(0, function)

    def remove_pre_set(self, function: "PreSet") -> None:
        """Raises ValueError where it was not added."""
        self._pre.remove(function)

    def remove_on_set(self, function: "OnSet") -> None:
        """Raises ValueError where it was not added."""
        self._on.remove(function)

    def remove_post_set(self, function: "PostSet") -> None:
        """Raises ValueError where it was not added."""
        self._post.remove(function)

    # -- declaring

    def declare(
        self,
        name: str,
        value: "Any" = None,
        type: int = NOT_SET,  # noqa: A002
        descriptor: "Descriptor | None" = None,
        ignore_override: bool = False,
    ) -> Parameter:
        """Declare a parameter with a value, whose type it then has, or with a type alone, or with a descriptor that allows
        any. Calls on_set and post_set. Returns it as it is, with the override where there is one.

        Raises InvalidName, ParameterAlreadyDeclared, ParameterRefused, ValueError where neither value nor type is given,
        TypeError.
        """
        if not name:
            raise InvalidName("a parameter's name must not be empty")
        if name in self._values:
            raise ParameterAlreadyDeclared(name)
        described = (descriptor or Descriptor()).replace(name=name)
        declared = Parameter(name, value, None if type == NOT_SET or value is None else type)
        if described.dynamic_typing:
            if type != NOT_SET:
                raise ValueError("%s: dynamic typing and a type exclude each other" % name)
        elif type == NOT_SET and declared.type == NOT_SET:
            raise ValueError("%s: declare it with a value, a type, or dynamic typing" % name)
        else:
            described = described.replace(type=type or declared.type)
        if not ignore_override and name in self.overrides:
            declared = self._typed(name, self.overrides[name], described)
        reason = self._unsuitable(declared, described, False)
        wrong_type = declared.type not in (NOT_SET, described.type) and not described.dynamic_typing
        if not reason:
            reason = self._asked([declared])
        if reason:
            raise ParameterRefused(name, reason, wrong_type)
        self._store([declared], described)
        return self._values[name]

    def undeclare(self, name: str) -> None:
        """Raises ParameterNotDeclared, ParameterReadOnly."""
        if name not in self._values:
            raise ParameterNotDeclared(name)
        if self._descriptors[name].read_only:
            raise ParameterReadOnly(name)
        self._remove(name)

    # -- asking

    def has(self, name: str) -> bool:
        return name in self._values

    def get(self, name: str) -> Parameter:
        """Raises ParameterNotDeclared, unless undeclared ones are allowed: then it is NOT_SET; and
        ParameterUninitialized."""
        found = self._values.get(name)
        if found is None:
            if self.allow_undeclared:
                return Parameter(name)
            raise ParameterNotDeclared(name)
        if found.type == NOT_SET and not self._descriptors[name].dynamic_typing:
            raise ParameterUninitialized(name)
        return found

    def get_or(self, name: str, otherwise: "Any" = None) -> "Any":
        """The value, or `otherwise` where there is none."""
        found = self._values.get(name)
        return otherwise if found is None or found.type == NOT_SET else found.value

    def get_type(self, name: str) -> int:
        """Raises ParameterNotDeclared, unless undeclared ones are allowed."""
        found = self._values.get(name)
        if found is None and not self.allow_undeclared:
            raise ParameterNotDeclared(name)
        return NOT_SET if found is None else found.type

    def describe(self, name: str) -> Descriptor:
        """Raises ParameterNotDeclared, unless undeclared ones are allowed."""
        found = self._descriptors.get(name)
        if found is None:
            if self.allow_undeclared:
                return Descriptor(name)
            raise ParameterNotDeclared(name)
        return found

    def names(self) -> "list[str]":
        """All of them, in the order in which they were declared."""
        return list(self._order)

    def list_parameters(
        self, prefixes: "list[str] | tuple[str, ...]" = (), depth: int = 0
    ) -> "tuple[list[str], list[str]]":
        """(names, their prefixes): those that are, or are below, one of `prefixes`, or all; `depth` levels deep, 0 for
        every level. Raises ValueError for a negative depth."""
        if depth < 0:
            raise ValueError("a depth of %d" % depth)
        names: list[str] = []
        found: list[str] = []
        for name in self._order:
            if prefixes:
                wanted = False
                for prefix in prefixes:
                    below = name.startswith(prefix + ".")
                    deep = name[len(prefix) + 1 :].count(".") < depth or not depth
                    wanted = wanted or name == prefix or (below and deep)
            else:
                wanted = not depth or name.count(".") < depth
            if wanted:
                names.append(name)
                prefix = name.rpartition(".")[0]
                if prefix and prefix not in found:
                    found.append(prefix)
        return names, found

    # -- setting

    def set(self, parameters: "list[Parameter]") -> "list[Result]":
        """Set each by itself, in order; a result for each. Raises as `set_atomically`; what was set before stays."""
        return [self.set_atomically([one]) for one in parameters]

    def set_atomically(self, parameters: "list[Parameter]") -> "Result":
        """Set all or none. NOT_SET undeclares what has dynamic typing. Raises ParameterNotDeclared, naming all of them."""
        if self._pre:
            chosen: list[Parameter] = []
            for pre in list(self._pre):
                chosen += pre(parameters)
            parameters = chosen
            if not parameters:
                return False, "nothing is left to be set: a pre-set callback may have dropped it"
        unknown = [one.name for one in parameters if one.name not in self._values]
        if unknown and not self.allow_undeclared:
            raise ParameterNotDeclared(", ".join(unknown))
        if unknown and len(self._values) + len(unknown) > MAX_UNDECLARED:
            return False, "this node holds %d parameters and takes no more" % len(self._values)
        for one in parameters:
            if not one.name:
                return False, "a parameter's name must not be empty"
            descriptor = self._descriptors.get(one.name)
            if descriptor is not None:
                reason = self._unsuitable(one, descriptor, True)
                if reason:
                    return False, self._refusal(one.name, reason)
        reason = self._asked(parameters)
        if reason:
            return False, reason
        self._store(parameters, None)
        return _SUCCESS

    def set_descriptor(self, name: str, descriptor: Descriptor, otherwise: "Any" = None) -> Parameter:
        """Describe a parameter anew; `otherwise` becomes its value where the old one does not suit.

        Raises ParameterNotDeclared, ParameterReadOnly, ParameterRefused where neither suits.
        """
        current = self.get(name)
        if name not in self._values:
            return current
        if self._descriptors[name].read_only:
            raise ParameterReadOnly(name)
        described = descriptor.replace(name=name)
        if described.type == NOT_SET:
            described = described.replace(type=current.type)
        for one in (current, current if otherwise is None else Parameter(name, otherwise)):
            reason = self._unsuitable(one, described, False)
            if not reason:
                self._values[name] = one
                self._descriptors[name] = described.replace(type=one.type)
                return one
        raise ParameterRefused(name, reason)

    # -- within

    def _refusal(self, name: str, reason: str) -> str:
        return "%s: %s" % (name, reason)

    @staticmethod
    def _typed(name: str, value: "Any", descriptor: Descriptor) -> Parameter:
        """An override. Files do not tell what an empty list is a list of: it is what was declared."""
        if isinstance(value, Parameter):
            value = value.value
        found = Parameter(name, value)
        if found.type == BYTE_ARRAY and not found.value and descriptor.type > BYTE_ARRAY:
            return Parameter(name, [], descriptor.type)
        return found

    def _unsuitable(self, parameter: Parameter, descriptor: Descriptor, setting: bool) -> str:
        """Why a value must not be that of a parameter, "" where it may."""
        if setting and descriptor.read_only:
            return "it is read-only"
        if not descriptor.dynamic_typing:
            if parameter.type == NOT_SET:
                return "it has a fixed type and cannot be undeclared" if setting else ""
            if parameter.type != descriptor.type:
                return "its type is %s, not %s" % (TYPES[descriptor.type], TYPES[parameter.type])
        return _outside(parameter, descriptor)

    def _asked(self, parameters: "list[Parameter]") -> str:
        """Why an on_set callback refuses, "" where none does."""
        for function in list(self._on):
            successful, reason = function(parameters)
            if not successful:
                return reason or "a callback of the node refused it"
        return ""

    def _store(self, parameters: "list[Parameter]", descriptor: "Descriptor | None") -> None:
        change = Change([], [], [])
        for one in parameters:
            if one.type == NOT_SET and descriptor is None:
                change.deleted.append(one)
                self._remove(one.name)
                continue
            old = self._values.get(one.name)
            if old is None:
                self._order.append(one.name)
            described = (
                descriptor or self._descriptors.get(one.name) or Descriptor(one.name, dynamic_typing=True)
            )
            if described.dynamic_typing:
                described = described.replace(type=one.type)
            self._descriptors[one.name] = described
            self._values[one.name] = one
            (change.new if old is None or old.type == NOT_SET else change.changed).append(one)
        if self.on_change is not None:
            self.on_change(change)
        for function in list(self._post):
            function(parameters)

    def _remove(self, name: str) -> None:
        if self._values.pop(name, None) is not None:
            del self._descriptors[name]
            self._order.remove(name)
