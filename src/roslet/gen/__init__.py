"""Backends that spell what `layout` decided. Imports `idl` and `layout`; the code it makes imports `wire`
only."""
