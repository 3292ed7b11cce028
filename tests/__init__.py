"""The test suite; helpers shared between tests are imported as `tests.<module>`."""
