"""Echoes Coordinates, and says how many octets of heap each of MESSAGES took, nothing being collected meanwhile. NETWORK is
put in by the test."""

import gc

import roslet

WARM_UP, MESSAGES = 500, 2000
Coordinate = roslet.load("msgs").mros_comm_measure.msg.Coordinate
node = roslet.Node("echo", network="NETWORK")
pong = node.publisher("pong", Coordinate, qos=10)
count = before = 0


def back(message):
    global count, before
    pong.publish(message)
    count += 1
    if count == WARM_UP:
        gc.collect()
        gc.disable()
        before = gc.mem_alloc()
    elif count == WARM_UP + MESSAGES:
        print("garbage", (gc.mem_alloc() - before) // MESSAGES, node.counters)


node.subscribe("ping", Coordinate, back, qos=10)
print("ready")
node.spin()
