"""arm.yaml read and written."""
