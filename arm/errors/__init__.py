"""The tip's error: effects added up, play as a set, exact motion, and what instruments would read."""
