"""Whether the installation is sound, check by check."""
