"""Results into files and folders: each file whole or not at all, and never over what is not ours."""
