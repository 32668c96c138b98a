"""Tutorial-style rospy programs say under `roslet run` what they say under rospy: not a line of them is changed."""

from __future__ import annotations

import pathlib

import pytest

from compat.both import PROGRAMS, Both, outcome

# Programs that are started together, with their arguments; each prints the same whatever the timing.
SCENES: dict[str, tuple[tuple[str, ...], ...]] = {
    "talker and listener": (("listener.py",), ("talker.py",)),
    "remapped talker and listener": (
        ("listener.py", "chatter:=news", "__ns:=/left"),
        ("talker.py", "/chatter:=/left/news"),
    ),
    "the paper's coordinates": (("coordinate_subscriber.py",), ("coordinate_publisher.py",)),
    "add two ints": (("add_two_ints_server.py",), ("add_two_ints_client.py", "3", "4")),
    "add two ints without arguments": (("add_two_ints_client.py",),),
    "parameters": (("params.py",),),
    "numpy_msg": (("numpy_listener.py",), ("plain_listener.py",), ("numpy_talker.py",)),
    "latched": (("latch.py",),),
    "timers": (("timers.py",),),
    "times": (("times.py",),),
    "names": (("names.py", "old:=new", "__name:=given", "__ns:=/space", "_private:=1", "argument"),),
    "logging": (("logging_functions.py",),),
    "rosout": (("debugging.py",),),
    "messages": (("messages.py",),),
    "threads": (("threads.py",),),
    "any message": (("generic.py",),),
    "a class of its own": (("own_class.py",),),
    "services": (("services.py",),),
    "subscriber listeners": (("listeners.py",),),
    "actions": (("actions.py",),),
    "simulated time": (("simulated_time.py",),),
    **{
        f"ended by {how}": (("endings.py", how),)
        for how in (
            "SIGINT",
            "SIGTERM",
            "loop",
            "signal_shutdown",
            "exit",
            "exception",
            "waiting",
            "return",
        )
    },
}


_expected: dict[str, list[tuple[int, list[str], list[str]]]] = {}


@pytest.mark.parametrize("scene", SCENES)
def test_a_program_says_the_same_under_both(both: Both, scene: str) -> None:
    judges = [both.under_rospy(*command) for command in SCENES[scene] if scene not in _expected]
    ours = [both.under_roslet(*command) for command in SCENES[scene]]
    if judges:
        _expected[scene] = outcome(judges)
    assert outcome(ours) == _expected[scene]
    assert any(lines or errors for _, lines, errors in _expected[scene])


def test_without_numpy_messages_say_the_same(both: Both, tmp_path: pathlib.Path) -> None:
    """Arrays arrive as tuples all the same."""
    (tmp_path / "numpy.py").write_text("raise ImportError('no numpy here')\n", encoding="utf-8")
    judge = [both.under_rospy("messages.py")]
    ours = [both.under_roslet("messages.py", libraries=tmp_path)]
    assert outcome(ours) == outcome(judge)


def test_every_program_is_run() -> None:
    run = {command[0] for commands in SCENES.values() for command in commands}
    assert run == {path.name for path in PROGRAMS.glob("*.py")}
