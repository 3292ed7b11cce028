"""A watch over quiet weeks and over weeks in which something moves: how often it is wrong, how soon it tells."""
