"""ROS 1 in a node: what the classes of the room above are there."""
