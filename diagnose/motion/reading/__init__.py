"""Motion logs read: columns, clock, torques, currents and voltages, and whether they are of this arm."""
