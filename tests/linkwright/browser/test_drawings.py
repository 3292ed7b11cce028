"""What is drawn of a bent arm, against the arm that is solved on its own bent shape."""

import numpy as np
import pytest

import linkwright as lw
from linkwright.browser.server.drawings import choices_to_click, worst_poses
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.exact import deformed
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.tip import active_effects
from linkwright.report.pictures.loads import bent_shape

ARM = "examples/several-loads/arm.yaml"


@pytest.mark.parametrize("q", [(0.3, -0.8, 0.5), (1.2, 0.4, -1.0)])
def test_the_bent_shape_ends_where_the_arm_does(q):
    """At the tip and at each joint; the exact solution differs by what is beyond first order, a few per mille."""
    arm = lw.read_arm(ARM).replace("leave_out", ["backlash", "clearance"]).model
    beams = beams_of(arm, (arm.payload,))
    places, shifts = bent_shape(arm, solve(arm, list(q), beams, arm.payload))
    result = deformed(solve(arm, [np.array([value]) for value in q], beams, arm.payload), active_effects(arm), 1)
    assert np.linalg.norm(result.tip) > 1e-5
    np.testing.assert_allclose(shifts[-1], result.tip[0], rtol=1e-2, atol=1e-7)
    nominal, bent = np.zeros(3), np.zeros(3)
    per_link = (len(places) - 1) // arm.size
    for index, (straight, link) in enumerate(
        zip(solve(arm, list(q), beams, arm.payload).links, result.state.links, strict=True)
    ):
        nominal = nominal + np.array([float(x) for x in straight.vector])
        bent = bent + np.array([float(np.ravel(x)[0]) for x in link.vector])
        np.testing.assert_allclose(places[(index + 1) * per_link - 1], nominal, atol=1e-12)
        np.testing.assert_allclose(shifts[(index + 1) * per_link - 1], bent - nominal, rtol=1e-2, atol=2e-7)


def test_the_shape_has_no_corner_within_a_link():
    """A cubic each: second differences along a link lie on a straight line."""
    arm = lw.read_arm(ARM).model
    state = solve(arm, [0.3, -0.8, 0.5], beams_of(arm, (arm.payload,)), arm.payload)
    _, shifts = bent_shape(arm, state)
    first = shifts[: (len(shifts) - 1) // arm.size]
    bending = np.diff(first, n=2, axis=0)
    assert np.abs(bending).max() > 1e-9
    np.testing.assert_allclose(np.diff(bending, n=2, axis=0), 0.0, atol=1e-12)


def test_each_worst_pose_is_told_and_drawn():
    """Names are data, not markup."""
    arm = lw.read_arm(ARM).replace("name", "<script>alert(1)</script>")
    told = worst_poses(lw.evaluate(arm).found)
    assert told
    for item in told:
        assert item["svg"].count("<svg") == 1
        assert 'class="bent"' in item["svg"]
        assert "<script>" not in item["svg"]


def test_near_ties_are_drawn_with_the_figures_of_their_arm_files(tmp_path):
    """Two steels of one stiffness: each design's file, read again, has the worst error and the mass that are shown."""
    problem = lw.Problem(
        arm="examples/several-loads/arm.yaml",
        subject_to={"mass": "<= 12 kg", "section_size": ["40 mm", "110 mm"], "thickness": ["3 mm", "8 mm"]},
        choose={"section": ["tube"], "material": ["steel-s235", "steel-s355"], "same": ["size", "material"]},
    )
    result = lw.optimize(problem)
    assert result.found.near_ties
    designs, arms = choices_to_click(result)
    assert len(designs) == 1 + len(result.found.near_ties)
    assert next(iter(designs)).startswith("best: ")
    for shown in list(designs.values())[1:]:
        file = tmp_path / shown["file"].replace("/", "-")
        lw.Arm.of(arms[shown["file"]]).save(file)
        again = lw.evaluate(lw.read_arm(file))
        told = {item["figure"]: float(item["value"].split()[0]) for item in shown["figures"]}
        assert told["worst error"] == pytest.approx(again.max_error_mm, rel=1e-3)
        assert told["mass of the links"] == pytest.approx(again.mass_kg, rel=1e-3)
