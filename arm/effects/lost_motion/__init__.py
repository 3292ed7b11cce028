"""Backlash, clearance and friction: where a joint stays although its drive has moved."""
