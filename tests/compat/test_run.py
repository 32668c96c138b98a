"""`roslet run`: how programs are found, how they end, and what is left of them."""

from __future__ import annotations

import os
import pathlib
import signal
import subprocess
import sys
import time

import pytest

import peers
from compat.both import WORKSPACE
from interop.ros1 import Master, Program, free_port, wait_until

COMMAND = [sys.executable, "-m", "roslet.cli.main", "run"]


def environment(**more: str) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    return {**kept, "PYTHONPATH": str(peers.ROOT / "src"), "PYTHONUNBUFFERED": "1", **more}


def run(*arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *arguments],
        env=environment(**variables),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )


def script(folder: pathlib.Path, text: str, name: str = "program.py") -> str:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_program_sees_itself_as_main_with_its_arguments(tmp_path: pathlib.Path) -> None:
    (tmp_path / "beside.py").write_text("here = True\n", encoding="utf-8")
    path = script(
        tmp_path,
        "import sys, beside\nprint(__name__, __file__, sys.argv, sys.modules['__main__'].sys is sys)",
    )
    done = run(path, "a:=b", "--option", "-x")
    assert done.stdout == f"__main__ {path} {[path, 'a:=b', '--option', '-x']} True\n"
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(
    ("text", "code", "error"),
    [
        ("import sys; sys.exit(7)", 7, ""),
        ("import sys; sys.exit()", 0, ""),
        ("import sys; sys.exit('a message')", 1, "a message\n"),
        ("raise KeyboardInterrupt", 130, ""),
    ],
)
def test_the_exit_code_is_the_program_s(tmp_path: pathlib.Path, text: str, code: int, error: str) -> None:
    done = run(script(tmp_path, text))
    assert (done.returncode, done.stderr) == (code, error)


def test_what_is_not_caught_is_printed_from_the_program_s_first_line_on(tmp_path: pathlib.Path) -> None:
    path = script(tmp_path, "import rospy\nrospy.get_rostime()\n")
    done = run(path)
    assert done.returncode == 1
    lines = done.stderr.splitlines()
    assert lines[:2] == ["Traceback (most recent call last):", f'  File "{path}", line 2, in <module>']
    assert lines[-1].startswith("rospy.exceptions.ROSInitException: time is not initialized")


def test_a_syntax_error_is_printed(tmp_path: pathlib.Path) -> None:
    done = run(script(tmp_path, "if\n"))
    assert done.returncode == 1
    assert "SyntaxError" in done.stderr


def test_a_script_that_is_not_there_is_named(tmp_path: pathlib.Path) -> None:
    done = run(str(tmp_path / "none.py"))
    assert done.returncode == 2
    assert "none.py" in done.stderr
    assert "Traceback" not in done.stderr


USER = "from my_msgs.msg import Point9\nprint(Point9(1.5)._type, Point9(x=2.0).x)\n"


def package(folder: pathlib.Path) -> pathlib.Path:
    (folder / "my_msgs/msg").mkdir(parents=True)
    (folder / "my_msgs/msg/Point9.msg").write_text("float64 x\n", encoding="utf-8")
    (folder / "my_msgs/package.xml").write_text("<package><name>my_msgs</name></package>", encoding="utf-8")
    return folder


def test_definitions_are_found_by_option_by_variable_and_by_ros_package_path(tmp_path: pathlib.Path) -> None:
    workspace = str(package(tmp_path / "ws"))
    path = script(tmp_path, USER)
    said = "my_msgs/Point9 2.0\n"
    assert run("--types", workspace, path).stdout == said
    assert run(path, ROSLET_TYPES=workspace).stdout == said
    assert run(path, ROS_PACKAGE_PATH=workspace).stdout == said
    missing = run(path)
    assert missing.returncode == 1
    assert "No module named 'my_msgs'" in missing.stderr


def test_a_script_s_own_package_needs_no_option(tmp_path: pathlib.Path) -> None:
    folder = package(tmp_path / "ws") / "my_msgs"
    script(folder, "def help():\n    return 'help'\n", "src/my_msgs/helpers.py")
    script(folder, "", "src/my_msgs/__init__.py")
    path = script(folder, USER + "from my_msgs import helpers\nprint(helpers.help())\n", "scripts/node.py")
    done = run(path)
    assert (done.stdout, done.stderr) == ("my_msgs/Point9 2.0\nhelp\n", "")


