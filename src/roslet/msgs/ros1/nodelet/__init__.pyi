# Generated from the definitions of nodelet by roslet.gen.stubs. Do not edit.

from . import srv as srv
