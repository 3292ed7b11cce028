"""Choices that are no numbers: shapes, materials and actuators."""
