# Generated from the definitions of actionlib by roslet.gen.stubs. Do not edit.

from . import action as action
from . import msg as msg
