"""What the model left out: the rooms of the diagnosis, which share the chain and the effects with the optimiser."""
