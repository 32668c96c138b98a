# Generated from the definitions of roscpp by roslet.gen.stubs. Do not edit.

from . import msg as msg
from . import srv as srv
