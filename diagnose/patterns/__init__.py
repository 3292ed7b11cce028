"""What could be missing, as patterns over the readings: the library's effects, and forms outside it."""
