"""Two encoders at each drive: which stands where, and what the drive does between them."""
