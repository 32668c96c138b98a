"""What genmsg and genpy, ROS 1's own tools, say of definitions. Runs under Debian's Python, knows no roslet.

    genmsg_definitions.py files SHARE...     every .msg and .srv in the packages of these directories
    genmsg_definitions.py classes            every class that genpy generated into an installed package
    genmsg_definitions.py values             stdin: JSON list of .msg texts of a package `pkg`

The first two print {"pkg/msg/Name": {"md5": ..., "text": ...}, "pkg/srv/Name": {"md5": ..., "request": ...,
"response": ...}} with full texts. The third prints for each text
{"fields": [[name, type]], "constants": [[name, type, value, text]]}. What genmsg refuses has only "error".
"""

# mypy: ignore-errors

import importlib
import json
import os
import pkgutil
import sys

import genmsg
import genmsg.gentools
import genmsg.msg_loader


def from_files(shares):
    paths = {}
    for share in shares:
        for package in sorted(os.listdir(share)):
            directory = os.path.join(share, package, "msg")
            if os.path.isdir(directory):
                paths.setdefault(package, []).append(directory)
    found = {}
    for share in shares:
        for package in sorted(os.listdir(share)):
            for kind in ("msg", "srv"):
                directory = os.path.join(share, package, kind)
                files = sorted(os.listdir(directory)) if os.path.isdir(directory) else []
                for file in files:
                    if file.endswith("." + kind):
                        key = f"{package}/{kind}/{file[: -len(kind) - 1]}"
                        if key not in found:
                            found[key] = describe(os.path.join(directory, file), key, paths)
    return found


def describe(path, key, paths):
    package, kind, name = key.split("/")
    context = genmsg.msg_loader.MsgContext.create_default()
    full = package + "/" + name
    try:
        if kind == "msg":
            spec = genmsg.msg_loader.load_msg_from_file(context, path, full)
            genmsg.msg_loader.load_depends(context, spec, paths)
            text = genmsg.gentools.compute_full_text(context, spec)
            return {"md5": genmsg.gentools.compute_md5(context, spec), "text": text}
        spec = genmsg.msg_loader.load_srv_from_file(context, path, full)
        genmsg.msg_loader.load_depends(context, spec, paths)
        return {
            "md5": genmsg.gentools.compute_md5(context, spec),
            "request": genmsg.gentools.compute_full_text(context, spec.request),
            "response": genmsg.gentools.compute_full_text(context, spec.response),
        }
    except Exception as error:  # whatever the reference raises is its verdict
        return {"error": f"{type(error).__name__}: {error}"}


def from_classes():
    found = {}
    for root in sys.path:
        if not os.path.isdir(root):
            continue
        for module in pkgutil.iter_modules([root]):
            for kind in ("msg", "srv"):
                if os.path.exists(os.path.join(root, module.name, kind, "__init__.py")):
                    try:
                        package = importlib.import_module(f"{module.name}.{kind}")
                    except ImportError:
                        continue
                    found.update(describe_classes(module.name, kind, vars(package)))
    return found


def describe_classes(package, kind, names):
    found = {}
    for entry in names.values():
        if not isinstance(entry, type) or "/" not in getattr(entry, "_type", ""):
            continue
        key = f"{package}/{kind}/{entry._type.partition('/')[2]}"
        if kind == "msg":
            found[key] = {"md5": entry._md5sum, "text": entry._full_text}
        elif hasattr(entry, "_request_class"):
            found[key] = {
                "md5": entry._md5sum,
                "request": entry._request_class._full_text,
                "response": entry._response_class._full_text,
            }
    return found


def values(texts):
    found = []
    for text in texts:
        context = genmsg.msg_loader.MsgContext.create_default()
        try:
            spec = genmsg.msg_loader.load_msg_from_string(context, text, "pkg/Thing")
        except Exception as error:  # whatever the reference raises is its verdict
            found.append({"error": f"{type(error).__name__}: {error}"})
            continue
        constants = [[one.name, one.type, one.val, one.val_text] for one in spec.constants]
        found.append({"fields": [[name, kind] for kind, name in spec.fields()], "constants": constants})
    return found


if __name__ == "__main__":
    if sys.argv[1] == "values":
        answer = values(json.load(sys.stdin))
    else:
        answer = from_files(sys.argv[2:]) if sys.argv[1] == "files" else from_classes()
    json.dump(answer, sys.stdout)
