"""Verdict and file are two questions: a form that is the answer takes nothing out of the file that predicts.

A planar arm sags by the textbook's statics of a chain, and the instrument bends space by a smooth field: nothing in the
library explains that, and no file holds it. What sags is told all the same, and readings of other poses are off by
what the field does there.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.judge.predict import predict
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.sections.numeric import Array

LENGTHS = np.array([0.5, 0.45, 0.3])
MASSES = np.array([9.0, 6.0, 2.5])
COMPLIANCE = np.array([0.0, 1e-5, 0.0])
NOISE, FIELD = 10e-6, 400e-6


def arm() -> Arm:
    joints = tuple(Joint(range=(-math.pi, math.pi)) for _ in LENGTHS)
    links = (
        Link(float(length), mass=float(mass), center_of_mass=float(length) / 2.0)
        for length, mass in zip(LENGTHS, MASSES, strict=True)
    )
    return Arm("sags", joints, tuple(links))


def tips(q: Array, field: float = 1.0) -> Array:
    """Where the tip is seen (N, 2), m: drives turn by compliance times torque, and space is bent (`field` times)."""
    across = np.cos(np.cumsum(q, axis=1))
    ends = np.cumsum(across * LENGTHS, axis=1)
    begins = ends - across * LENGTHS
    torque = np.stack(
        [
            -9.81 * sum(MASSES[link] * (0.5 * (begins + ends)[:, link] - begins[:, joint]) for link in range(joint, 3))
            for joint in range(3)
        ],
        axis=1,
    )
    angles = np.cumsum(q + COMPLIANCE * torque, axis=1)
    x, y = np.cos(angles) @ LENGTHS, np.sin(angles) @ LENGTHS
    bent = field * FIELD * np.stack([np.sin(2.1 * x + 1.3 * y), np.cos(1.7 * y - 1.1 * x)], axis=1)
    return np.stack([x, y], axis=1) + bent


def recorded(seed: int) -> Recording:
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-1.3, 1.3, (60, 3)), 2, axis=0)
    measured = tips(q) + NOISE * rng.standard_normal((len(q), 2))
    return Recording("made", q, measured, np.arange(1, len(q) + 1))


@pytest.fixture(scope="module")
def result():
    return diagnose(arm(), recorded(1))


def test_what_predicts_stays_in_the_file(result) -> None:
    """The form is the answer, and no name is; the file predicts other poses all the same."""
    assert (result.verdict, result.findings) == ("unknown", ())
    other = recorded(2)
    given, written = predict(arm(), other).rms, predict(result.corrected, other).rms
    assert written < 0.6 * given
    (said,) = (note for note in result.notes if note.startswith("The written arm file holds"))
    assert "This is a fit, not the causes." in said


def test_the_promise_is_the_files(result) -> None:
    assert predict(result.corrected, result.recording).rms == pytest.approx(result.rms_promised, rel=1e-6)
