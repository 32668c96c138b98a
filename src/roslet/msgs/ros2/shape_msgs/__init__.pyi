# Generated from the definitions of shape_msgs by roslet.gen.stubs. Do not edit.

from . import msg as msg
