"""Symbolic expressions compiled to C, and what that is worth.

The commands run on NumPy code from the same tape: an optimisation spends a tenth of its time in functions of many rows,
so C could win less than a tenth of it, and its sines differ in their last digits.
"""
