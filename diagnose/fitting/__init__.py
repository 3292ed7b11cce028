"""Patterns fitted: sizes and intervals, rows held out, and the corrected arm."""
