"""What a link is made of: properties with their sources, and the catalogue of them."""
