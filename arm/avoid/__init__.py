"""Regions of space that an arm keeps out of, and which poses do."""
