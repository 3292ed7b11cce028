"""Figures of cycles of motion: what they take of the drives, and how long the tip swings after a stop."""
