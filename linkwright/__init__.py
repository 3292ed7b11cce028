"""How people meet Linkwright: the command line, its tables, the JSON for machines and the report pages."""
