"""What a message is: .msg, .srv and .action files of both dialects as immutable records, by name, with their
hashes.

The lowest room: imports nothing but `errors` and `record`. `parse` reads a text, `Registry` finds definitions
(what the user loaded, the environment's, the bundled standard packages), `md5sum full_text type_hash
type_description` say what peers compare.
"""

from roslet.idl.md5 import full_text, md5sum
from roslet.idl.parser import parse
from roslet.idl.records import (
    ROS1,
    ROS2,
    Action,
    Array,
    Constant,
    Dialect,
    Field,
    FieldType,
    Interface,
    Kind,
    Message,
    Service,
    TypeName,
    Value,
)
from roslet.idl.registry import Registry
from roslet.idl.rihs import type_description, type_hash
from roslet.idl.spelling import parse_type_name

__all__ = [
    "ROS1",
    "ROS2",
    "Action",
    "Array",
    "Constant",
    "Dialect",
    "Field",
    "FieldType",
    "Interface",
    "Kind",
    "Message",
    "Registry",
    "Service",
    "TypeName",
    "Value",
    "full_text",
    "md5sum",
    "parse",
    "parse_type_name",
    "type_description",
    "type_hash",
]
