"""Public recordings that others published: where each is, and how it becomes files that the tool reads.

The project holds none of them. Clone the repositories into one folder, each under its name, and convert:
`python -m benchmarks.real.public CLONES --out FOLDER`, then `export LINKWRIGHT_PUBLIC=FOLDER`.
"""
