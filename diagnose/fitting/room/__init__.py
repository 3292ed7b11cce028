"""What sizes and names leave room for: causes that are not named, and what one size may hold of another."""
