"""How a message lies in bytes: one pass over the definition records, once per encoding. Imports `idl` only.

The result says nothing about a programming language; the backends in `gen` spell it.
"""

from roslet.layout.flatten import layout
from roslet.layout.operations import (
    CDR,
    PRIMITIVE_SIZE,
    ROS1,
    Layout,
    Numbers,
    Octets,
    Run,
    Sequence,
    Slot,
    Text,
)

__all__ = [
    "CDR",
    "PRIMITIVE_SIZE",
    "ROS1",
    "Layout",
    "Numbers",
    "Octets",
    "Run",
    "Sequence",
    "Slot",
    "Text",
    "layout",
]
