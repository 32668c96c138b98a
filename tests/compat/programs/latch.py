#!/usr/bin/env python3
# A latched topic, in one program: who comes later gets the last message.
import rospy
from beginner_tutorials.msg import Person

rospy.init_node("latch")
pub = rospy.Publisher("person", Person, latch=True, queue_size=1)
pub.publish("Ada", "Lovelace", 36, 0)
pub.publish(first_name="Grace", last_name="Hopper", age=85)
rospy.sleep(0.1)
message = rospy.wait_for_message("person", Person, timeout=5)
print(message)
print(
    {key: value for key, value in sorted(message._connection_header.items()) if key != "message_definition"}
)
print(message._connection_header["message_definition"] == Person._full_text)
heard = []
first = rospy.Subscriber("person", Person, heard.append)
second = rospy.Subscriber("person", Person, lambda m, who: heard.append((who, m.first_name)), "second")
rospy.sleep(0.3)
print(len(heard), first.get_num_connections(), pub.get_num_connections())
pub.publish(Person("Edsger", "Dijkstra", 72, 7))
rospy.sleep(0.3)
print([one if isinstance(one, tuple) else one.first_name for one in heard][-2:])
first.unregister()
pub.publish(Person("Donald", "Knuth", 87, 8))
rospy.sleep(0.3)
print(heard[-1], len(heard))
