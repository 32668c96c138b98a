"""The ROS 1 machines: XML-RPC connections, TCPROS and UDPROS links, registration with the master, the slave API."""
