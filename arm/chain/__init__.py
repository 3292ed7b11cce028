"""The chain itself: joints and links, where they stand, what each carries, and how a link gives."""
