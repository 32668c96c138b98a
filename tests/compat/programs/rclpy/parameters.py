#!/usr/bin/env python3
# Parameters: declared, described, set, refused, watched.
import rclpy
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    ParameterValue,
    SetParametersResult,
)
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.parameter import Parameter, get_parameter_value, parameter_value_to_python


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__, error)


def told(result):
    return result.successful, result.reason


rclpy.init()
node = rclpy.create_node("parameters")
show("undeclared", lambda: node.get_parameter("text"))
show("declare", lambda: node.declare_parameter("text", "hello").value)
show("again", lambda: node.declare_parameter("text", "hello"))
show(
    "several",
    lambda: [
        (p.name, p.value, p.type_.name)
        for p in node.declare_parameters(
            "group",
            [
                ("integer", 3),
                ("double", 2.5),
                ("bool", True),
                ("bytes", [b"a", b"b"]),
                ("bools", [True, False]),
                ("integers", [1, 2]),
                ("doubles", [1.0, 2.0]),
                ("strings", ["x", "y"]),
            ],
        )
    ],
)
show("typed", lambda: node.declare_parameter("typed", Parameter.Type.INTEGER).value)
show("unset", lambda: node.get_parameter("typed"))
show("dynamic", lambda: node.declare_parameter("dynamic", 1, ParameterDescriptor(dynamic_typing=True)).value)
show("nothing", lambda: node.declare_parameter("nothing").value)
show("read only", lambda: node.declare_parameter("fixed", 7, ParameterDescriptor(read_only=True)).value)
show("bad name", lambda: node.declare_parameter("", 1))
show("mixed", lambda: node.declare_parameter("mixed", [1, "a"]))
show("get", lambda: node.get_parameter("group.integer").value)
show("value", lambda: node.get_parameter("group.double").get_parameter_value().double_value)
show("or", lambda: node.get_parameter_or("absent", Parameter("absent", value=5)).value)
show("or none", lambda: node.get_parameter_or("absent").type_.name)
show("has", lambda: (node.has_parameter("text"), node.has_parameter("absent")))
show("many", lambda: [p.value for p in node.get_parameters(["text", "group.bool"])])
show(
    "prefix",
    lambda: sorted((k, p.value) for k, p in node.get_parameters_by_prefix("group").items() if "s" not in k),
)
show("type", lambda: (node.get_parameter_type("text"), node.get_parameter_types(["group.bool"])))
show("list", lambda: sorted(node.list_parameters(["group"], 0).names))
show("prefixes", lambda: node.list_parameters([], 0).prefixes)

show(
    "set",
    lambda: [
        told(r)
        for r in node.set_parameters([Parameter("text", value="bye"), Parameter("group.integer", value=4)])
    ],
)
show("wrong type", lambda: [told(r) for r in node.set_parameters([Parameter("text", value=1)])])
try:
    node.set_parameters([Parameter("absent", value=1)])
except ParameterNotDeclaredException:
    print("undeclared")
show("read only", lambda: [told(r) for r in node.set_parameters([Parameter("fixed", value=8)])])
show("dynamic", lambda: [told(r) for r in node.set_parameters([Parameter("dynamic", value="text")])])
show("typed", lambda: [told(r) for r in node.set_parameters([Parameter("typed", value=9)])])
show(
    "atomically",
    lambda: told(
        node.set_parameters_atomically([Parameter("text", value="x"), Parameter("group.integer", value="no")])
    ),
)
show("unchanged", lambda: node.get_parameter("text").value)

bounded = ParameterDescriptor(
    description="a bounded number",
    additional_constraints="none",
    integer_range=[IntegerRange(from_value=0, to_value=10, step=2)],
)
show("range", lambda: node.declare_parameter("bounded", 4, bounded).value)
for value in (6, 10, 12, -2, 5):
    show(f"to {value}", lambda: [told(r) for r in node.set_parameters([Parameter("bounded", value=value)])])
real = ParameterDescriptor(floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0, step=0.25)])
show("range", lambda: node.declare_parameter("real", 0.5, real).value)
for value in (0.75, 1.5, 0.3, 1.0):
    show(f"to {value}", lambda: [told(r) for r in node.set_parameters([Parameter("real", value=value)])])
