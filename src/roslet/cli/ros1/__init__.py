"""What commands need of a ROS 1 network: questions to the master and to nodes, asked without being a node."""
