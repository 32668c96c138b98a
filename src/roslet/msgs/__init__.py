"""The messages of every package, made when they are imported.

    from roslet.msgs.ros1.std_msgs.msg import String
    from roslet.msgs.ros2.example_interfaces.srv import AddTwoInts

The definitions are those of the process's registry: what was loaded, what the environment has, what is
bundled. There are no Python files of the bundled packages, only stubs, so that editors and type checkers know
their fields.
"""

from roslet.msgs.finder import install

install("roslet.msgs.ros1", "ros1")
install("roslet.msgs.ros2", "ros2")
