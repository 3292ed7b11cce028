"""The loads that measured torques show, and how these are fitted to what the drives hold."""
