"""What rclpy does with parameters. Reads a JSON object {"overrides", "undeclared", "operations"}; writes a list of results.

An operation is a list, its name first: declare NAME VALUE TYPE DESCRIPTOR, set or atomically [[NAME, VALUE]...], get NAME,
undeclare NAME, list PREFIXES DEPTH, describe NAME. What raises gives the exception's name.
"""

import json
import sys

import rclpy
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.parameter import Parameter


def descriptor_of(fields):
    found = ParameterDescriptor()
    for name, value in fields.items():
        if name.endswith("_range"):
            kind = IntegerRange if name == "integer_range" else FloatingPointRange
            value = [kind(from_value=value[0], to_value=value[1], step=value[2])]
        setattr(found, name, value)
    return found


def plain(parameter):
    value = parameter.value
    return [parameter.type_.value, list(value) if parameter.type_.value > 5 else value]


def run(node, operation):
    what, *rest = operation
    if what == "declare":
        name, value, kind, fields = rest
        given = Parameter.Type(kind) if kind else value
        return plain(node.declare_parameter(name, given, descriptor_of(fields)))
    if what == "set":
        return [
            one.successful
            for one in node.set_parameters([Parameter(*pair[:1], value=pair[1]) for pair in rest[0]])
        ]
    if what == "atomically":
        return node.set_parameters_atomically(
            [Parameter(pair[0], value=pair[1]) for pair in rest[0]]
        ).successful
    if what == "get":
        return plain(node.get_parameter(rest[0]))
    if what == "undeclare":
        return node.undeclare_parameter(rest[0])
    if what == "list":
        found = node.list_parameters(rest[0], rest[1])
        return [sorted(found.names), sorted(found.prefixes)]
    found = node.describe_parameter(rest[0])
    return [
        found.type,
        found.description,
        found.additional_constraints,
        found.read_only,
        found.dynamic_typing,
    ]


def main():
    given = json.load(sys.stdin)
    rclpy.init()
    node = rclpy.create_node(
        "n",
        parameter_overrides=[Parameter(name, value=value) for name, value in given["overrides"].items()],
        allow_undeclared_parameters=given["undeclared"],
    )
    node.undeclare_parameter("use_sim_time")
    # Our own store has no parameters of its own; neither has this.
    for name in node.list_parameters([], 0).names:
        node._parameters.pop(name), node._descriptors.pop(name)
    results = []
    for operation in given["operations"]:
        try:
            results.append(run(node, operation))
        except Exception as error:
            results.append(type(error).__name__)
    json.dump(results, sys.stdout)


main()
