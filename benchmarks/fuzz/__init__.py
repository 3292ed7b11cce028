"""Files of every kind, made odd: each is read or refused in one line, within bounds of time and memory."""
