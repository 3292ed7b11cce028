"""What an arm's links weigh: masses with their centres and inertias."""
