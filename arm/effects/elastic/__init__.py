"""What gives under load: links, drives and the base."""
