"""Moving arms: the torques that a motion takes of the drives."""
