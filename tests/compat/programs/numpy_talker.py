#!/usr/bin/env python3
import numpy
import rospy
from beginner_tutorials.msg import Floats
from rospy.numpy_msg import numpy_msg

rospy.init_node("talker", anonymous=True)
pub = rospy.Publisher("floats", numpy_msg(Floats), queue_size=10)
while pub.get_num_connections() < 2 and not rospy.is_shutdown():
    rospy.sleep(0.01)
a = numpy.array([1.0, 2.1, 3.2, 4.3, 5.4, 6.5], dtype=numpy.float32)
pub.publish(a)
pub.publish(data=a * 2)
pub.publish(Floats([9.0]))
rospy.sleep(0.2)
