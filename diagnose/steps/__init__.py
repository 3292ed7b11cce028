"""A diagnosis from end to end, and what rests on all of it."""
