"""What ROS 2's own tools say of definitions. Runs under the Python of the ROS 2 wheels, knows no roslet.

rosidl_definitions.py values
    stdin: JSON list of .msg texts of a package `pkg`; prints for each, as rosidl_adapter reads it,
    {"fields": [[name, type, default]], "constants": [[name, type, value]]} or {"error": ...}
rosidl_definitions.py describe SHARE PACKAGE DIR
    runs the adapter and the type description generator on the files in DIR/msg, DIR/srv and DIR/action;
    prints {type name: the JSON that they write}; SHARE holds the packages that the files use
"""

# mypy: ignore-errors

import contextlib
import io
import json
import os
import pathlib
import sys
import tempfile


def values(texts):
    from rosidl_adapter.parser import parse_message_string

    found = []
    for text in texts:
        try:
            with contextlib.redirect_stderr(io.StringIO()):
                message = parse_message_string("pkg", "Thing", text)
        except Exception as error:  # whatever the reference raises is its verdict
            found.append({"error": f"{type(error).__name__}: {error}"})
            continue
        found.append(
            {
                "fields": [[field.name, str(field.type), field.default_value] for field in message.fields],
                "constants": [[one.name, one.type, one.value] for one in message.constants],
            }
        )
    return found


def describe(share, package, directory):
    from rosidl_adapter.action import convert_action_to_idl
    from rosidl_adapter.msg import convert_msg_to_idl
    from rosidl_adapter.srv import convert_srv_to_idl
    from rosidl_generator_type_description import generate_type_hash

    converters = {"msg": convert_msg_to_idl, "srv": convert_srv_to_idl, "action": convert_action_to_idl}
    with tempfile.TemporaryDirectory() as output, contextlib.redirect_stdout(sys.stderr):
        tuples = []
        for kind, convert in converters.items():
            for name in sorted(os.listdir(os.path.join(directory, kind))):
                file = pathlib.Path(kind, name)
                convert(pathlib.Path(directory).absolute(), package, file, pathlib.Path(output, "idl", kind))
                tuples.append(f"{output}/idl:{kind}/{file.stem}.idl")
        arguments = pathlib.Path(output, "arguments.json")
        includes = [f"{name}:{share}/{name}" for name in os.listdir(share)]
        arguments.write_text(
            json.dumps(
                {
                    "package_name": package,
                    "output_dir": output + "/out",
                    "idl_tuples": tuples,
                    "include_paths": includes,
                }
            )
        )
        written = [json.loads(pathlib.Path(file).read_text()) for file in generate_type_hash(str(arguments))]
    return {one["type_description_msg"]["type_description"]["type_name"]: one for one in written}


if __name__ == "__main__":
    answer = values(json.load(sys.stdin)) if sys.argv[1] == "values" else describe(*sys.argv[2:])
    json.dump(answer, sys.stdout)
