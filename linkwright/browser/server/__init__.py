"""What stands behind the pages: who may ask, where files are, who works, what is kept."""
