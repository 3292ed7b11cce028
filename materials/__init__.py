"""What a link is made of, and how quantities with units are read and written at the door."""
