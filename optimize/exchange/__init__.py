"""The exchange between binding poses and better designs, and the finite problem that it solves."""
