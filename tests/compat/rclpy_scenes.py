"""Which rclpy programs are started together, under which interpreter, and what they say.

`python tests/compat/rclpy_scenes.py DISTRIBUTION [SCENE ...]` writes the files of `programs/rclpy/expected` anew, out of
what the real rclpy of that distribution says.
"""

from __future__ import annotations

import pathlib
import re
import sys
import tempfile

import peers
from interop.namespace import Namespace, Program

PROGRAMS = pathlib.Path(__file__).resolve().parent / "programs/rclpy"
EXPECTED = PROGRAMS / "expected"
# The package that the programs' action is in.
DEFINITIONS = PROGRAMS / "ws"

# Programs that are started together, with their arguments; each prints the same whatever the timing.
SCENES: dict[str, tuple[tuple[str, ...], ...]] = {
    "function talker, function listener": (("listener_function.py",), ("talker_function.py",)),
    "member talker, member listener": (("listener_member.py",), ("talker_member.py",)),
    "function talker, lambda listener": (("listener_lambda.py",), ("talker_function.py",)),
    "function talker, two listeners": (
        ("listener_function.py",),
        ("listener_member.py",),
        ("talker_pair.py",),
    ),
    "remapped talker and listener": (
        ("listener_function.py", "--ros-args", "-r", "chatter:=news", "-r", "__ns:=/left"),
        ("talker_function.py", "--ros-args", "-r", "/chatter:=/left/news", "-r", "__node:=teller"),
    ),
    "publishers": (("publishers.py",),),
    "waiting for messages": (("wait_for_message.py",),),
    "messages": (("messages.py",),),
    "serialization": (("serialization.py",),),
    "annotations": (("annotations.py",),),
    "type support": (("type_support.py",),),
    "timers": (("timers.py",),),
    "rates": (("rates.py",),),
    "times": (("times.py",),),
    "simulated time": (("simulated_time.py",),),
    "services": (("services.py",),),
    "service and client": (("services_server.py",), ("services_client.py",)),
    "failing services": (("service_failing.py",),),
    "actions": (("actions.py",),),
    "destroyed action servers": (("actions_gone.py",),),
    "late goals": (("actions_late.py",),),
    "action server and client": (("action_server.py",), ("action_client.py",)),
    "judged goals": (("action_judge.py",), ("action_suitor.py",)),
    "corners": (("corners.py",),),
    "parameters": (("parameters.py",),),
    "parameter clients": (("parameter_clients.py",),),
    "parameters of another node": (("parameter_owner.py",), ("parameter_asker.py",)),
    "quality of service": (("qos.py",),),
    "what fits best": (("qos_best.py",),),
    "events": (("qos_events.py",),),
    "callback groups": (("callback_groups.py",),),
    "executors": (("executors.py",),),
    "futures": (("futures.py",),),
    "logging": (("logging_functions.py",),),
    "graph": (("graph.py",),),
    "contexts": (("contexts.py",),),
    "life of a node": (("node_life.py",),),
    "lifecycle nodes": (("lifecycle.py",),),
    "managed node": (("lifecycle_managed.py",), ("lifecycle_manager.py",)),
    "validation": (("validation.py",),),
    "no arguments": (("arguments.py",),),
    "arguments": (
        (
            "arguments.py",
            "one",
            *("--ros-args", "-r", "__node:=renamed", "-r", "__ns:=/given", "-r", "chatter:=news"),
            *(
                "-r",
                "/absolute:=/elsewhere",
                "-r",
                "~/private:=hidden",
                "-p",
                "number:=5",
                "-p",
                "text:=word",
            ),
            *(
                "-p",
                "list:=[1, 2]",
                "-p",
                "flag:=true",
                "-p",
                "real:=2.5",
                "--log-level",
                "warn",
                "--",
                "two",
            ),
        ),
    ),
    "a file of parameters": (
        ("arguments.py", "--ros-args", "--params-file", str(PROGRAMS / "arguments.yaml"), "-p", "number:=7"),
    ),
    **{
        f"ended by {how}": (("endings.py", how),)
        for how in (
            "SIGINT",
            "SIGTERM",
            "SIGINT of threads",
            "SIGINT in a callback",
            "loop",
            "own handlers",
            "elsewhere",
            "uncaught",
            "exit",
            "exception",
            "return",
        )
    },
}

