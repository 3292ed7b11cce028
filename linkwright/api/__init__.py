"""The functions of `import linkwright as lw` that are commands as well: one signature, one docstring, one set of
choices. What they work with they import inside, for a command's help reads this alone."""
