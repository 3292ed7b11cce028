"""Sections from lists with link lengths to choose: bounds over both, and lengths for sections that are settled."""
