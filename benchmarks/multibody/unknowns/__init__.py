"""Physics that the library has no entry for, by class, and which half of the proof each class belongs to."""
