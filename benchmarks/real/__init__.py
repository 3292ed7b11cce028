"""Real machines: what a diagnosis finds in recordings made by others, and how well it predicts what it has not seen."""
