"""The commands that read and write other programs' files."""
