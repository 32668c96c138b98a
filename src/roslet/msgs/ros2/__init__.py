"""ROS 2 packages: `from roslet.msgs.ros2.std_msgs.msg import String`."""
