#!/usr/bin/env python3
import roslet

node = roslet.Node("mros_node", network="ros1://")
chatter = node.publisher("ping", "mros_comm_measure/Coordinate", qos=1)
msg = chatter.type()
rate = node.rate(20)
while True:
    msg.x += 0.1
    msg.y += 10.03
    msg.z += 3.003
    msg.time = node.now()
    chatter.publish(msg)
    rate.sleep()
