"""What else bounds a design: strength, frequency, loads of drives, and the poses that are hardest on them."""
