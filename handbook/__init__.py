"""How the site of the project is put together from docs/, the examples and the code (`make docs`)."""
