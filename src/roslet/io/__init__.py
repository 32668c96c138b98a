"""The only sockets and clocks: runtime shells that send what a machine has pending and arm one timer for it.
Imports engine and what is left of it."""
