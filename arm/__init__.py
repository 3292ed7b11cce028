"""The serial chain in space: where the tip is, and why it is not where it should be."""
