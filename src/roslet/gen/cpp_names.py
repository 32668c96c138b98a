"""How C++ spells the names and values of a definition."""

from __future__ import annotations

from roslet.errors import Unsupported

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable

    from roslet.idl.records import Dialect, FieldType, TypeName, Value


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


KEYWORDS = _words(
    """alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t class compl concept
    const const_cast consteval constexpr constinit continue co_await co_return co_yield decltype default delete do double
    dynamic_cast else enum explicit export extern false float for friend goto if inline int long mutable namespace new
    noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast requires return short
    signed sizeof static static_assert static_cast struct switch template this thread_local throw true try typedef typeid
    typename union unsigned using virtual void volatile wchar_t while xor xor_eq"""
)

MEMBERS = _words(
    """definition dds_type_name deserialize deserialize_body field_count field_name max_serialized_size md5sum serialize
    serialize_body transfer type_hash type_name"""
)
"""What the struct of a message has beside its fields and constants."""

_PRIMITIVES = {
    "bool": "bool",
    "float32": "float",
    "float64": "double",
    "time": "roslet::Time",
    "duration": "roslet::Duration",
}

STAMP_PARTS = {"secs": "sec", "nsecs": "nsec"}
"""The parts of a ROS 1 time or duration in a path of `layout`, and in C++."""


def package_name(package: str) -> str:
    """The namespace of a package, and the folder of its headers. Its dashes are underscores; a word that C++ or the support
    header has is followed by one."""
    name = package.replace("-", "_")
    return name + "_" if name in KEYWORDS or name in ("std", "roslet") else name


def namespace(name: TypeName, dialect: Dialect) -> str:
    """The namespace of a type: that of its package, in ROS 2 with that of its kind inside."""
    package = package_name(name.package)
    return package if dialect == "ros1" else package + "::" + name.kind


def struct_name(name: TypeName) -> str:
    """The struct's name without its namespace."""
    return name.name + "_" if name.name in KEYWORDS else name.name


def header_path(name: TypeName, dialect: Dialect) -> str:
    """The path of a type's header, as programs include it."""
    package = package_name(name.package)
    middle = "/" if dialect == "ros1" else "/%s/" % name.kind
    return package + middle + name.name + ".hpp"


def full_name(name: TypeName, dialect: Dialect) -> str:
    """The struct's name from anywhere."""
    return "::%s::%s" % (namespace(name, dialect), struct_name(name))


def members(struct: str, names: Iterable[str]) -> dict[str, str]:
    """Names of fields and constants -> those of members: themselves, or with underscores behind them where taken."""
    taken = {*KEYWORDS, *MEMBERS, struct}
    found: dict[str, str] = {}
    for name in names:
        wish = name
        while wish in taken:
            wish += "_"
        taken.add(wish)
        found[name] = wish
    return found


def field_type(kind: FieldType, dialect: Dialect) -> str:
    """The C++ type of a field, whose strings and sequences have bounds."""
    single = single_type(kind, dialect)
    array = kind.array
    if array is None:
        return single
    container = "Array" if array.kind == "fixed" else "Sequence"
    return "roslet::%s<%s, %d>" % (container, single, array.size or 0)


def single_type(kind: FieldType, dialect: Dialect) -> str:
    """The type of a field that is no array, or of an array's element."""
    if kind.message is not None:
        return full_name(kind.message, dialect)
    primitive = kind.primitive or ""
    if primitive in ("string", "wstring"):
        return "roslet::%s<%d>" % ("WString" if primitive == "wstring" else "String", kind.string_bound or 0)
    return _PRIMITIVES.get(primitive) or "std::%s_t" % primitive


def constant_type(kind: FieldType) -> str:
    """The type of a constant."""
    if kind.primitive == "string":
        return "const char*"
    if kind.primitive == "wstring":
        return "const char16_t*"
    return _PRIMITIVES.get(kind.primitive or "") or "std::%s_t" % kind.primitive


def literal(primitive: str, value: Value) -> str:
    """The expression of a constant's or a default's value."""
    if primitive == "bool":
        return "true" if value else "false"
    if primitive == "wstring":
        return "u" + quoted_wide(str(value))
    if primitive == "string":
        return quoted(str(value))
    if primitive in ("float32", "float64"):
        return _real(float(value), primitive)  # type: ignore[arg-type]
    if not isinstance(value, (int, float)):
        raise Unsupported("%r is no value of a %s" % (value, primitive))
    return _integer(int(value), primitive)


def _integer(value: int, primitive: str) -> str:
    bits = int(primitive.lstrip("uint"))
    if primitive.startswith("u"):
        return "%d%s" % (value, {64: "ULL", 32: "U"}.get(bits, ""))
    suffix = "LL" if bits == 64 else ""
    if value == -(1 << 63) or value == -(
        1 << 31
    ):  # there are no negative literals: the number alone would not fit
        return "-%d%s - 1" % (-value - 1, suffix)
    return "%d%s" % (value, suffix)


def _real(value: float, primitive: str) -> str:
    single = primitive == "float32"
    if value != value:
        return '__builtin_nan%s("")' % ("f" if single else "")
    if value in (float("inf"), float("-inf")):
        return "%s__builtin_inf%s()" % ("-" if value < 0 else "", "f" if single else "")
    return repr(value) + ("F" if single else "")


_ESCAPES = {ord('"'): '\\"', ord("\\"): "\\\\", ord("\n"): "\\n", ord("\t"): "\\t", ord("?"): "\\?"}


def quoted(text: str) -> str:
    """A string literal of the text's UTF-8; octets that are no printable ASCII are octal."""
    shown = []
    for octet in text.encode("utf-8", "surrogateescape"):
        shown.append(_ESCAPES.get(octet) or (chr(octet) if 32 <= octet < 127 else "\\%03o" % octet))
    return '"%s"' % "".join(shown)


def quoted_wide(text: str) -> str:
    """The same, of the text's UTF-16."""
    shown = []
    for character in text:
        code = ord(character)
        if 32 <= code < 127:
            shown.append(_ESCAPES.get(code) or character)
        elif code < 160:
            shown.append("\\%03o" % code)
        else:
            shown.append("\\u%04x" % code if code < 0x10000 else "\\U%08x" % code)
    return '"%s"' % "".join(shown)
