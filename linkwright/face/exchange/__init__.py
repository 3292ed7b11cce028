"""Arms from and for other programs."""
