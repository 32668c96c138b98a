# Generated from the definitions of roscpp_tutorials by roslet.gen.stubs. Do not edit.

from . import srv as srv
