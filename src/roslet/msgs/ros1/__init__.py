"""ROS 1 packages: `from roslet.msgs.ros1.std_msgs.msg import String`."""
