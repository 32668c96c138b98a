# Generated from the definitions of type_description_interfaces by roslet.gen.stubs. Do not edit.

from . import msg as msg
from . import srv as srv
