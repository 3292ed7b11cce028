"""The tables that the paper lacks."""
