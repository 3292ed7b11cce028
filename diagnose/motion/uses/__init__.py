"""Questions to the model of motion logs beside a diagnosis: what changed, what moved and when, which motion to log."""
