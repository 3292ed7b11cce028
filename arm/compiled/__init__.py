"""Symbolic expressions as fast functions of many rows: the tape, and code in NumPy or C from it."""
