"""Compliance, what each effect adds, warming, and masses: the rest of what `evaluate` says."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.effects.thermal.thermal_expansion import ThermalExpansionMissing
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.errors.tip import active_effects
from linkwright.core.arm.evaluation import compliance_at, evaluate
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import build
from tests import frame_solver
from tests.arm.builders import arm_of, chain_arm, rod_lines
from tests.costs import slow_but
from tests.random_chains import build_frame, random_planar_chain, random_spatial_chain

STEEL = load_catalogue(user=False).find("steel-s355")
ROD = build("circle", {"diameter": 0.05})


def spatial_arm(seed: int) -> Arm:
    rng = np.random.default_rng(seed)
    axes = [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.6, 0.8, 0.0)]
    bar = build("rectangle", {"width": 0.03, "height": 0.06})
    return Arm(
        "space",
        tuple(Joint(axis=axis, stiffness=float(rng.uniform(1e4, 1e5)), mass=2.0) for axis in axes),
        tuple(Link(float(rng.uniform(0.2, 0.6)), section=bar, material=STEEL) for _ in axes),
        gravity=(1.0, -2.0, -9.0),
        payload=LoadCase(2.0, (30.0, -10.0, 5.0)),
        tool=(0.05, 0.02, -0.03),
    )


def deterministic(arm: Arm, load: LoadCase, q: np.ndarray, only: str | None = None) -> np.ndarray:
    return error_model(arm, (load,), only).cases[0].arrays(q[None], beam_values(beams_of(arm))).vector[0]


@pytest.mark.parametrize("seed", slow_but(range(5), 0, 3))
def test_compliance_is_the_derivative_of_the_tips_displacement(seed: int) -> None:
    arm = spatial_arm(seed)
    q = np.random.default_rng(seed).uniform(-2.0, 2.0, 3)
    matrix = np.array(compliance_at(arm, beams_of(arm), q.tolist(), planar=False).matrix)
    step = 100.0
    for axis in range(3):
        pushed = np.array(arm.payload.force) + step * np.eye(3)[axis]
        change = deterministic(arm, replace(arm.payload, force=tuple(pushed)), q) - deterministic(arm, arm.payload, q)
        assert change / step == pytest.approx(matrix[:, axis], rel=1e-9, abs=1e-9 * np.abs(matrix).max())


@pytest.mark.parametrize("seed", slow_but(range(5), 0, 3))
def test_compliance_is_symmetric_where_the_model_is_complete(seed: int) -> None:
    """Maxwell and Betti: with slopes left out, work is no longer done twice the same way."""
    arm = spatial_arm(seed)
    q = [0.3, -0.8, 1.1]
    matrix = np.array(compliance_at(arm, beams_of(arm), q, planar=False).matrix)
    assert matrix == pytest.approx(matrix.T, abs=1e-12 * np.abs(matrix).max())
    assert np.all(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)) > 0.0)
    lame = replace(arm, leave_out=frozenset({"slope_propagation"}))
    broken = np.array(compliance_at(lame, beams_of(lame), q, planar=False).matrix)
    assert np.abs(broken - broken.T).max() > 1e-3 * np.abs(broken).max()


def test_compliance_equals_the_frame_solvers() -> None:
    for maker, size in ((random_planar_chain, 2), (random_spatial_chain, 3)):
        chain = replace(maker(np.random.default_rng(6), links=3), payload_mass=0.0, gravity=(0.0, 0.0, 0.0))
        arm, beams, q = chain_arm(chain, shear=True)
        arm = arm.with_links(tuple(replace(link, section=ROD, material=STEEL) for link in arm.links))
        matrix = np.array(compliance_at(arm, beams, q, planar=size == 2).matrix)
        for axis in range(size):
            frame, tip = build_frame(replace(chain, tip_force=tuple(np.eye(3)[axis])))
            expected = frame_solver.solve(frame)[tip][:size]
            assert matrix[:, axis] == pytest.approx(expected, rel=1e-7, abs=1e-8 * np.abs(matrix).max())


def test_principal_compliance_spans_the_ellipse() -> None:
    """The tip moves farthest under a force along the first principal axis of a symmetric compliance."""
    arm = Arm("one", (Joint(stiffness=2e4),), (Link(0.5, mass=1.0),))
    result = compliance_at(arm, beams_of(arm), [0.0], planar=True)
    assert result.principal[0] == pytest.approx(0.5**2 / 2e4, rel=1e-12)
    assert result.principal[1] == pytest.approx(0.0, abs=1e-18)
    assert np.abs(result.directions[0]) == pytest.approx([0.0, 1.0], abs=1e-12)


def test_each_effect_alone_adds_up_to_the_whole_vector() -> None:
    arm = spatial_arm(3)
    q = np.array([0.4, 0.9, -0.7])
    names = {effect.effect.id for effect in active_effects(arm)}
    total = sum(deterministic(arm, arm.payload, q, name) for name in names)
    assert total == pytest.approx(deterministic(arm, arm.payload, q), rel=1e-12)


def test_by_effect_lists_the_physics_that_the_arm_has_data_for(tmp_path: Path) -> None:
    result = evaluate(arm_of(rod_lines([400, 420], joint=", backlash: 1 mrad"), tmp_path))
    assert set(result.by_effect) == {
        "link_bending", "slope_propagation", "axial", "shear_deformation", "backlash"
    }  # fmt: skip
    # Stretched out: half a milliradian over 820 mm and over 420 mm.
    assert result.by_effect["backlash"] == pytest.approx(0.5e-3 * (0.82 + 0.42), rel=1e-6)
    without = evaluate(replace(result.arm, leave_out=frozenset({"backlash", "axial"})))
    assert not {"backlash", "axial"} & set(without.by_effect)


def test_expansion_counts_only_where_effects_name_it(tmp_path: Path) -> None:
    """alpha L (T - 20 degC): 24e-6 x 0.4 m x 30 K = 0.288 mm along the link."""
    material = "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3, thermal_expansion: 24 um/(m*K)}"
    base = "temperature: 50 degC\ngravity: [0 m/s^2, 0 m/s^2, 0 m/s^2]\n" + rod_lines([400, 420], material=material)
    assert evaluate(arm_of(base, tmp_path)).max_error == 0.0
    first = evaluate(arm_of(base + "effects: [{effect: thermal_expansion, at: 1}]\n", tmp_path))
    assert first.max_error == pytest.approx(24e-6 * 0.4 * 30, rel=1e-9)
    both = evaluate(arm_of(base + "effects: [{effect: thermal_expansion}]\n", tmp_path))
    assert both.max_error == pytest.approx(24e-6 * 0.82 * 30, rel=1e-9)
    cold = evaluate(arm_of(base.replace("50 degC", "20 degC") + "effects: [{effect: thermal_expansion}]\n", tmp_path))
    assert cold.max_error == 0.0


def test_expansion_of_a_material_without_a_coefficient_is_asked_for(tmp_path: Path) -> None:
    arm = arm_of("temperature: 50 degC\n" + rod_lines([400]) + "effects: [{effect: thermal_expansion}]\n", tmp_path)
    with pytest.raises(ThermalExpansionMissing, match="link 1"):
        evaluate(arm)
    given = EffectEntry("thermal_expansion", (1,), {"expansion": 12e-6, "warming": 10.0})
    assert evaluate(replace(arm, effects=(given,))).by_effect["thermal_expansion"] == pytest.approx(12e-6 * 0.4 * 10)


def test_an_effect_with_its_own_figure_acts_where_it_is_put() -> None:
    """A drive's compliance found by a diagnosis, at joint 2 only: tau l / K."""
    links = (Link(0.5, mass=0.0), Link(0.3, mass=0.0))
    result = EffectEntry("joint_compliance", (2,), {"stiffness": 1e4})
    arm = Arm("soft", (Joint(), Joint()), links, payload=LoadCase(mass=2.0), effects=(result,))
    vector = deterministic(arm, arm.payload, np.zeros(2))
    assert vector == pytest.approx([0.0, -2.0 * 9.81 * 0.3**2 / 1e4, 0.0], rel=1e-12)


def test_masses_add_up(tmp_path: Path) -> None:
    arm = arm_of(rod_lines([400, 420], joint=", mass: 3 kg"), tmp_path)
    result = evaluate(arm, load_cases=[LoadCase(1.0), LoadCase(4.0)])
    rods = 2700 * math.pi / 4 * 0.1**2 * 0.82
    assert result.mass == pytest.approx(rods, rel=1e-12)
    assert result.total_mass == pytest.approx(rods + 6.0 + 4.0, rel=1e-12)
    assert result.reach == pytest.approx(0.82)
    assert result.frequency is not None
    assert result.frequency.load_case == 1
