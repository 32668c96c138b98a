"""Serves the action `fibonacci`, or sends it a goal, or both; shows feedback, and how a goal is canceled. ROS 2 only.

python action.py server &
python action.py client --order 10
python action.py client --order 30 --cancel-after 3
roslet action send_goal /fibonacci example_interfaces/action/Fibonacci "{order: 5}" --feedback
"""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any

import roslet

KIND = "example_interfaces/action/Fibonacci"


def main() -> int:
    parser = argparse.ArgumentParser(description="The action fibonacci.")
    parser.add_argument("role", choices=("server", "client", "both"), nargs="?", default="both")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://; ROS 1 has no actions of its own"
    )
    parser.add_argument(
        "--order", type=int, default=8, help="numbers wanted beyond the first two (default 8)"
    )
    parser.add_argument("--cancel-after", type=int, metavar="N", help="cancel the goal after N feedbacks")
    parser.add_argument("--pause", type=float, default=0.1, help="seconds for each number (default 0.1)")
    arguments = parser.parse_args()

    def compute(goal: Any) -> dict[str, list[int]] | None:
        """Runs in a thread of its own for each goal, so it may take its time."""
        sequence = [0, 1]
        for _ in range(goal.request.order):
            if goal.cancel_requested:
                goal.canceled(sequence=sequence)
                return None
            sequence.append(sequence[-1] + sequence[-2])
            goal.feedback(sequence=sequence)
            time.sleep(arguments.pause)
        return {"sequence": sequence}

    with roslet.Node("fibonacci_" + arguments.role, network=arguments.network) as node:
        if arguments.role != "client":
            node.action_server("fibonacci", KIND, compute, on_goal=lambda request: 0 <= request.order <= 40)
        if arguments.role == "server":
            node.spin()
            return 0

        client = node.action_client("fibonacci", KIND)
        if not client.wait(timeout=10.0):
            print("no action fibonacci", file=sys.stderr)
            return 1
        heard: list[int] = []

        def feedback(message: Any) -> None:
            heard.append(message.sequence[-1])
            print(f"so far {heard[-1]}", flush=True)
            if len(heard) == arguments.cancel_after:
                goal.cancel_async()

        goal = client.send_goal(order=arguments.order, feedback=feedback, timeout=5.0)
        status, result = goal.result(timeout=60.0)
        print(status, *result.sequence, flush=True)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(0)
