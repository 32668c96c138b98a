"""`rospy.service`: ServiceException."""

from __future__ import annotations


class ServiceException(Exception):
    """A service cannot be offered, or a call has failed. A handler that raises it sends its text to the caller."""


ServiceException.__module__ = "rospy.service"  # as a traceback shows it

__all__ = ["ServiceException"]
