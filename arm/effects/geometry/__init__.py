"""Lengths, axes, frames, tools and slides that are not as declared, the instrument's scale included."""
