"""Angles that are not what the encoders say."""