show(
    "outside",
    lambda: node.declare_parameter(
        "outside", 99, ParameterDescriptor(integer_range=[IntegerRange(from_value=0, to_value=10)])
    ),
)
show("describe", lambda: node.describe_parameter("bounded"))
show("describe", lambda: [d.type for d in node.describe_parameters(["text", "group.doubles"])])
show("describe", lambda: node.describe_parameter("absent"))
show(
    "descriptor",
    lambda: node.set_descriptor(
        "text", ParameterDescriptor(description="new", type=ParameterType.PARAMETER_STRING)
    ),
)
show("descriptor", lambda: node.describe_parameter("text").description)

calls = []


def before(parameters):
    calls.append(("pre", [p.name for p in parameters]))
    return [*parameters, Parameter("group.double", value=9.5)]


def check(parameters):
    calls.append(("on", [p.name for p in parameters]))
    for parameter in parameters:
        if parameter.name == "text" and parameter.value == "bad":
            return SetParametersResult(successful=False, reason="not that word")
    return SetParametersResult(successful=True)


def after(parameters):
    calls.append(("post", [(p.name, p.value) for p in parameters]))


node.add_pre_set_parameters_callback(before)
node.add_on_set_parameters_callback(check)
node.add_post_set_parameters_callback(after)
show("watched", lambda: [told(r) for r in node.set_parameters([Parameter("text", value="good")])])
print(calls, node.get_parameter("group.double").value)
calls.clear()
show("refused", lambda: told(node.set_parameters_atomically([Parameter("text", value="bad")])))
print(calls)
calls.clear()
node.remove_pre_set_parameters_callback(before)
node.remove_post_set_parameters_callback(after)
show("declared badly", lambda: node.declare_parameter("other", "bad").value)
show("refused", lambda: [told(r) for r in node.set_parameters([Parameter("text", value="bad")])])
node.remove_on_set_parameters_callback(check)
print(calls)

show("undeclare", lambda: node.undeclare_parameter("text"))
show("undeclare", lambda: node.undeclare_parameter("text"))
show("undeclare", lambda: node.undeclare_parameter("fixed"))
try:
    node.get_parameter("text")
except ParameterNotDeclaredException:
    print("gone")

parameter = Parameter("p", Parameter.Type.INTEGER, 3)
print(parameter.name, parameter.type_, parameter.value, parameter.get_parameter_value().integer_value)
print(parameter.to_parameter_msg())
print(
    Parameter.from_parameter_msg(parameter.to_parameter_msg()) == parameter,
    parameter == Parameter("p", value=3),
)
show("mismatch", lambda: Parameter("p", Parameter.Type.INTEGER, "three"))
show("no value", lambda: Parameter(3).value)
for value in (None, True, 3, 2.5, "s", [b"a"], [True], [1], [1.5], ["s"], (), [], (1, 2), {}, [None]):
    show(f"type of {value!r}", lambda: Parameter.Type.from_parameter_value(value).name)
for text in ("1", "1.5", "true", "yes", "text", "[1, 2]", "[1, 2.5]", "[a, b]", "[1, a]", "", "null", "'1'"):
    show(f"from {text!r}", lambda: get_parameter_value(text))
show(
    "to python",
    lambda: parameter_value_to_python(ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="v")),
)
show("to python", lambda: parameter_value_to_python(ParameterValue(type=77)))

free = rclpy.create_node(
    "free",
    allow_undeclared_parameters=True,
    parameter_overrides=[Parameter("given", value=1)],
    automatically_declare_parameters_from_overrides=True,
)
show(
    "free",
    lambda: (
        free.get_parameter("given").value,
        free.get_parameter("absent").value,
        free.get_parameter("absent").type_.name,
    ),
)
show("free", lambda: [told(r) for r in free.set_parameters([Parameter("new", value=2)])])
show("free", lambda: free.get_parameter("new").value)
over = rclpy.create_node("over", parameter_overrides=[Parameter("given", value=1)])
show("over", lambda: (over.declare_parameter("given", 5).value, over.has_parameter("given")))
show(
    "ignored",
    lambda: (
        rclpy.create_node("third", parameter_overrides=[Parameter("g", value=1)])
        .declare_parameter("g", 5, ignore_override=True)
        .value
    ),
)
show(
    "override of another type",
    lambda: rclpy.create_node("fourth", parameter_overrides=[Parameter("g", value="x")]).declare_parameter(
        "g", 5
    ),
)
rclpy.shutdown()
