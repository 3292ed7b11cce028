"""Motion logs: what a model lacks in the torques of a moving arm."""
