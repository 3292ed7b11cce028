"""What a problem file may say: other names of its keys, conditions in place of names, and what contradicts itself."""
