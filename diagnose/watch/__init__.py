"""Dated recordings of one arm: each parameter's course, what moved and when, what drifts, what is noise."""
