"""The node on MicroPython: the names of `roslet.Node` on a machine with kilobytes. Imports io.micropython, engine, wire.

`node` is what a program gets as `roslet.Node` there, `bounds` what it may hold, `types` where its message classes are.
"""
