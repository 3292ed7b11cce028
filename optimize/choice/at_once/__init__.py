"""All combinations of millions bounded at once: cells of sections, rows of poses, a relaxation, and its parts."""
