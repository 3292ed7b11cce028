"""Two figures of a design against each other: fronts."""
