"""What docs/proof.md says, from folders of cases and answers: scores, predictions, baselines, next poses, self-made.

`remade` makes a case again from its seed with the generator's own mechanics; `patterns` is the one module that uses the
tool as a library, for the arm file's model and the candidates' columns that the baselines share with it.
"""
