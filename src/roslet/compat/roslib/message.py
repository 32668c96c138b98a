"""`roslib.message`: classes by name."""

from roslet.compat.genpy import Message
from roslet.compat.genpy.message import get_message_class, get_service_class, strify_message

__all__ = ["Message", "get_message_class", "get_service_class", "strify_message"]
