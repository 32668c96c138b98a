# Generated from the definitions of tf by roslet.gen.stubs. Do not edit.

from . import msg as msg
from . import srv as srv
