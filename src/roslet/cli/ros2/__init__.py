"""What commands need of a ROS 2 network: a node that nobody sees, and time for discovery."""
