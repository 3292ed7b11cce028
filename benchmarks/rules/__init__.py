"""The rules of the diagnosis: the page that lists them, and what moves when each is perturbed."""
