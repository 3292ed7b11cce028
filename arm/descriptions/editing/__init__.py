"""Numbers of a user's file, written anew in their places."""
