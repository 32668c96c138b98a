"""Whole designs: their ports are pins and the user's signals."""
