"""Loads that the arm file does not know, or not rightly, and what they move through all that gives."""
