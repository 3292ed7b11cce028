"""The fits of `sections/fits`: their samples, the fitting, and the data files that hold what came of it."""
