"""What a recording differs by from the model: frame and tool, conditions, visits, noise."""
