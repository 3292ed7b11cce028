"""The report pages, and the parts that they share."""
