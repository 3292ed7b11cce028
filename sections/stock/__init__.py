"""Standard sizes: one file of tables a family, and how they are read and checked."""
