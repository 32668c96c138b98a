"""rospy and rclpy programs, unmodified: the modules that they import, on a roslet node. Imports node and what is left of it.

`finder` answers `import rospy` and `from std_msgs.msg import String`; `run` is `roslet run`. The folders `rospy`, `genpy`,
`roslib` and `rosgraph` are what such a program finds under these names; beside them stands what they share: `session`
(the one node that a rospy program has), `messages` (what rospy programs expect of a message class), `logs`, `callbacks`.

The folder `rclpy` is the same for ROS 2: `interfaces` is what its programs expect of a message class.
"""
