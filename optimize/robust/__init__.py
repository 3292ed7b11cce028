"""Designs that are held for what is uncertain of an arm: the worst of it, or a share."""
