"""`from roslet.msgs.ros1.std_msgs.msg import String`, and the same under other prefixes."""

from __future__ import annotations

import importlib
import sys
from typing import Any

import pytest

import roslet.msgs
from roslet.gen import runtime
from roslet.msgs import finder


def test_classes_are_imported_by_name() -> None:
    from roslet.msgs.ros1.std_msgs.msg import String
    from roslet.msgs.ros2.example_interfaces.action import Fibonacci
    from roslet.msgs.ros2.example_interfaces.srv import AddTwoInts, AddTwoInts_Request

    assert String is runtime.message_class("ros1", "std_msgs/String")
    assert AddTwoInts.Request is AddTwoInts_Request
    assert Fibonacci.Goal(order=3).order == 3
    assert String("hello").data == "hello"


def test_a_package_has_its_kinds_as_attributes() -> None:
    package: Any = importlib.import_module("roslet.msgs.ros1.sensor_msgs")
    assert package.msg.Image._type == "sensor_msgs/Image"
    assert package.srv.SetCameraInfo.Request
    with pytest.raises(AttributeError):
        _ = package.action


def test_a_star_import_brings_all_classes_with_those_that_are_derived() -> None:
    scope: dict[str, Any] = {}
    exec("from roslet.msgs.ros1.actionlib.msg import *", scope)
    assert {"TestAction", "TestActionGoal", "TestRequestGoal"} <= set(scope)
    module = importlib.import_module("roslet.msgs.ros1.std_srvs.srv")
    assert dir(module)[:3] == ["Empty", "EmptyRequest", "EmptyResponse"]


def test_what_is_not_there_is_an_import_error() -> None:
    with pytest.raises(ImportError):
        importlib.import_module("roslet.msgs.ros1.no_such_package")
    with pytest.raises(ImportError):
        importlib.import_module("roslet.msgs.ros1.std_msgs.action")
    with pytest.raises(ImportError):
        exec("from roslet.msgs.ros1.std_msgs.msg import NoSuchMessage")


def test_packages_can_stand_at_the_top() -> None:
    installed = finder.install("", "ros1", first=False)
    try:
        assert finder.install("", "ros1") is installed
        module = importlib.import_module("visualization_msgs.msg")
        assert module.Marker is runtime.message_class("ros1", "visualization_msgs/Marker")
        with pytest.raises(ImportError):
            importlib.import_module("no_such_package_at_all")
    finally:
        finder.uninstall(installed)
        for name in [name for name in sys.modules if name.startswith("visualization_msgs")]:
            del sys.modules[name]
    assert roslet.msgs.__doc__
