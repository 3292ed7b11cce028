"""Motion logs for programs: what a model lacks in the torques of a moving arm."""
