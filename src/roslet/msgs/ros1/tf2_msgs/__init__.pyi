# Generated from the definitions of tf2_msgs by roslet.gen.stubs. Do not edit.

from . import action as action
from . import msg as msg
from . import srv as srv
