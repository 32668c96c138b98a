"""The exceptions of rospy, under its names and with its bases.

Exception
+-- ROSException
|   +-- ROSInitException               used before init_node, or the node could not be made
|   +-- ROSSerializationException      a message's fields do not fit its type
|   +-- ROSInterruptException          (also a KeyboardInterrupt) shut down while waiting
|       +-- ROSTimeMovedBackwardsException
+-- ROSInternalException
|   +-- TransportException
|       +-- TransportTerminated, TransportInitError
+-- ServiceException                   (in rospy.service) a call that failed
"""

from __future__ import annotations


class ROSException(Exception):
    """Base of what rospy raises to a program."""


class ROSInitException(ROSException):
    """Something needs init_node, or init_node failed."""


class ROSSerializationException(ROSException):
    """A message cannot be serialised, or not be read."""


class ROSInterruptException(ROSException, KeyboardInterrupt):
    """The node was shut down while the program waited. Also a KeyboardInterrupt, so that `except Exception` in a loop and
    a plain Ctrl-C handler both see it."""


class ROSTimeMovedBackwardsException(ROSInterruptException):
    """Simulated time jumped back; `time` is by how many seconds."""

    def __init__(self, time: float) -> None:
        self.time = time
        super().__init__("ROS time moved backwards")


class ROSInternalException(Exception):
    """Base of what has its cause in the connections."""


class TransportException(ROSInternalException):
    """A connection failed."""


class TransportTerminated(TransportException):
    """A connection was closed by the other side."""


class TransportInitError(TransportException):
    """A connection could not be made."""


for _kind in (
    ROSException,
    ROSInitException,
    ROSInternalException,
    ROSInterruptException,
    ROSSerializationException,
    ROSTimeMovedBackwardsException,
    TransportException,
    TransportInitError,
    TransportTerminated,
):
    _kind.__module__ = "rospy.exceptions"  # as a traceback shows it

__all__ = [
    "ROSException",
    "ROSInitException",
    "ROSInternalException",
    "ROSInterruptException",
    "ROSSerializationException",
    "ROSTimeMovedBackwardsException",
    "TransportException",
    "TransportInitError",
    "TransportTerminated",
]
