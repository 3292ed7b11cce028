"""What the first look says of recordings made wrong in many ways, beside sound ones."""
