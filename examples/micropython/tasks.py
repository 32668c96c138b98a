"""A node beside other tasks of asyncio: counts once a second on `count`, and prints what it hears on `chatter`.

roslet micropython bundle examples/micropython/tasks.py --output build
roslet micropython run build
"""

import asyncio

import roslet

node = roslet.Node("tasks", network="ros2://")
count = node.publisher("count", "std_msgs/msg/UInt32")
chatter = node.subscribe("chatter", "std_msgs/msg/String")


async def counting() -> None:
    while not node.is_shutdown:
        count.publish(data=count.messages)
        await asyncio.sleep(1.0)


async def main() -> None:
    task = asyncio.create_task(counting())
    async for message in chatter:  # serves the node as well
        print(message.data)
    await task


asyncio.run(main())
