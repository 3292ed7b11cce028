"""What is asked before an arm is bought, built or measured, and as long as it works."""
