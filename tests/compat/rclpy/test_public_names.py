"""What a program can import from each module of the real rclpy, it can import under `roslet run`."""

from __future__ import annotations

import os
import pathlib
import subprocess
import textwrap

import pytest

import peers
from compat.rclpy_scenes import roslet

# Told in FEATURES.md.
NO_MODULES = {
    "rclpy.destroyable",
    "rclpy.experimental",
    "rclpy.experimental.events_executor",
    "rclpy.impl.implementation_singleton",
    "rclpy.parameter_service",
    "rclpy.service_introspection",
    "rclpy.subscription_content_filter_options",
    "rclpy.type_description_service",
}
# C handles, wait sets, introspection, content filters, and what is served by others of ours.
NO_NAMES = {
    *("ClockHandle", "ContextHandle", "DestroyableType", "DurationType", "GoalEvent", "TimeHandle"),
    *("ContentFilterOptions", "ParameterService", "ServiceIntrospectionState", "SignalHandlerGuardCondition"),
    *("TimeoutObject", "TypeDescriptionService"),
}
# What only type checkers and the modules themselves have use for.
OF_TYPES = {
    *("CommonMsgSrvMetaClass", "CreateLifecyclePublisherArgs", "EventMessage", "FeedbackMessage"),
    *("GetResultService", "GetResultServiceRequest", "GetResultServiceResponse", "LifecycleNodeArgs"),
    *("MsgMetaClass", "PyCapsule", "SendGoalKWargs", "SendGoalService", "SendGoalServiceRequest"),
    *("SendGoalServiceResponse", "T", "TimeJumpDictionary", "TypeHashDictionary", "WaitableEntityType"),
}
# Its filters of log lines are a table of our own.
OF_LOGGING = "rclpy.impl.rcutils_logger"

PUBLIC = """
    import importlib, pkgutil, sys, types, warnings

    import rclpy

    warnings.simplefilter("ignore")
    OTHERS = {*sys.stdlib_module_names, "typing_extensions"}
    for info in pkgutil.walk_packages(rclpy.__path__, "rclpy."):
        if "._" in info.name:
            continue
        module = importlib.import_module(info.name)
        print(info.name)
        for name, value in vars(module).items():
            of = getattr(value, "__module__", None) or type(value).__module__
            within = of.partition(".")[0]
            if name[0] != "_" and not isinstance(value, types.ModuleType) and within not in OTHERS:
                print(info.name, name)
"""
LACKING = """
    import sys

    import rclpy

    for line in open(sys.argv[1]):
        module, _, name = line.strip().partition(" ")
        try:
            exec(f"from {module} import {name}" if name else f"import {module}")
        except ImportError:
            print(line.strip())
"""


def _said(
    folder: pathlib.Path,
    source: str,
    interpreter: tuple[str, ...],
    arguments: tuple[str, ...] = (),
    **more: str,
) -> str:
    """What a program prints."""
    file = folder / "program.py"
    file.write_text(textwrap.dedent(source), encoding="utf-8")
    words = [*interpreter, str(file), *arguments]
    environment = {**os.environ, **more}
    return subprocess.run(
        words, env=environment, stdout=subprocess.PIPE, text=True, check=True, timeout=60
    ).stdout


@pytest.mark.parametrize("distribution", ["kilted", "jazzy"])
def test_only_what_is_documented_is_lacking(distribution: str, tmp_path: pathlib.Path) -> None:
    public = tmp_path / "public.txt"
    public.write_text(_said(tmp_path, PUBLIC, (str(peers.require(distribution)),)), encoding="utf-8")
    words, environment = roslet()
    said = _said(tmp_path, LACKING, words, (str(public),), **environment)
    lacking = {tuple(line.split()) for line in said.splitlines()}
    assert len(public.read_text().splitlines()) > 500
    assert {one[0] for one in lacking if len(one) == 1} <= NO_MODULES
    names = {one for one in lacking if len(one) == 2 and one[0] not in NO_MODULES | {OF_LOGGING}}
    assert {one for one in names if one[1] not in NO_NAMES | OF_TYPES} == set()
