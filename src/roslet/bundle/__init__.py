"""Bundles for MicroPython: a program and what it needs of roslet, small, as a folder, as `.mpy` files, as a ROMFS image.

`source` reads modules and takes from them what only people and type checkers need; `shake` leaves out what nothing reaches;
`types` writes the message classes; `flash` compiles; `interpreter` runs the result. `build` puts it together. Imports gen
and idl; is imported by cli.
"""
