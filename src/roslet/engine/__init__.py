"""Sans-IO protocol machines: no socket, no clock, no randomness; time is an argument. Imports wire, errors, names,
record. Runs on MicroPython."""
