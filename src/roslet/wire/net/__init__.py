"""What lies under RTPS on an Ethernet: one module a header, with its field table, parse and emit.

All integers are big-endian. The gateware makes its header readers and writers of the same tables; judges never import them.
"""
