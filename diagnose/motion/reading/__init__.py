"""Motion logs read: columns, clock, torques and currents, and whether they are of this arm."""
