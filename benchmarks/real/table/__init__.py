"""One table of real machines: what the written file leaves of recordings that it was not fitted to, beside what the
textbook's least squares leaves of the same."""
