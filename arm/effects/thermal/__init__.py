"""What warmth moves: links, gearboxes and screws."""
