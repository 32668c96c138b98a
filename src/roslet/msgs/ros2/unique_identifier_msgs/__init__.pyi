# Generated from the definitions of unique_identifier_msgs by roslet.gen.stubs. Do not edit.

from . import msg as msg
