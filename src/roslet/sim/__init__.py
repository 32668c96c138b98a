"""One simulated Ethernet: gateware nodes and software nodes on the same wire.

`compile` makes a fast model of a gateware top; links carry frames between its pins, software hosts, TAP devices and
captures.
"""
