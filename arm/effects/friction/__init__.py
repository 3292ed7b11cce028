"""Friction of moving joints: what it takes of the drives' torque."""
