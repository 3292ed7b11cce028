"""Sections chosen from lists: every link from stock sizes or listed dimensions, bounded all at once and proven."""
