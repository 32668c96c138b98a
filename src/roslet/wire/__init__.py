"""Bytes to values and back: one module a format. Imports errors, names and record only. Runs on MicroPython."""
