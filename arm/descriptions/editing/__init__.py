"""Numbers of a user's own file, written anew in their places."""
