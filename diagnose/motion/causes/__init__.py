"""What some causes of a moving arm ask beside: when they are sought, what they may as well be, what follows."""
