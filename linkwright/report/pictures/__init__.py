"""What reports draw: SVG, and mappings for plotly."""
