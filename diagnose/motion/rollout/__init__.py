"""Motion logs simulated: the arm under the torques that were logged, from the state that was logged."""
