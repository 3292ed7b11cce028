"""Two figures of a design against each other: fronts, and the journal that makes them resumable."""
