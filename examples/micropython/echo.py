"""Sends each mros_comm_measure/Coordinate that comes on `ping` back on `pong`; runs on a board as on a desk.

python examples/micropython/echo.py
roslet micropython bundle examples/micropython/echo.py --types examples/msgs --output build
roslet micropython run build --heap 256k
"""

import roslet

Coordinate = roslet.load("examples/msgs").mros_comm_measure.msg.Coordinate

node = roslet.Node("echo", network="ros2://")
pong = node.publisher("pong", Coordinate)
node.subscribe("ping", Coordinate, pong.publish)
node.log.info("ready")
node.spin()
