# Generated from the definitions of bond by roslet.gen.stubs. Do not edit.

from . import msg as msg
