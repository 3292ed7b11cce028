"""Blind proof of the diagnosis: recordings of concealed physics, sealed truths and their scoring.

Nothing here comes from the packages that are judged. Arms bend on their deformed shape, play has a memory, links warm
with a lag and trackers err in their own ways; `make` writes recordings and seals the truths, `run` asks the tool by its
public command line, `score` opens the truths after that.
"""
