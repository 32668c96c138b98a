"""Is there, and says ten times a second what the heap holds. NETWORK is put in by the test."""

import gc

import roslet

Coordinate = roslet.load("msgs").mros_comm_measure.msg.Coordinate
node = roslet.Node("idle", network="NETWORK")
pong = node.publisher("pong", Coordinate, qos=10)


def measure():
    gc.collect()
    print("memory", gc.mem_alloc())


node.timer(0.1, measure)
print("ready")
node.spin()
