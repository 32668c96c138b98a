"""What ROS 1's own Python makes of values. Runs under Debian's Python, knows nothing of roslet.

Each line of standard input is JSON: {"type": "pkg/Name", "value": fields, "data": hex}. The answer, one line:
{"data": what genpy serialises of the value, in hex, "value": what it reads from the data given} or {"error": text}.
Arguments: folders of package folders, beside Debian's own, whose definitions have no Python classes installed.
A time or duration is {"secs", "nsecs"}, an array a list, a uint8 array a list of integers. A service's request is
`pkg/NameRequest`.
"""

# mypy: ignore-errors

import contextlib
import importlib
import io
import json
import pathlib
import sys

import genpy
import genpy.dynamic
import genpy.message

CLASSES = {}
ROOTS = [pathlib.Path("/usr/share"), *map(pathlib.Path, sys.argv[1:])]


def definition(name):
    """The full text of a type whose Python classes Debian does not ship."""
    from genmsg import gentools, msg_loader

    context = msg_loader.MsgContext.create_default()
    packages = {path.parent.name: path.parent for root in ROOTS for path in root.glob("*/msg")}
    packages.update({path.parent.name: path.parent for root in ROOTS for path in root.glob("*/srv")})
    search = {name: [str(path / "msg")] for name, path in packages.items() if (path / "msg").is_dir()}
    package, short = name.split("/")
    for part in ("Request", "Response"):
        path = packages[package] / "srv" / (short[: -len(part)] + ".srv")
        if short.endswith(part) and path.exists():
            service = msg_loader.load_srv_from_file(context, str(path), name[: -len(part)])
            spec = service.request if part == "Request" else service.response
            msg_loader.load_depends(context, spec, search)
            return gentools.compute_full_text(context, spec)
    spec = msg_loader.load_msg_from_file(context, str(packages[package] / "msg" / (short + ".msg")), name)
    msg_loader.load_depends(context, spec, search)
    return gentools.compute_full_text(context, spec)


def find_class(name):
    if name not in CLASSES:
        package, short = name.split("/")
        found = None
        for module in ("msg", "srv"):
            with contextlib.suppress(ImportError):
                found = found or getattr(importlib.import_module(package + "." + module), short, None)
        if found is None:
            found = genpy.dynamic.generate_dynamic(name, definition(name))[name]
        CLASSES[name] = found
    return CLASSES[name]


def build(kind, fields):
    message = kind()
    for name, text in zip(message.__slots__, message._slot_types, strict=True):
        value = fields[name]
        base, bracket, _ = text.partition("[")
        if base in ("char", "uint8") and bracket:
            made = bytes(value)
        elif bracket:
            made = [build_one(base, kind, element) for element in value]
        else:
            made = build_one(base, kind, value)
        setattr(message, name, made)
    return message


def build_one(base, holder, value):
    if base == "time":
        return genpy.Time(value["secs"], value["nsecs"])
    if base == "duration":
        made = genpy.Duration()
        made.secs, made.nsecs = value["secs"], value["nsecs"]
        return made
    if "/" in base:
        return build(nested_class(holder, base), value)
    return value


def nested_class(holder, base):
    """The class that the generated module of `holder` itself uses, so that dynamic types nest dynamic
    types."""
    module = sys.modules[holder.__module__]
    dynamic = getattr(module, "_" + base.replace("/", "__"), None)
    return dynamic if dynamic is not None else find_class(base)


def plain(value):
    if isinstance(value, genpy.rostime.TVal):
        return {"secs": value.secs, "nsecs": value.nsecs}
    if isinstance(value, genpy.Message):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, (bytes, list, tuple)):
        return [plain(element) for element in value]
    return value


def main():
    for line in sys.stdin:
        case = json.loads(line)
        try:
            kind = find_class(case["type"])
            stream = io.BytesIO()
            build(kind, case["value"]).serialize(stream)
            answer = {"data": stream.getvalue().hex()}
            answer["value"] = plain(kind().deserialize(bytes.fromhex(case["data"])))
        except Exception as error:  # whatever the reference raises is its verdict
            answer = {"error": "%s: %s" % (type(error).__name__, error)}
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()


main()
