# Generated from the definitions of topic_tools by roslet.gen.stubs. Do not edit.

from . import srv as srv
