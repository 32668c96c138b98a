"""Echoes Coordinates, and after every thousand says what the heap holds. NETWORK is put in by the test."""

import gc

import roslet

Coordinate = roslet.load("msgs").mros_comm_measure.msg.Coordinate
node = roslet.Node("echo", network="NETWORK")
pong = node.publisher("pong", Coordinate, qos=10)
count = 0


def measure(number):
    gc.collect()
    print("memory", number, gc.mem_alloc())


def back(message):
    global count
    pong.publish(message)
    count += 1
    if count % 1000 == 0:
        node.loop.later(measure, count)


node.subscribe("ping", Coordinate, back, qos=10)
print("ready")
node.spin()
