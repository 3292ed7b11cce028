"""What takes loads off an arm's drives, chosen with its links: counterweights, counterbalances, where motors stand."""
