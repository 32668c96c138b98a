"""What a node on MicroPython may hold at most. `roslet micropython bundle` puts the numbers that were asked for in here.

Bytes unless said otherwise. Memory that is named *at once* is taken when the node, or the endpoint, is made.
"""

# A received message, whatever its strings and sequences; a ROS 1 publisher of longer ones is disconnected.
MAX_MESSAGE = 65536
# What a publisher serialises into, at once; it grows to what messages need.
PUBLISH = 256
# ROS 1: what is received at once on one topic's connection, small messages together; at once, for each publisher that sends.
CHUNK = 1024
# ROS 1: what is read at once of a call or a header; at once, for each connection.
ROOM = 512
# ROS 1: connections that come in, and answers of a peer's XML-RPC or of one HTTP message.
CONNECTIONS = 16
CALL = 65536
# Samples that wait for a slow subscriber: the depth of a queue is cut to it. A number.
DEPTH = 10
# ROS 2: a datagram. Peers pack discovery into datagrams of up to 14,720 bytes.
DATAGRAM = 16384
# ROS 2: the part of a large sample that goes into one datagram.
FRAGMENT = 1344
# ROS 2: participants and endpoints of others that are known; numbers.
PARTICIPANTS = 16
ENDPOINTS = 64
# ROS 2: samples, and their bytes, that are kept of a writer while an earlier one is missing.
HELD_SAMPLES = 16
HELD_BYTES = 16384
# ROS 2: samples that a publisher keeps for its subscribers.
HISTORY = 65536
# ROS 2: announcements of the endpoints of others.
DISCOVERY = 65536
