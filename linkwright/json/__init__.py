"""Results as mappings for JSON: names carry their units, null where a figure cannot be known."""
