"""Flexibility that an arm file gives as such: flanges, links by a matrix from finite elements, beams of slides."""
