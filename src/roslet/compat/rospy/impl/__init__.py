"""`rospy.impl`: what programs import from there."""
