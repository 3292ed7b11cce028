"""Report pages: one HTML file each, drawn from a result alone, that opens without a network."""
