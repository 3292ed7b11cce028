"""The engine: quantities, catalogues, the arm, design and diagnosis. Each package stands at the top of the repository.

In a checkout its packages are links to the folders beside `linkwright/`; installed, they are folders here.
"""
