"""A Ctrl-C is raised between any two bytecodes of the main thread, also in the midst of a call of the master."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest

from roslet import Node
from roslet.master.server import MasterServer
from roslet.wire import xmlrpc


def test_a_node_is_unregistered_though_ctrl_c_came_while_an_answer_was_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole: Callable[[Any], Any] = xmlrpc.parse_response
    interrupted = threading.Event()

    def parse(data: Any) -> Any:
        if threading.current_thread() is threading.main_thread() and not interrupted.is_set():
            interrupted.set()
            raise KeyboardInterrupt
        return whole(data)

    with MasterServer("127.0.0.1", 0) as master:
        with pytest.raises(KeyboardInterrupt), Node("n", network=f"ros1://127.0.0.1:{master.port}") as node:
            node.publisher("chatter", "std_msgs/String")
            monkeypatch.setattr(xmlrpc, "parse_response", parse)
            for _ in range(
                1000
            ):  # until it is this thread that serves the loop, not the one in the background
                node.has_parameter("/x")
        assert interrupted.is_set()
        assert master.call("getSystemState", "/test")[2] == [[], [], []]
