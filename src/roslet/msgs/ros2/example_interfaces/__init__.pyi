# Generated from the definitions of example_interfaces by roslet.gen.stubs. Do not edit.

from . import action as action
from . import msg as msg
from . import srv as srv
