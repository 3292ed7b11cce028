"""What there is to choose from, each by its name."""
