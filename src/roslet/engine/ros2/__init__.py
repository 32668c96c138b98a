"""What ROS 2 adds to a participant of RTPS: nodes and their graph, services in both dialects, parameters, actions.

`context.Context` is the ROS 2 side of one participant. May import `wire`, `engine.rtps`, `names`, `errors` and `record`.
Runs on MicroPython.
"""
