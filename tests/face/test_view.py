"""The view in space: what is drawn stands where the arm's own figures and formulas written here put it."""

import re
from pathlib import Path

import numpy as np
import plotly.graph_objects as go
import pytest

import linkwright as lw

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def points(figure, name, number=0):
    """The places (mm, N x 3) of the traces with a name."""
    trace = [item for item in figure.data if item.name == name][number]
    return np.array([trace.x, trace.y, trace.z], dtype=float).T


def scale_of(figure):
    return float(re.search(r"Displacements (\S+) times", figure.layout.title.text)[1])


@pytest.fixture(scope="module")
def evaluation():
    """A planar arm of two links without play, and its worst error."""
    link = lw.Link(length="500 mm", section=lw.shapes.Circle(diameter="30 mm"), material="steel-s355")
    arm = lw.Arm(
        chain=[(lw.Joint(range=["-60 deg", "60 deg"]), link), (lw.Joint(range=["-90 deg", "90 deg"]), link)],
        payload={"mass": "5 kg"},
    )
    return lw.evaluate(arm)


def test_the_bent_shape_ends_where_the_worst_error_does(evaluation):
    figure = lw.show(evaluation)
    assert isinstance(figure, go.Figure)
    q = np.radians(evaluation.worst_poses[["q1_deg", "q2_deg"]].to_numpy()[0])
    angles = np.cumsum(q) if evaluation.found.arm.angles == "relative" else q
    joints = np.array([[0.0, 0.0], [500.0 * np.cos(angles[0]), 500.0 * np.sin(angles[0])]])
    tip = joints[1] + 500.0 * np.array([np.cos(angles[1]), np.sin(angles[1])])
    assert points(figure, "joints")[:, :2] == pytest.approx(joints, abs=1e-9)
    error = evaluation.worst_poses[["error_x_mm", "error_y_mm"]].to_numpy()[0]
    promised = tip + scale_of(figure) * error
    assert points(figure, "arm")[-1, :2] == pytest.approx(tip, abs=1e-9)
    assert points(figure, "worst error")[-1, :2] == pytest.approx(promised, abs=1e-6)
    # To first order the arm without play errs by what bends it.
    assert points(figure, "bent")[-1, :2] == pytest.approx(promised, abs=0.02 * scale_of(figure) * np.abs(error).max())


def test_the_bent_shape_of_a_held_beam_is_that_of_the_textbook():
    """One level link on a stiff joint, a weight at its end: v(x) = F x^2 (3 L - x) / (6 E I), and next to no
    weight of its own."""
    material = {"elastic_modulus": 200e9, "poisson_ratio": 0.3, "density": 1.0}
    link = lw.Link(length=1.0, section=lw.shapes.Circle(diameter="40 mm"), material=material)
    joint = lw.Joint(axis="y", range=["-30 deg", "30 deg"])
    down = [0, 0, -9.80665]
    arm = lw.Arm(chain=[(joint, link)], payload={"mass": "10 kg"}, gravity=down, leave_out=["shear_deformation"])
    figure = lw.show(arm, pose="0", scale=1)
    x, _, z = points(figure, "bent").T
    stiffness = 200e9 * np.pi * 0.04**4 / 64
    at = np.linspace(0.0, 1.0, 13)
    expected = -10 * 9.80665 * at**2 * (3.0 - at) / (6.0 * stiffness) * 1e3
    assert z[:13] == pytest.approx(expected, rel=2e-3, abs=1e-9)
    assert x[:13] == pytest.approx(1e3 * at, abs=1e-9)
    assert scale_of(figure) == 1


def test_the_reach_is_all_of_what_the_joints_allow_and_no_more(evaluation):
    reach = points(lw.show(evaluation), "reach")
    distance = np.linalg.norm(reach, axis=1)
    assert distance.max() == pytest.approx(1000.0, rel=2e-3)
    assert np.abs(reach[:, 2]).max() == 0.0
    assert np.all(distance <= 1000.0 + 1e-9)


@pytest.mark.parametrize("planar", [True, False])
def test_the_window_holds_all_that_is_drawn_to_one_scale(evaluation, planar):
    """An arm in a plane has no depth: it is looked at from above, and does not fill the window from within."""
    figure = lw.show(evaluation if planar else EXAMPLES / "six-axis" / "arm.yaml")
    scene = figure.layout.scene
    spans = {name: np.ptp(scene[f"{name}axis"].range) for name in "xyz"}
    drawn = np.vstack([np.array([trace.x, trace.y, trace.z], dtype=float).T for trace in figure.data])
    for k, name in enumerate("xyz"):
        low, high = scene[f"{name}axis"].range
        assert low <= drawn[:, k].min() <= drawn[:, k].max() <= high
        assert scene.aspectratio[name] == pytest.approx(spans[name] / max(spans.values()))
    assert max(scene.aspectratio[name] for name in "xyz") == 1.0
    assert (scene.camera.eye.x == scene.camera.eye.y == 0.0) == planar


def test_arms_files_designs_and_findings_are_shown():
    six = lw.show(EXAMPLES / "six-axis" / "arm.yaml", pose="0 -90 90 0 45 0")
    assert np.ptp(points(six, "reach"), axis=0).min() > 500.0
    assert {"reach", "arm", "joints", "bent"} <= {item.name for item in six.data}
    folder = EXAMPLES / "hidden-backlash"
    result = lw.diagnose(folder / "arm.yaml", folder / "recording.csv")
    assert "arm" in {item.name for item in lw.show(result).data}


def test_what_has_no_mass_is_shown_unbent_and_what_has_no_arm_is_refused():
    arm = lw.Arm(chain=[(lw.Joint(axis="y"), lw.Link(length=0.5, rigid=True, mass="unknown"))])
    figure = lw.show(arm)
    assert "bent" not in {item.name for item in figure.data}
    assert "a mass is not known" in figure.layout.title.text
    with pytest.raises(lw.InputError, match="1 value is needed"):
        lw.show(arm, pose="0 0")
    proposed = lw.columns(EXAMPLES / "hidden-backlash" / "recording.csv", EXAMPLES / "hidden-backlash" / "arm.yaml")
    with pytest.raises(lw.InputError, match="takes an arm or a result that has one"):
        lw.show(proposed)


def test_every_tip_of_a_torso_reaches():
    link = {"length": "300 mm", "section": "IPE 80", "material": "steel-s355"}
    joint = {"axis": "y", "range": ["-90 deg", "90 deg"]}
    one = [{"joint": joint, "link": link}]
    branches = [{"name": "left", "origin": {"xyz": [0, 0.3, 0]}, "chain": one}, {"name": "right", "chain": one}]
    figure = lw.show(lw.Arm(chain=one, branches=branches))
    assert [item.name for item in figure.data].count("arm") == 2
    assert points(figure, "arm", 0)[-1] == pytest.approx([600.0, 300.0, 0.0], abs=1e-9)
    assert points(figure, "arm", 1)[-1] == pytest.approx([600.0, 0.0, 0.0], abs=1e-9)
    assert points(figure, "reach")[:, 1].tolist().count(300.0) == len(points(figure, "reach")) // 2
