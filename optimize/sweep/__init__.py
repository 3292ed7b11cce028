"""Figures of many designs at once."""
