# Generated from the definitions of rmw_dds_common by roslet.gen.stubs. Do not edit.

from . import msg as msg
