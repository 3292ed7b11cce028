"""What docs/proof.md says, from folders of cases and answers: scores, predictions, next poses, self-made.

`remade` makes a case again from its seed with the generator's own mechanics; `model` is the one module that uses the
tool as a library, for what an arm file's model leaves of a recording.
"""
