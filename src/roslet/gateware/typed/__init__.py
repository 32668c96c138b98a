"""Messages by their definitions: layouts, blocks that make and take their bytes, flat ports for Verilog.

What a message is, and in which steps its bytes come, is `roslet.gen.gateware`; here it becomes hardware.
"""
