"""Guards on what was named: what readings of one pose, and visits that scatter, say against it."""
