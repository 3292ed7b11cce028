"""Drives that give under links of unknown mass: the file that is written does what its report promises.

The recordings are made by the textbook's statics of a planar arm, with nothing of the code under test.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from arm.chain.chain import Arm, Joint, Link
from diagnose.diagnosis import diagnose
from diagnose.fitting.shared_weights import factors, steps
from diagnose.predict import predict
from diagnose.recording import Recording
from linkwright.output.written_arm import with_written
from materials.catalogue import load_catalogue
from sections.numeric import Array

LENGTHS = np.array([0.5, 0.45, 0.3])
MASSES = np.array([9.0, 6.0, 2.5])
CENTRES = np.array([0.22, 0.2, 0.1])
"""m from the joint, along the link."""
COMPLIANCE = np.array([8e-6, 2e-5, 3e-5])
NOISE = 10e-6


def sagged(q: Array, payload: Array) -> Array:
    """How far drives turn (N, 3), rad: torques of weights beyond each joint, by sums of cosines."""
    across = np.cos(np.cumsum(q, axis=1))
    joints = np.concatenate([np.zeros((len(q), 1)), np.cumsum(across * LENGTHS, axis=1)], axis=1)
    torque = np.zeros_like(q)
    for joint in range(3):
        for link in range(joint, 3):
            lever = joints[:, link] + across[:, link] * CENTRES[link] - joints[:, joint]
            torque[:, joint] -= 9.81 * MASSES[link] * lever
        torque[:, joint] -= 9.81 * payload * (joints[:, 3] - joints[:, joint])
    return COMPLIANCE * torque


def recorded(seed: int, payloads: tuple[float, ...]) -> Recording:
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-1.4, 1.4, (40, 3)), 2 * len(payloads), axis=0)
    payload = np.tile(np.repeat(payloads, 2), 40)
    angles = np.cumsum(q + sagged(q, payload), axis=1)
    tip = np.stack([np.cos(angles) @ LENGTHS, np.sin(angles) @ LENGTHS], axis=1)
    measured = tip + NOISE * rng.standard_normal(tip.shape)
    return Recording("made", q, measured, np.arange(1, len(q) + 1), payload_mass=payload)


def unweighed() -> Arm:
    joints = tuple(Joint(range=(-math.pi, math.pi)) for _ in LENGTHS)
    return Arm("nobody weighed it", joints, tuple(Link(float(length)) for length in LENGTHS))


@pytest.mark.parametrize("payloads", [(0.0,), (0.0, 3.0)])
def test_the_written_file_keeps_its_promise(payloads: tuple[float, ...]) -> None:
    """All three drives share one set of weights: what is written predicts poses that nobody has recorded; and a payload
    that nobody has recorded where two were."""
    found = with_written(diagnose(unweighed(), recorded(1, payloads)), load_catalogue(user=False))
    assert {(each.effect, each.at) for each in found.findings} == {("joint_compliance", (k,)) for k in (1, 2, 3)}
    assert found.written is not None
    assert found.written.rms == pytest.approx(found.written.promised, rel=0.02)
    assert found.written.lacks == ()
    other = recorded(2, payloads if len(payloads) == 1 else (6.0,))
    assert predict(found.corrected, other).rms < 1.25 * math.sqrt(2.0) * NOISE
    weights = [entry for entry in found.corrected.effects if entry.effect == "unknown_weight"]
    assert len(weights) == 3


def test_products_are_of_rank_one_and_steps_keep_them_so() -> None:
    rng = np.random.default_rng(0)
    weight, compliance = rng.standard_normal(5), np.array([2.0, 0.5])
    products = factors(np.outer(compliance, weight))
    assert np.abs(products.weight).max() == pytest.approx(1.0)
    assert np.outer(products.compliance, products.weight) == pytest.approx(np.outer(compliance, weight))
    spans = (slice(1, 7), slice(7, 13))
    made = steps(14, spans, products)
    step = 0.1 * rng.standard_normal(made.slopes.shape[1])
    sizes = np.concatenate([[0.0], *(np.append(c * products.weight, 0.0) for c in products.compliance), [0.0]])
    after = sizes + made.taken(step, 0.5)
    stacked = np.stack([after[span][:-1] for span in spans])
    assert np.linalg.svd(stacked, compute_uv=False)[1] < 1e-12
    # To first order the step is that of the slopes.
    small = made.taken(1e-6 * step, 1.0)
    assert small == pytest.approx(1e-6 * made.slopes @ step, abs=1e-10)
