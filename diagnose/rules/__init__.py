"""The rules of the diagnosis: every threshold with its unit, the reason for it and where it comes from."""
