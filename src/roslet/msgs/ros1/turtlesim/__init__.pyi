# Generated from the definitions of turtlesim by roslet.gen.stubs. Do not edit.

from . import msg as msg
from . import srv as srv
