"""The command that looks at the installation itself."""
