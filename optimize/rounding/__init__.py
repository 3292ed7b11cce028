"""An optimum moved to sizes that can be bought or made."""
