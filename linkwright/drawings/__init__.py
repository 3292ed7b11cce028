"""Arms for the workshop: drawings to scale and lists of parts."""
