"""What an instrument reads of the tip: a place, a height, a distance, or only that the same place was touched again."""
