#!/usr/bin/env python3
# A publisher that hears of its subscribers and greets each.
import rospy
from std_msgs.msg import String


class Greeter(rospy.SubscribeListener):
    there = False

    def peer_subscribe(self, topic_name, topic_publish, peer_publish):
        self.there = True
        print("a peer subscribed to topic [%s]" % topic_name, flush=True)
        peer_publish(String("welcome"))

    def peer_unsubscribe(self, topic_name, num_peers):
        if self.there:  # rospy says so twice where two of its threads see it go
            print("a peer unsubscribed from topic [%s], %d left" % (topic_name, num_peers), flush=True)
        self.there = False


rospy.init_node("listeners")
pub = rospy.Publisher("greetings", String, Greeter(), queue_size=3)
for turn in range(2):
    heard = []
    sub = rospy.Subscriber("greetings", String, heard.append)
    rospy.sleep(0.3)
    pub.publish("to all")
    rospy.sleep(0.2)
    print([message.data for message in heard], pub.get_num_connections(), sub.get_num_connections())
    if turn == 0:
        sub.unregister()
        while pub.get_num_connections():
            pub.publish("to nobody")  # rospy notices when it writes
            rospy.sleep(0.05)
        rospy.sleep(0.1)
        print("now", pub.get_num_connections())
pub.unregister()
try:
    pub.publish("x")
except rospy.ROSException as error:
    print(error)
