"""Files under edit: as text and as fields, chosen, saved."""