def test_imports_of_every_kind_find_the_same_classes(tmp_path: pathlib.Path) -> None:
    path = script(
        tmp_path,
        """
import std_msgs.msg, std_srvs.srv, std_srvs
from std_msgs.msg import *
from std_msgs.msg._String import String as other
import actionlib_tutorials.msg as tutorials
import genpy, genpy.message, roslib, roslib.message, rosgraph, rosgraph.masterapi
import rospy, rospy.exceptions, rospy.names, rospy.core, rospy.client, rospy.numpy_msg, rospy.impl.tcpros_service
roslib.load_manifest("anything")
print(String is std_msgs.msg.String is other, std_srvs.srv.SetBoolRequest is std_srvs.srv.SetBool._request_class)
print(tutorials.FibonacciActionGoal._type, tutorials.FibonacciGoal().order, 'String' in dir(std_msgs.msg))
print(rospy.Time is rospy.rostime.Time, rospy.ServiceException is rospy.service.ServiceException)
print(issubclass(rospy.Time, genpy.Time), roslib.message.get_message_class("std_msgs/String") is String)
for module, name in ((std_msgs.msg, 'Nothing'), (std_msgs, 'nothing')):
    try:
        getattr(module, name)
    except AttributeError as error:
        print(error)
try:
    from std_msgs.msg import Nothing
except ImportError as error:
    print(type(error).__name__)
""",
    )
    done = run(path)
    assert (done.stderr, done.returncode) == ("", 0)
    assert done.stdout.splitlines() == [
        "True True",
        "actionlib_tutorials/FibonacciActionGoal 0 True",
        "True True",
        "True True",
        "module 'std_msgs.msg' has no attribute 'Nothing'",
        "module 'std_msgs' has no attribute 'nothing': only its definitions are here",
        "ImportError",
    ]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("import tf2_ros", "ModuleNotFoundError: tf2_ros is no part of roslet"),
        (
            "import tf; tf.TransformListener",
            "AttributeError: module 'tf' has no attribute 'TransformListener'",
        ),
        ("import actionlib; actionlib.SimpleActionClient", "its clients and servers are not"),
        ("import cv_bridge", "numpy.frombuffer"),
    ],
)
def test_what_is_not_there_is_said_to_be_not_there(tmp_path: pathlib.Path, line: str, said: str) -> None:
    done = run(script(tmp_path, line))
    assert done.returncode == 1
    assert said in done.stderr


def test_an_installed_package_keeps_its_own_code(tmp_path: pathlib.Path) -> None:
    (tmp_path / "tf").mkdir()
    (tmp_path / "tf/__init__.py").write_text("class TransformListener:\n    pass\n", encoding="utf-8")
    path = script(
        tmp_path, "import tf\nfrom tf.msg import tfMessage\nprint(tf.TransformListener, tfMessage._type)"
    )
    assert run(path).stdout == "<class 'tf.TransformListener'> tf/tfMessage\n"


def test_a_wrong_definition_is_named_with_its_line(tmp_path: pathlib.Path) -> None:
    folder = package(tmp_path / "ws")
    (folder / "my_msgs/msg/Point9.msg").write_text("float64 x\nnonsense\n", encoding="utf-8")
    done = run("--types", str(folder), script(tmp_path, USER))
    assert done.returncode == 1
    assert "Point9.msg:2" in done.stderr


def test_a_real_rospy_is_imported_only_where_it_is_asked_for(tmp_path: pathlib.Path) -> None:
    (tmp_path / "rospy.py").write_text("real = True\n", encoding="utf-8")
    path = script(tmp_path, "import rospy\nprint(hasattr(rospy, 'real'))\n")
    assert run(path).stdout == "False\n"
    assert run("--real", path).stdout == "True\n"


