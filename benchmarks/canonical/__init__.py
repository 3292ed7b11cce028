"""Sixty small recordings whose truth is known, tips and torques: a moved rule shows in two CPU minutes.

`tests/canonical` asks each of them. `python -m benchmarks.canonical make` draws the recordings anew, `record` writes
down what is asked for of each and which of them the tool misses today: changing one is a decision.
"""
