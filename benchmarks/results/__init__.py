"""All measured figures in one run, and the page that holds them: python -m benchmarks.results."""
