"""What is asked before anything is bought, built or measured."""
