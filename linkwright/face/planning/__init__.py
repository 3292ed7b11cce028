"""Error budgets, measurement plans, parameter sweeps, comparisons, and condition monitoring of an arm."""
