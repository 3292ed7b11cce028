"""Which poses, payloads and sides are worth recording, and what they will show."""
