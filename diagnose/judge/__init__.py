"""The judge of what a search proposes: sizes by one bounded fit, on all rows and on all but those held out."""
