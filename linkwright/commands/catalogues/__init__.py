"""What the commands of every catalogue do alike."""
