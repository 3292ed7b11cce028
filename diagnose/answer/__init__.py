"""From what was found to what is said: conclusion, place, what could not be seen, what to record next."""
