"""What happens within a log: sizes that change at an instant, and pushes and loads for a while."""
