"""A mast that bends and a bearing that gives, recorded by formulas of the textbook, are told from a soft base."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.sections.numeric import Array
from tests.diagnose.recorded import written

G, SIGMA = 9.81, 10e-6
UPRIGHT, LEVEL = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)


def recorded(folder: Path, arm: Arm, names: list[str], columns: list[Array], tip: Array):
    """A recording read back, with the noise of a tracker."""
    rng = np.random.default_rng(11)
    table = {name: [f"{item:.7f}" for item in column] for name, column in zip(names, columns, strict=True)}
    measured = 1e3 * (tip + SIGMA * rng.standard_normal(tip.shape))
    table |= {f"{axis}_mm": [f"{item:.6f}" for item in measured[:, k]] for k, axis in enumerate("xyz")}
    (folder / "recording.yaml").write_text(f"sigma: {1e6 * SIGMA:g} um\n", encoding="utf-8")
    return read_recording(written(folder / "recording.csv", table), arm, folder / "recording.yaml")


@pytest.mark.parametrize("bends", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_mast_is_told_from_the_base_by_its_height(tmp_path: Path, bends: bool) -> None:
    """A boom of reach r turns on a carriage at height h. The payload's moment m g r bends the mast towards it, by
    m g r h^2/(2EI) and a slope m g r h/EI; a base that gives turns by c m g r whatever the height."""
    slide = Joint("prismatic", axis=UPRIGHT, range=(0.1, 2.0))
    turn = Joint(axis=UPRIGHT, range=(-3.0, 3.0))
    boom = Joint("prismatic", axis=LEVEL, range=(0.2, 1.0))
    arm = Arm("mast", (slide, turn, boom), tuple(Link(0.0, mass=0.0) for _ in range(3)), gravity=(0.0, 0.0, -G))
    rng = np.random.default_rng(5)
    count, ei, soft = 150, 2e5, 2e-6
    h, psi, r = rng.uniform(0.1, 2.0, count), rng.uniform(-3.0, 3.0, count), rng.uniform(0.2, 1.0, count)
    payload = rng.choice([0.0, 6.0, 12.0], count)
    moment = payload * G * r
    out = np.stack([np.cos(psi), np.sin(psi), 0.0 * psi], axis=1)
    up = np.array([[0.0, 0.0, 1.0]])
    across, slope = (moment * h**2 / (2.0 * ei), moment * h / ei) if bends else (soft * moment * h, soft * moment)
    tip = (r + across)[:, None] * out + (h - slope * r)[:, None] * up
    names = ["q1_mm", "q2_deg", "q3_mm", "payload_kg"]
    result = diagnose(arm, recorded(tmp_path, arm, names, [1e3 * h, np.degrees(psi), 1e3 * r, payload], tip))
    (finding,) = result.findings
    assert result.unknown is None
    if bends:
        assert (result.verdict, finding.effect, finding.at) == ("named", "column_bending", (1,))
        (size,) = finding.parameters
        assert size.interval[0] <= 1.0 / ei <= size.interval[1]
    else:
        named = {finding.effect, *(alternative.effect for alternative in finding.alternatives)}
        assert "base_compliance" in named
        assert "column_bending" not in named


def test_a_bearing_is_told_by_loads_across_its_axis(tmp_path: Path) -> None:
    """Forces of every direction at the tip of an arm whose shoulder's bearing gives: c M_across x (p - o_2)."""
    axes = (UPRIGHT, (0.0, -1.0, 0.0), (0.0, -1.0, 0.0))
    lengths = (0.0, 0.8, 0.6)
    joints = tuple(Joint(axis=axis, range=(-2.5, 2.5)) for axis in axes)
    arm = Arm("bench", joints, tuple(Link(length, mass=0.0) for length in lengths), gravity=(0.0, 0.0, -G))
    rng = np.random.default_rng(7)
    count, compliance = 160, 1.5e-6
    q = rng.uniform(-2.0, 2.0, (count, 3))
    reach = 0.8 * np.cos(q[:, 1]) + 0.6 * np.cos(q[:, 1] + q[:, 2])
    height = 0.8 * np.sin(q[:, 1]) + 0.6 * np.sin(q[:, 1] + q[:, 2])
    tip = np.stack([reach * np.cos(q[:, 0]), reach * np.sin(q[:, 0]), height], axis=1)
    axis = np.stack([np.sin(q[:, 0]), -np.cos(q[:, 0]), 0.0 * height], axis=1)
    force = 100.0 * rng.standard_normal((count, 3))
    moment = np.cross(tip, force)
    across = moment - np.sum(moment * axis, axis=1)[:, None] * axis
    names = ["q1_deg", "q2_deg", "q3_deg", "fx_N", "fy_N", "fz_N"]
    columns = [*np.degrees(q).T, *force.T]
    moved = tip + compliance * np.cross(across, tip)
    result = diagnose(arm, recorded(tmp_path, arm, names, columns, moved))
    (finding,) = result.findings
    assert (result.verdict, finding.effect, finding.at) == ("named", "lateral_compliance", (2,))
    (size,) = finding.parameters
    # Three standard errors, by the interval's width.
    assert abs(size.value - compliance) <= 0.75 * (size.interval[1] - size.interval[0]) < 0.03 * compliance


@pytest.mark.parametrize("tilt", [9.5e-3, 0.0])
def test_a_boom_that_is_askew_at_its_root_is_told_by_one_number(tmp_path: Path, tilt: float) -> None:
    """A first slide that points down by `tilt` (rad): all that it carries goes down by tilt times its travel."""
    slide = Joint("prismatic", axis=LEVEL, range=(0.3, 1.5))
    boom = Arm("boom", (slide,), (Link(0.0, mass=0.0),), gravity=(0.0, 0.0, -G))
    h = np.random.default_rng(1).uniform(0.3, 1.5, 30)
    tip = np.stack([h * np.cos(tilt), 0.0 * h, -h * np.sin(tilt)], axis=1)
    result = diagnose(boom, recorded(tmp_path, boom, ["q1_mm"], [1e3 * h], tip))
    assert [(item.effect, item.at) for item in result.findings] == ([("frame_misalignment", ())] if tilt else [])
    assert result.unknown is None
    for finding in result.findings:
        (size,) = finding.parameters
        assert size.parameter == "about_y"
        assert size.interval[0] <= tilt <= size.interval[1]
