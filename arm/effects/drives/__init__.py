"""Drives of a moving arm: their rotors, gears, springs and sensors, as the torque shows them."""
