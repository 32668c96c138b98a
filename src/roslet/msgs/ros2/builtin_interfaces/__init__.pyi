# Generated from the definitions of builtin_interfaces by roslet.gen.stubs. Do not edit.

from . import msg as msg
