"""Results as Markdown, for notes, issues and pull requests."""
