"""Debian's command-line tools, rospy nodes and roslaunch with our master in place of rosmaster."""

from __future__ import annotations

import json
import pathlib
import textwrap
from collections.abc import Iterator

import pytest

import peers
from interop.ros1 import Master, Program, Tools, wait_until
from roslet.io.select import Reactor
from roslet.master.server import MasterServer

TALKER = """
import rospy, sys
from std_msgs.msg import String
rospy.init_node("talker")
publisher = rospy.Publisher("chatter", String, queue_size=10)
rate = rospy.Rate(50)
print("ready", rospy.get_name(), rospy.get_param("~greeting", "hello"), flush=True)
count = 0
while not rospy.is_shutdown():
    try:
        publisher.publish("%s %d" % (rospy.get_param_cached("/word", "hello"), count))
        count += 1
        rate.sleep()
    except rospy.ROSException:
        pass  # shut down since the loop looked
print("ended", flush=True)
"""

LISTENER = """
import rospy
from std_msgs.msg import String
rospy.init_node("listener")
rospy.Subscriber("chatter", String, lambda message: print("heard", message.data, flush=True))
print("ready", rospy.get_name(), flush=True)
rospy.spin()
print("ended", flush=True)
"""


class OurMaster(Master):
    """Ours, in this process."""

    def start(self) -> None:
        self._loop = Reactor()
        self.server = MasterServer("127.0.0.1", self.port, self._loop)

    def stop(self) -> None:
        self.server.close()
        self._loop.close()

    def log(self) -> str:
        return repr(self.server.drops)


@pytest.fixture
def ours(tmp_path: pathlib.Path) -> Iterator[OurMaster]:
    peers.require("rospy")
    started = OurMaster("roslet", tmp_path)
    yield started
    started.stop()


@pytest.fixture
def debian(ours: OurMaster, tmp_path: pathlib.Path) -> Tools:
    return Tools(ours, tmp_path)


def node(master: Master, source: str, *arguments: str) -> Program:
    """A rospy node that has said that it is ready."""
    started = Program([peers.DEBIAN_PYTHON, "-c", source, *arguments], master.environment())
    started.wait_for("ready")
    return started


def test_rosparam_sets_reads_lists_dumps_loads_and_deletes(
    ours: OurMaster, debian: Tools, tmp_path: pathlib.Path
) -> None:
    debian.run("rosparam", "set", "/robot", "{name: r2, gains: [1.5, 2, true], arm: {length: 3}}")
    debian.run("rosparam", "set", "/robot/arm/joints", "6")
    assert debian.run("rosparam", "get", "/robot/name") == "r2\n"
    assert debian.run("rosparam", "get", "/robot/arm").split() == ["joints:", "6", "length:", "3"]
    assert debian.run("rosparam", "list").split() == [
        "/robot/arm/joints",
        "/robot/arm/length",
        "/robot/gains",
        "/robot/name",
    ]
    debian.run("rosparam", "dump", "kept.yaml", "/robot")
    debian.run("rosparam", "delete", "/robot")
    assert debian.run("rosparam", "list").split() == []
    assert debian.run("rosparam", "get", "/robot", code=1) == ""
    debian.run("rosparam", "load", "kept.yaml", "/copy")
    assert ours.server.call("getParam", "/x", "/copy")[2] == {
        "name": "r2",
        "gains": [1.5, 2, True],
        "arm": {"length": 3, "joints": 6},
    }


def test_a_rospy_talker_and_listener_find_each_other_and_the_tools_see_them(
    ours: OurMaster, debian: Tools
) -> None:
    listener = node(ours, LISTENER)
    talker = node(ours, TALKER)
    listener.wait_for("heard hello", 3)
    assert debian.run("rosnode", "list").split() == ["/listener", "/talker"]
    assert set(debian.run("rostopic", "list").split()) == {"/chatter", "/rosout"}
    assert debian.run("rostopic", "type", "/chatter") == "std_msgs/String\n"
    information = debian.run("rostopic", "info", "/chatter")
    assert "* /talker (http://127.0.0.1:" in information
    assert "* /listener (http://127.0.0.1:" in information
    assert 'data: "hello' in debian.run("rostopic", "echo", "-n", "1", "/chatter")
    assert "/talker/get_loggers" in debian.run("rosservice", "list").split()
    assert 'name: "rospy"' in debian.run("rosservice", "call", "/talker/get_loggers")
    assert " * /chatter [std_msgs/String]" in debian.run("rosnode", "info", "/talker")
    assert "xmlrpc reply from http://127.0.0.1" in debian.run("rosnode", "ping", "-c", "1", "/talker")

    assert talker.stop() == 0
    assert listener.stop() == 0


def test_nodes_follow_parameters_and_each_others_coming_and_going(ours: OurMaster, debian: Tools) -> None:
    listener = node(ours, LISTENER)
    talker = node(ours, TALKER)
    listener.wait_for("heard hello")
    # The talker reads the parameter from its cache, which only the master's updates change.
    debian.run("rosparam", "set", "/word", "changed")
    listener.wait_for("heard changed")

    debian.run("rosnode", "kill", "/talker")
    talker.wait_for("ended")
    wait_until(lambda: debian.run("rosnode", "list").split() == ["/listener"], "the talker is gone")

    # A new talker is found again by the same listener.
    before = len(listener.told("heard changed"))
    again = node(ours, TALKER)
    listener.wait_for("heard changed", before + 1)
    assert again.stop() == 0
    assert listener.stop() == 0
    assert debian.run("rosnode", "list").split() == []


