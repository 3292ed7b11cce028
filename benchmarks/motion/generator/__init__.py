"""Arms that move in MuJoCo with concealed causes, and what a logger makes of that."""
