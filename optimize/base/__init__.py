"""Where an arm's base stands, where that is chosen."""
