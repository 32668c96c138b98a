#!/usr/bin/env python3
import roslet


def callback(msg):
    print("I heard [x:%d, y:%d, z:%d]" % (msg.x * 1000, msg.y * 1000, msg.z * 1000), flush=True)


node = roslet.Node("mros_sub_node", network="ros2://")
node.subscribe("ping", "mros_comm_measure/Coordinate", callback, qos=1)
node.spin()
