"""Two recordings of one arm against each other."""
