"""The `roslet` command: one module for each group of commands, imported only when that group is asked for.

The topmost room: may import everything. `main` parses and turns errors into one line and an exit code, `options` has what
commands share, `graph` asks the master without being a node, `render` and `values` turn messages into text and back.
"""
