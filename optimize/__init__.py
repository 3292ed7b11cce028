"""The least worst-case error: the min-max optimiser and the problems it solves."""
