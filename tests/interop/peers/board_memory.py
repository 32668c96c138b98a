"""Echoes Coordinates, and says what the heap holds whenever it comes to rest. NETWORK is put in by the test."""

import gc

import roslet

Coordinate = roslet.load("msgs").mros_comm_measure.msg.Coordinate
node = roslet.Node("echo", network="NETWORK")
pong = node.publisher("pong", Coordinate, qos=10)
count = seen = told = 0


def back(message):
    global count
    pong.publish(message)
    count += 1


def measure():
    global seen, told
    if count == seen and count != told:
        gc.collect()
        print("memory", count, gc.mem_alloc())
        told = count
    seen = count


node.subscribe("ping", Coordinate, back, qos=10)
node.timer(0.1, measure)
print("ready")
node.spin()
