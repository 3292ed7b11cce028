"""Arms and results in space, to be looked at from all sides."""