def test_importing_rospy_and_messages_loads_nothing_heavy(tmp_path: pathlib.Path) -> None:
    heavy = [
        "numpy",
        "yaml",
        "logging",
        "asyncio",
        "xmlrpc.client",
        "http.client",
        "unittest",
        "email",
        "importlib.metadata",
        "ssl",
    ]
    text = "import rospy, sys\nfrom sensor_msgs.msg import LaserScan\nfrom std_srvs.srv import Trigger\n"
    path = script(tmp_path, text + f"print([name for name in {heavy!r} if name in sys.modules])\n")
    assert run(path).stdout == "[]\n"


def test_the_network_can_be_given(master: Master, tmp_path: pathlib.Path) -> None:
    path = script(tmp_path, "import rospy\nrospy.init_node('given')\nprint(rospy.get_master().target)\n")
    assert run("--network", master.network, path).stdout == master.uri + "\n"


# -- how it ends

WAITS = """
import sys
import rospy
from std_msgs.msg import String
from std_srvs.srv import Empty
rospy.init_node(sys.argv[1])
pub = rospy.Publisher("ends_" + sys.argv[1], String, queue_size=1)
sub = rospy.Subscriber("ends_too_" + sys.argv[1], String, print)
service = rospy.Service("ends_service_" + sys.argv[1], Empty, lambda request: [])
rospy.on_shutdown(lambda: print("bye", flush=True))
print("ready", flush=True)
rospy.spin()
"""


def start(master: Master, path: str, *arguments: str, **variables: str) -> Program:
    return Program([*COMMAND, path, *arguments], environment(ROS_MASTER_URI=master.uri, **variables))


