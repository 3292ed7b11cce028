"""Fits to numerical solutions: their coefficients as data, and what they are good for."""
