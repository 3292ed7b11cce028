"""Statics and vibration behind the limits on a design: joint loads, modes, wall buckling, and their worst poses."""
