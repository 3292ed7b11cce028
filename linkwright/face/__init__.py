"""What `import linkwright` offers programs: arms, questions and results, loaded when they are first used."""
