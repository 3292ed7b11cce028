"""Figures of how large sections are, and how far links keep from what is around them."""