def test_a_second_rospy_node_of_a_name_ends_the_first(ours: OurMaster, debian: Tools) -> None:
    # A missing parameter is asked for anew in every turn, and each question would register the first node again.
    debian.run("rosparam", "set", "/word", "hello")
    listener = node(ours, LISTENER)
    first = node(ours, TALKER)
    listener.wait_for("heard")
    second = node(ours, TALKER)
    first.wait_for("ended")
    before = len(listener.told("heard"))
    listener.wait_for("heard", before + 5)
    assert debian.run("rosnode", "list").split() == ["/listener", "/talker"]
    second.stop()
    listener.stop()
    first.stop()


def test_a_killed_node_is_cleaned_up_by_rosnode(ours: OurMaster, debian: Tools) -> None:
    talker = node(ours, TALKER)
    talker.process.kill()
    talker.process.wait()
    assert debian.run("rosnode", "list").split() == ["/talker"]
    command = [str(peers.require("rosnode")), "cleanup"]
    cleanup = Program(command, ours.environment())
    cleanup.say("y")
    assert cleanup.finish() == 0
    assert debian.run("rosnode", "list").split() == []


def test_rospy_searches_subscribes_and_deletes_parameters(ours: OurMaster) -> None:
    source = """
    import rospy, json
    rospy.init_node("client", anonymous=False)
    rospy.set_param("/a/key", 1)
    rospy.set_param("~private", {"x": [1, "two", 3.0, False]})
    found = [rospy.search_param("private"), rospy.search_param("none"), rospy.has_param("/a/key"),
             rospy.get_param("/a"), rospy.get_param("~private"), rospy.get_param("/none", "default"),
             rospy.get_param_cached("/a/key"), sorted(rospy.get_param_names())]
    rospy.delete_param("/a/key")
    try:
        rospy.delete_param("/a/key")
    except KeyError:
        found.append("KeyError")
    print("ready", json.dumps(found), flush=True)
    """
    client = node(ours, textwrap.dedent(source))
    assert json.loads(client.told("ready")[0].partition(" ")[2]) == [
        "/client/private",
        None,
        True,
        {"key": 1},
        {"x": [1, "two", 3.0, False]},
        "default",
        1,
        ["/a/key", "/client/private/x"],
        "KeyError",
    ]
    assert client.finish() == 0


LAUNCH = """
<launch>
  <param name="/word" value="launched" />
  <rosparam>
    table: {one: 1, list: [a, b], deep: {er: 2.5}}
  </rosparam>
  <group ns="room">
    <node pkg="launched_nodes" type="talker" name="speaker" output="screen" required="true">
      <param name="greeting" value="hey" />
      <remap from="chatter" to="/talk" />
    </node>
    <node pkg="launched_nodes" type="listener" name="ear" output="screen">
      <remap from="chatter" to="/talk" />
    </node>
  </group>
</launch>
"""

PACKAGE = """<package format="2"><name>launched_nodes</name><version>1.0.0</version><description>x</description>
<maintainer email="x@y.z">x</maintainer><license>x</license></package>"""


@pytest.mark.parametrize("with_run_id", [False, True])
def test_roslaunch_starts_nodes_and_takes_them_down(
    ours: OurMaster, debian: Tools, tmp_path: pathlib.Path, with_run_id: bool
) -> None:
    package = tmp_path / "packages" / "launched_nodes"
    package.mkdir(parents=True)
    (package / "package.xml").write_text(PACKAGE)
    (package / "both.launch").write_text(LAUNCH)
    for name, source in (("talker", TALKER), ("listener", LISTENER)):
        script = package / name
        script.write_text(f"#!{peers.DEBIAN_PYTHON}\n{source}")
        script.chmod(0o755)
    environment = ours.environment()
    environment["ROS_PACKAGE_PATH"] = f"{package.parent}:{environment['ROS_PACKAGE_PATH']}"
    if with_run_id:
        ours.server.call("setParam", "/x", "/run_id", "5a1f0a3c-0000-11f0-8000-000000000000")
    command = [str(peers.require("roslaunch")), "--skip-log-check", "launched_nodes", "both.launch"]
    launch = Program(command, environment)
    try:
        launch.wait_for("heard launched", 2)
        assert set(debian.run("rosnode", "list").split()) >= {"/room/speaker", "/room/ear"}
        parameters = ours.server.call("getParam", "/x", "/")[2]
        assert parameters["table"] == {"one": 1, "list": ["a", "b"], "deep": {"er": 2.5}}
        assert parameters["room"]["speaker"]["greeting"] == "hey"
        assert parameters["roslaunch"]["uris"]
        run_id = debian.run("rosparam", "get", "/run_id").strip()
        assert len(run_id) == 36
        assert (run_id == "5a1f0a3c-0000-11f0-8000-000000000000") == with_run_id
        # Taking the required node down takes the launch down.
        debian.run("rosnode", "kill", "/room/speaker")
        assert launch.finish() == 0
    finally:
        launch.stop()
    wait_until(lambda: debian.run("rosnode", "list").split() in ([], ["/rosout"]), "all nodes are gone")