def state(master: Master) -> str:
    """Everything that the master knows, as text."""
    import xmlrpc.client

    return str(xmlrpc.client.ServerProxy(master.uri).getSystemState("/test"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_program_well_within_a_second_and_nothing_is_left_of_it(
    master: Master, tmp_path: pathlib.Path, number: signal.Signals
) -> None:
    name = f"signalled_{number.name}"
    program = start(master, script(tmp_path, WAITS), name)
    program.wait_for("ready")
    assert state(master).count(f"/{name}'") >= 4
    begin = time.monotonic()
    program.process.send_signal(number)
    assert program.process.wait(5) == 0
    assert time.monotonic() - begin < 0.9
    assert program.finish() == 0
    assert program.lines == ["ready", "bye"]
    assert program.errors == []
    assert name not in state(master)


def test_a_program_that_catches_keyboard_interrupt_still_ends(master: Master, tmp_path: pathlib.Path) -> None:
    text = WAITS.replace("rospy.spin()", "import time\nwhile not rospy.is_shutdown():\n    time.sleep(0.05)")
    program = start(master, script(tmp_path, text), "sleeps")
    program.wait_for("ready")
    program.process.send_signal(signal.SIGINT)
    assert program.finish() == 0
    assert "sleeps" not in state(master)


def test_a_program_that_falls_off_its_end_is_unregistered(master: Master, tmp_path: pathlib.Path) -> None:
    program = start(master, script(tmp_path, WAITS.replace("rospy.spin()", "")), "falls_off")
    assert program.finish() == 0
    assert program.lines == ["ready", "bye"]
    assert "falls_off" not in state(master)


def test_a_second_node_of_the_name_ends_the_first(master: Master, tmp_path: pathlib.Path) -> None:
    path = script(tmp_path, WAITS)
    first = start(master, path, "twin")
    first.wait_for("ready")
    second = start(master, path, "twin")
    second.wait_for("ready")
    assert first.finish() == 0
    assert "new node registered with same name" in "\n".join(first.lines + first.errors)
    assert second.process.poll() is None
    assert state(master).count("/twin'") >= 4
    assert second.stop() == 0


def test_disable_signals_leaves_them_to_the_program(master: Master, tmp_path: pathlib.Path) -> None:
    path = script(
        tmp_path,
        """
import rospy, time
rospy.init_node("own_signals", disable_signals=True)
print("ready", flush=True)
try:
    time.sleep(20)
except KeyboardInterrupt:
    print("mine", rospy.is_shutdown(), flush=True)
""",
    )
    program = start(master, path)
    program.wait_for("ready")
    program.process.send_signal(signal.SIGINT)
    assert program.finish() == 0
    assert program.lines == ["ready", "mine False"]


def test_a_program_waits_for_a_master_that_comes_later(tmp_path: pathlib.Path) -> None:
    port = free_port()
    path = script(tmp_path, WAITS)
    early = Program(
        [*COMMAND, path, "early", "_param:=5"], environment(ROS_MASTER_URI=f"http://127.0.0.1:{port}")
    )
    wait_until(lambda: early.errors, "a waiting program says so")
    assert "Unable to immediately register with master node" in early.errors[0]
    late = Master("roslet", tmp_path, port)
    try:
        early.wait_for("ready")
        assert early.stop() == 0
        assert len(early.errors) == 1
    finally:
        late.stop()


def test_a_wait_for_the_master_can_be_interrupted(tmp_path: pathlib.Path) -> None:
    program = Program(
        [*COMMAND, script(tmp_path, WAITS), "never"], environment(ROS_MASTER_URI="http://127.0.0.1:1")
    )
    wait_until(lambda: program.errors, "a waiting program says so")
    program.process.send_signal(signal.SIGINT)
    assert program.finish() == 1
    assert "init_node interrupted before it could complete" in program.errors[-1]


SLOW = """
import sys, time
import rospy
from std_msgs.msg import Int32, String
rospy.init_node("slow")
seen = []
waiting = []
def callback(message):
    time.sleep(0.0005)
    seen.append(int(message.data[:8]))
    waiting.append(len(sub.impl.worker))
sub = rospy.Subscriber("flood", String, callback, queue_size=eval(sys.argv[1]))
print("ready", flush=True)
while not seen or seen[-1] != 4999:
    time.sleep(0.01)
print(len(seen), seen == sorted(seen), max(waiting))
"""

FLOOD = """
import rospy
from std_msgs.msg import String
rospy.init_node("flood")
pub = rospy.Publisher("flood", String, queue_size=0)
while not pub.get_num_connections():
    rospy.sleep(0.01)
for number in range(5000):
    pub.publish("%08d" % number + "x" * 2000)
while pub.get_num_connections():
    rospy.sleep(0.01)
"""


@pytest.mark.parametrize(("size", "all_of_them"), [("None", True), ("5", False)])
def test_a_slow_callback_holds_the_publisher_back_or_drops_by_its_queue_size(
    master: Master, tmp_path: pathlib.Path, size: str, all_of_them: bool
) -> None:
    slow = start(master, script(tmp_path, SLOW, "slow.py"), size)
    slow.wait_for("ready")
    flood = start(master, script(tmp_path, FLOOD, "flood.py"))
    assert slow.finish(20) == 0
    assert flood.finish(20) == 0
    count, ordered, most_waiting = slow.lines[-1].split()
    assert ordered == "True"
    # Without a queue size: those that make us stop reading, and what one read of the socket may bring.
    assert int(most_waiting) <= (2500 if all_of_them else 5)
    assert (int(count) == 5000) == all_of_them


def test_the_loggers_can_be_set_from_outside(master: Master, tmp_path: pathlib.Path) -> None:
    path = script(
        tmp_path,
        """
import rospy
from roscpp.srv import GetLoggers, SetLoggerLevel
rospy.init_node("quiet")
loggers = rospy.ServiceProxy("/quiet/get_loggers", GetLoggers)
print([(one.name, one.level) for one in loggers().loggers])
rospy.loginfo("heard")
rospy.ServiceProxy("/quiet/set_logger_level", SetLoggerLevel)("rosout", "WARN")
rospy.loginfo("not heard")
print([(one.name, one.level) for one in loggers().loggers])
""",
    )
    program = start(master, path, ROSCONSOLE_FORMAT="${severity}|${node}|${message}")
    assert program.finish() == 0
    assert program.lines == ["[('rosout', 'info')]", "INFO|/quiet|heard", "[('rosout', 'warn')]"]


def test_the_workspace_of_the_programs_is_legal() -> None:
    from roslet.idl import Registry

    assert len(Registry("ros1", None).load(WORKSPACE)) == 5
