# Generated from the definitions of dynamic_reconfigure by roslet.gen.stubs. Do not edit.

from . import msg as msg
from . import srv as srv
