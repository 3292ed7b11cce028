"""The rules of the diagnosis: the page that lists them."""
