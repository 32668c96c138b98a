# Generated from the definitions of rcl_interfaces by roslet.gen.stubs. Do not edit.

from . import msg as msg
from . import srv as srv
