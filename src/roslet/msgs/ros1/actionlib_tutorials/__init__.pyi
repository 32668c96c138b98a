# Generated from the definitions of actionlib_tutorials by roslet.gen.stubs. Do not edit.

from . import action as action
from . import msg as msg
