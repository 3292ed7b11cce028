"""A laser on the tool that reads how far a flat surface is: by plain geometry, diagnosed, simulated and planned."""

from dataclasses import replace

import numpy as np
import pytest

import linkwright as lw
from linkwright.core.diagnose.instruments.checks import sights_checked
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.registry import slots_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.steps.diagnosis import diagnose
from tests.diagnose.instruments.six_joint_arm import RANGE, flange, six_joint_arm

BEAM = (0.0, 0.6, 0.8)
NORMAL, OFFSET = np.array([2.0, -1.0, 2.0]) / 3.0, 1.4
SIGMA = 20e-6


def ranges(q, zeros):
    """How far the beam goes from the end of the last link to the plane n x = c: (c - n p)/(n u)."""
    at = flange(q + zeros)
    beams = at[:, :3, :3] @ np.array(BEAM)
    return (OFFSET - at[:, :3, 3] @ NORMAL) / (beams @ NORMAL)


def recorded(zeros, noise=SIGMA, seed=5):
    rng = np.random.default_rng(seed)
    q = rng.uniform(-RANGE, RANGE, (1200, 6))
    q = q[(flange(q)[:, :3, :3] @ np.array(BEAM)) @ NORMAL > 0.4][:120]
    read = ranges(q, zeros) + noise * rng.standard_normal(len(q))
    return Recording(
        "r.csv", q, read[:, None], np.arange(1, len(q) + 1), time=20.0 * np.arange(len(q)),
        slots=np.full((len(q), 1), slots_of("laser_line")[0]),
        instrument=Instrument(("laser_line",), settings=(("beam", BEAM),)),
    )  # fmt: skip


def test_a_sound_arm_leaves_nothing_wherever_the_surface_is():
    assert np.abs(observe(six_joint_arm(), recorded(np.zeros(6), noise=0.0)).residual).max() < 1e-9


def test_a_zero_is_named_with_its_size():
    """One that moves and turns the beam: neither the tip's place nor the tool's turns alone would give its size."""
    zeros = np.array([0.0, 0.0, 2e-3, 0.0, 0.0, 0.0])
    result = diagnose(six_joint_arm(), recorded(zeros))
    named = [(item.effect, item.at) for item in result.findings]
    assert ("encoder_offset", (3,)) in named
    (finding,) = [item for item in result.findings if item.effect == "encoder_offset"]
    assert finding.parameters[0].value == pytest.approx(2e-3, abs=2e-4)


def test_it_is_simulated_read_and_planned(tmp_path):
    arm = lw.read_arm("examples/welding-arm/arm.yaml")
    made = lw.simulate(arm, poses=30, observe="laser_line", reads={"beam": [1, 0, 0]}, repeats=1)
    made.save(tmp_path / "r.csv")
    assert "beam: [1, 0, 0]" in (tmp_path / "r.yaml").read_text()
    read = lw.read_recording(tmp_path / "r.csv", arm)
    assert read.found.tip == pytest.approx(made.found.tip, abs=1e-8)
    assert np.abs(observe(arm.model, read.found).residual).max() < 1e-3
    beam = {"beam": [1, 0, 0]}
    plan = lw.plan(arm, poses=20, for_=["encoder_offset:3"], repeats=1, instrument="laser_line", reads=beam)
    assert len(plan.visits) == 20
    assert list(plan.shown["effect"]) == ["encoder_offset"]


def test_a_surface_met_on_a_line_is_refused():
    """From two poses, read over and over."""
    bare = recorded(np.zeros(6))
    rows = np.arange(20) % 2
    line = bare.kept(np.arange(bare.size) < 20)
    line = replace(line, q=bare.q[rows], tip=bare.tip[rows])
    with pytest.raises(lw.InputError, match="could be turned"):
        sights_checked(line, six_joint_arm())
