"""Links as bodies in space: where they stand, where they are looked at from, where their sections' heights point."""
