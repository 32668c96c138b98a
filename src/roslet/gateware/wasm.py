"""Runs a tool that PyPI has as WebAssembly: `python -m roslet.gateware.wasm MODULE FUNCTION [ARGUMENT ...]`.

Yosys recurses along paths of a design. The runtime gives it half a megabyte of stack, which a node with the manual's names
in registers exhausts; here it has four times as much, the most that the runtime allows.
"""

from __future__ import annotations

import importlib
import sys

STACK = 2 << 20
"""Octets."""


def main(arguments: list[str]) -> int:
    """What the function of the module returns for the arguments after these two."""
    import wasmtime

    class Config(wasmtime.Config):
        """The runtime's, with more stack."""

        def __init__(self) -> None:
            super().__init__()
            self.max_wasm_stack = STACK

    wasmtime.Config = Config  # type: ignore[misc]
    module, function, *rest = arguments
    code: int = getattr(importlib.import_module(module), function)(rest)
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
