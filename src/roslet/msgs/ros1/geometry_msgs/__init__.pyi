# Generated from the definitions of geometry_msgs by roslet.gen.stubs. Do not edit.

from . import msg as msg
