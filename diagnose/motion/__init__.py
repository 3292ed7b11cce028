"""Motion logs: what a model leaves out of the torques of a moving arm."""
