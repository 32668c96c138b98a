# Generated from the definitions of composition_interfaces by roslet.gen.stubs. Do not edit.

from . import srv as srv
