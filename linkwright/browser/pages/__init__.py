"""The pages, and the parts that they share."""
