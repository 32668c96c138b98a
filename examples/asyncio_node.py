"""A node in an asyncio program: `async for` over a topic, `await` on a service, beside other tasks.

python asyncio_node.py --count 5
"""

from __future__ import annotations

import argparse
import asyncio
import sys
from typing import Any

import roslet


async def talk(node: roslet.Node, count: int) -> None:
    chatter = node.publisher("chatter", "std_msgs/String")
    while not chatter.subscriber_count:
        await asyncio.sleep(0.01)
    for number in range(1, count + 1):
        chatter.publish(data=f"Hello asyncio {number}")
        await asyncio.sleep(0.02)


async def listen(subscription: roslet.Subscription, count: int) -> None:
    heard = 0
    async for message in subscription:
        print(f"I heard: {message.data}", flush=True)
        heard += 1
        if heard == count:
            return


async def ask(node: roslet.Node) -> None:
    client = node.client("switch", "std_srvs/SetBool")
    response = await client.call_async(data=True)
    print(f"the switch says: {response.message}", flush=True)


async def run(network: str, count: int) -> None:
    def switch(request: Any) -> dict[str, Any]:
        return {"success": True, "message": "on" if request.data else "off"}

    with roslet.Node("asyncio_node", network=network) as node:
        node.service("switch", "std_srvs/SetBool", switch)
        subscription = node.subscribe("chatter", "std_msgs/String")
        await asyncio.wait_for(
            asyncio.gather(talk(node, count), listen(subscription, count), ask(node)), 30.0
        )


def main() -> int:
    parser = argparse.ArgumentParser(description="Topic and service in one asyncio program.")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    parser.add_argument("--count", type=int, default=5, help="messages (default 5)")
    arguments = parser.parse_args()
    asyncio.run(run(arguments.network, arguments.count))
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(0)
