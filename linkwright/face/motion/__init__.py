"""Motion logs for programs: what a model leaves out of the torques of a moving arm."""
