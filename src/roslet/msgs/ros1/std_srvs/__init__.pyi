# Generated from the definitions of std_srvs by roslet.gen.stubs. Do not edit.

from . import srv as srv
