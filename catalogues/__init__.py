"""Catalogue files edited, imported and exported: comments kept, each edit checked as the whole file is on load."""
