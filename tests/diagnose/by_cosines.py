"""Recordings of a planar arm of three joints by plain sums of cosines, which share no code with the product."""

import numpy as np

from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.diagnose.recording import Recording

LENGTHS = np.array([0.5, 0.42, 0.3])
MASS = 6.0
"""kg, carried at the tip; links are weightless and rigid, drives give."""
GIVES = np.array([1.7e-5, 2.0e-5, 2.5e-5])
"""rad/(N*m) of each drive, in the arm file too."""
SIGMA = 15e-6


def file(**changed):
    joints = tuple(Joint(range=(-4.7, 4.7), stiffness=1.0 / gives) for gives in GIVES)
    links = tuple(Link(float(length), mass=0.0) for length in LENGTHS)
    return Arm("by cosines", joints, links, **{"payload": LoadCase(MASS), **changed})


def poses(seed, count=40):
    return np.random.default_rng(seed).uniform(-2.3, 2.3, (count, 3))


def tips(q, errors=0.0, gives=GIVES, lengths=LENGTHS, mass=MASS, rounds=4):
    """Tips (N, 2), m, of an arm whose joints stand off by `errors`, rad, beside what its drives give."""
    off = np.zeros_like(q) + errors
    for _ in range(rounds):  # loads act on the arm as it stands
        out = np.cos(np.cumsum(q + off, axis=1)) * lengths
        off = errors - gives * 9.81 * np.reshape(mass, (-1, 1)) * np.cumsum(out[:, ::-1], axis=1)[:, ::-1]
    angles = np.cumsum(q + off, axis=1)
    return np.stack([np.cos(angles) @ lengths, np.sin(angles) @ lengths], axis=1)


def noise(seed, count, sigma=SIGMA):
    return sigma * np.random.default_rng(seed + 1000).standard_normal((count, 2))


def recording(q, tip, **columns):
    row = np.arange(1, len(q) + 1)
    return Recording("r.csv", q, tip, row, **{"time": 8.0 * (row - 1), **columns})
