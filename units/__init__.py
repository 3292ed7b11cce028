"""Quantities with units at the door, and users' YAML read key by key so that every mistake names its file and key."""
