"""Sends Coordinates to an echo and waits for each. roslet_pinger.py NETWORK COUNT NAME [QUIET]: with QUIET it is
only there, for that many seconds. Rests after every thousand. Prints how many came back right, and how many a second."""

import sys
import time

import roslet

# Seconds in which the echo comes to rest and measures what it holds.
REST = 0.5

network, count, name = sys.argv[1], int(sys.argv[2]), sys.argv[3]
Coordinate = roslet.load(sys.argv[4]).mros_comm_measure.msg.Coordinate
with roslet.Node(name, network=network) as node:
    if len(sys.argv) > 5:
        node.subscribe("pong", Coordinate, lambda message: None)
        node.publisher("ping", Coordinate)
        print("ready", flush=True)
        node.spin(float(sys.argv[5]))
        sys.exit()
    returned = []
    pong = node.subscribe("pong", Coordinate, lambda message: returned.append(message.x), qos=100)
    ping = node.publisher("ping", Coordinate, qos=100)
    ping.wait_for_subscribers(1, 20.0)
    pong.wait_for_publishers(1, 20.0)
    node.sleep(0.3)
    begin = time.monotonic()
    for number in range(count):
        ping.publish(x=float(number), y=0.5, z=-1.0, time=node.now())
        node.spin_until(lambda number=number: len(returned) > number, 5.0)
        if number % 1000 == 999:
            node.sleep(REST)
    took = time.monotonic() - begin - REST * (count // 1000)
    right = sum(value == float(number) for number, value in enumerate(returned))
    print("right", right, "of", count, "rate", round(count / took), flush=True)
