"""What is wrong with a recording before physics is asked: readings, units, conventions, contradictions."""