# Their log lines on standard error are compared too.
LOGGED = ("logging",)
# They need the package test_msgs, the only one among the wheels that has an action.
NEED_TEST_MSGS = (
    "actions",
    "destroyed action servers",
    "late goals",
    "corners",
    "action server and client",
    "judged goals",
)

_LOG = re.compile(r"\[(DEBUG|INFO|WARN|ERROR|FATAL)\] \[\d+\.\d+\] (?!\[(?:rcl|rmw))")
_TIME = re.compile(r"\[\d{9,}\.\d+\]")
# Where in the C sources of the judge an error was found.
_PLACE = re.compile(r", at /\S+\.c(?:pp)?:\d+")


def file_of(scene: str) -> pathlib.Path:
    """What is expected of a scene."""
    return EXPECTED / (scene.replace(",", "").replace(" ", "_") + ".txt")


# Words before a program's file, and its environment.
Interpreter = tuple[tuple[str, ...], dict[str, str]]


def play(scene: str, folder: pathlib.Path, *interpreters: Interpreter) -> str:
    """What the programs of a scene say: for each one its exit code, its output, and log lines where they are compared. The
    programs take the interpreters in turn."""
    with Namespace(folder) as namespace:
        started = []
        for number, command in enumerate(SCENES[scene]):
            words, environment = interpreters[number % len(interpreters)]
            environment = {"PYTHONUNBUFFERED": "1", "ROS_LOG_DIR": str(folder / "log"), **environment}
            line = (*words, str(PROGRAMS / command[0]), *command[1:])
            started.append(namespace.start(*line, name=f"{number}", **environment))
        said = [_told(scene, program) for program in started]
    return "".join(
        f"== {' '.join(command).replace(str(PROGRAMS) + '/', '')}\n{text}"
        for command, text in zip(SCENES[scene], said, strict=True)
    )


def _told(scene: str, program: Program) -> str:
    code = program.process.wait(60)
    lines = [_PLACE.sub("", line) for line in program.lines()]
    if scene in LOGGED:
        errors = program.errors.read_text().splitlines()
        lines += [_TIME.sub("[now]", line) for line in errors if _LOG.match(line)]
    return "".join(line + "\n" for line in [*lines, f"exit {code}"])


def rclpy(distribution: str, scene: str) -> Interpreter:
    """The real one."""
    if scene in NEED_TEST_MSGS:
        peers.require(f"{distribution}-test-msgs")
    return (str(peers.require(distribution)),), {}


def roslet() -> Interpreter:
    """`roslet run`."""
    words = (sys.executable, "-m", "roslet.cli.main", "run")
    return words, {"PYTHONPATH": str(peers.ROOT / "src"), "ROSLET_TYPES": str(DEFINITIONS)}


def under_rclpy(distribution: str, scene: str, folder: pathlib.Path) -> str:
    """As `play`, under the real one."""
    return play(scene, folder, rclpy(distribution, scene))


def under_roslet(scene: str, folder: pathlib.Path) -> str:
    """As `play`, under `roslet run`."""
    return play(scene, folder, roslet())


def main(distribution: str, *scenes: str) -> None:
    """Write what is expected anew."""
    EXPECTED.mkdir(exist_ok=True)
    for scene in scenes or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            file_of(scene).write_text(
                under_rclpy(distribution, scene, pathlib.Path(folder)), encoding="utf-8"
            )
        print(scene)


if __name__ == "__main__":
    main(*sys.argv[1:])
