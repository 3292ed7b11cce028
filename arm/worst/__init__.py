"""Over a workspace: poses that are reached, the worst of them, and the proof that none is worse."""
