# Generated from the definitions of nav_msgs by roslet.gen.stubs. Do not edit.

from . import msg as msg
from . import srv as srv
