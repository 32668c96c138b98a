"""The echo node of `roslet bench` on MicroPython, bundled as for a board (board.py). The network is $ROSLET_NETWORK. A
letter on `ping`, the N-th of the alphabet, is answered by 2**N letters on `pong`; a Coordinate by itself."""

import os

import roslet

node = roslet.Node("bench_board", network=os.getenv("ROSLET_NETWORK"))
texts = node.publisher("pong", "std_msgs/String", qos=10)
coordinates = node.publisher("pong_coordinate", "mros_comm_measure/Coordinate", qos=10)


def answer(message):
    texts.publish(data="x" * (1 << ord(message.data) - ord("a")))


node.subscribe("ping", "std_msgs/String", answer, qos=10)
node.subscribe("ping_coordinate", "mros_comm_measure/Coordinate", coordinates.publish, qos=10)
node.spin()
