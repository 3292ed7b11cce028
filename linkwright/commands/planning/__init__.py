"""The commands for what is asked before anything is bought, built or measured."""
