# Generated from the definitions of statistics_msgs by roslet.gen.stubs. Do not edit.

from . import msg as msg
