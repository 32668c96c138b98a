# Generated from the definitions of move_base_msgs by roslet.gen.stubs. Do not edit.

from . import action as action
from . import msg as msg
