"""The blind proof proved: its mechanics against first principles, its seals, its doses and its scoring."""

import ast
import json
import math
import os
import re
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import yaml

from benchmarks.blind import aliases
from benchmarks.blind import run as run_module
from benchmarks.blind.answers import Answer, all_classes_right, dose_of, is_it, load, rate
from benchmarks.blind.commands import main
from benchmarks.blind.generator.arms import FAMILIES, draw_arm
from benchmarks.blind.generator.beams import circle, rectangular_tube, tube
from benchmarks.blind.generator.cases import kind_of, make_case
from benchmarks.blind.generator.concealed import Effect, departure
from benchmarks.blind.generator.designs import draw_design
from benchmarks.blind.generator.draws import SINGLES
from benchmarks.blind.generator.files import truth_of, write_case
from benchmarks.blind.generator.measurement import Tracker, noise
from benchmarks.blind.generator.mechanics import Arm, Joint, Link, nominal_inputs, solve, with_changes
from benchmarks.blind.generator.perturbation import departed, respond
from benchmarks.blind.generator.play import approached, backlash, play_path, pressed
from benchmarks.blind.generator.thermal import Air, crept, lagged
from benchmarks.blind.parameters import coverage
from benchmarks.blind.run import SealedTwiceError, run
from benchmarks.blind.score import score
from benchmarks.blind.seal import BrokenSealError, check_seal, write_seal
from benchmarks.blind.staging import exact, projected_rms, stage
from linkwright import command_line

pytestmark = pytest.mark.slow

PACKAGE = Path(__file__).resolve().parents[2] / "benchmarks" / "blind"
PROJECT = {"units", "registries", "sections", "materials", "catalogues", "arm", "optimize", "diagnose", "linkwright"}


def imports(path: Path) -> list[tuple[str, int]]:
    """Top names imported by a file, with the column of the statement: 0 runs at load. Where work is done is no part of
    what is judged: it counts as `executors`."""
    results = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            results += [(alias.name.split(".")[0], node.col_offset) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            module = (node.module or "").removeprefix("linkwright.core.executors") or "executors"
            results.append((module.split(".")[0], node.col_offset))
    return results


def test_generator_imports_nothing_of_the_project():
    """Only the runner touches the tool, inside the worker, by its command line; whole import of the rest is listed."""
    touches = []
    allowed = {"benchmarks", "executors", "numpy", "scipy", "pandas", "yaml", *sys.stdlib_module_names}
    for path in sorted([*PACKAGE.glob("*.py"), *PACKAGE.glob("generator/*.py")]):
        for name, column in imports(path):
            if name in PROJECT:
                touches.append((path.name, name, column > 0))
            else:
                assert name in allowed, (path.name, name)
        assert "import_module" not in path.read_text(encoding="utf-8")
        assert "__import__" not in path.read_text(encoding="utf-8")
    assert touches == [("run.py", "linkwright", True)]


# Mechanics


def cantilever(force, *, modulus=2e11, weight=0.0, length=1.0, count=1, exact_bending_only=True, rounds=40):
    """The tip of a clamped bar of 20 mm under `force` at its tip."""
    section = circle(0.02, 0.3)
    links = tuple(Link(length / count, (1, 0, 0), weight, section, modulus) for _ in range(count))
    bar = Arm("bar", "bar", (Joint(False, (0, 0, 1)),) * count, links, (0, -1, 0), 0.0, True)
    inputs = nominal_inputs(bar, np.zeros((count, 1)), np.zeros(1), np.array(force, dtype=float)[:, None])
    if exact_bending_only:
        soft = inputs.flexibility.copy()
        soft[:, :3] = 0.0
        inputs = with_changes(inputs, flexibility=soft)
    return solve(bar, inputs, rounds), modulus * section.inertia_in_plane


def test_cantilever_in_the_limit_of_small_loads():
    """F L^3 / 3EI and w L^4 / 8EI, Gere & Goodno."""
    solution, bending = cantilever([0.0, -1e-3, 0.0])
    assert solution.tip[1, 0] == pytest.approx(-1e-3 / (3 * bending), rel=1e-8)
    assert solution.torque[0, 0] == pytest.approx(-1e-3, rel=1e-8)
    heavy, bending = cantilever([0.0, 0.0, 0.0], weight=1e-3)
    assert heavy.tip[1, 0] == pytest.approx(-1e-3 / (8 * bending), rel=1e-8)


# Bisshopp & Drucker, Quart. Appl. Math. 3 (1945) 272; figures to five digits as tabulated by K. Mattiasson,
# Int. J. Numer. Meth. Eng. 17 (1981) 145, Table I: P L^2/EI, deflection along and across, over L.
@pytest.mark.parametrize(("load", "along", "across"), [(1.0, 0.05643, 0.30172), (2.0, 0.16064, 0.49346)])
def test_elastica_of_a_cantilever_with_a_dead_load(load, along, across):
    _, bending = cantilever([0.0, 0.0, 0.0])
    for count in (1, 3):
        solution, _ = cantilever([0.0, -load * bending, 0.0], count=count)
        assert 1.0 - solution.tip[0, 0] == pytest.approx(along, abs=1.5e-5)
        assert -solution.tip[1, 0] == pytest.approx(across, abs=1.5e-5)


def test_bending_in_space_is_that_in_the_plane_turned():
    _, bending = cantilever([0.0, 0.0, 0.0])
    size = bending
    flat, _ = cantilever([0.0, -size, 0.0])
    aside, _ = cantilever([0.0, -size * math.cos(0.7), size * math.sin(0.7)])
    assert aside.tip[0] == pytest.approx(flat.tip[0], rel=1e-9)
    assert np.hypot(aside.tip[1], aside.tip[2]) == pytest.approx(-flat.tip[1], rel=1e-9)


def test_sections_in_their_limits():
    """Thin tube: I = pi r^3 t, J = 2I, shear area A/2; solid circle without Poisson's effect 6/7 A (energy)."""
    thin = tube(0.2, 0.0001, 0.0)
    radius = 0.09995
    assert thin.inertia_in_plane == pytest.approx(math.pi * radius**3 * 1e-4, rel=1e-3)
    assert thin.torsion == 2 * thin.inertia_in_plane
    assert thin.shear_area_in_plane == pytest.approx(thin.area / 2, rel=1e-3)
    bar = circle(0.1, 0.0)
    assert bar.shear_area_in_plane == pytest.approx(bar.area * 6 / 7)
    # a box without flanges' breadth is two webs of which each has 5/6
    webs = rectangular_tube(0.00021, 0.1, 0.0001)
    assert webs.shear_area_in_plane == pytest.approx(5 / 6 * 2 * 0.1 * 1e-4, rel=0.01)


def test_drive_compliance_and_joint_torque_by_hand():
    """One rigid link of mass m with centre at L/2 and a payload: tau = -(m/2 + M) g L cos q, tip J tau c."""
    link = Link(0.8, (1, 0, 0), 5.0)  # 4 kg
    one = Arm("one", "one", (Joint(False, (0, 0, 1), 1e-6),), (link,), (0, -9.81, 0), 3.0, True)
    q = np.array([[0.4]])
    solution = solve(one, nominal_inputs(one, q, np.array([3.0]), np.zeros((3, 1))), 3)
    torque = -(2.0 + 3.0) * 9.81 * 0.8 * math.cos(0.4)
    assert solution.torque[0, 0] == pytest.approx(torque, rel=1e-4)
    turned = 0.4 + torque * 1e-6
    assert solution.tip[:, 0] == pytest.approx([0.8 * math.cos(turned), 0.8 * math.sin(turned), 0.0], abs=1e-8)


def test_spatial_arm_in_its_vertical_plane_is_the_planar_arm():
    """Joint 1 turns the plane about the vertical and carries no torque."""
    rng = np.random.default_rng(4)
    arm, _ = draw_arm("spatial_3r", "drives", rng)
    q = np.array([[0.0, 1.3], [0.5, 0.5], [-0.7, -0.7]])
    inputs = nominal_inputs(arm, q, np.full(2, 2.0), np.zeros((3, 2)))
    solution = solve(arm, inputs, 4)
    flat = Arm(
        "flat",
        "flat",
        tuple(replace(j, axis=(0, 0, 1)) for j in arm.joints[1:]),
        arm.links[1:],
        (0, -9.81, 0),
        2.0,
        True,
    )
    plane = solve(flat, nominal_inputs(flat, q[1:, :1], np.full(1, 2.0), np.zeros((3, 1))), 4)
    # the column bends as well: compare what the plane's two joints carry, not the tip
    assert solution.torque[1:, 0] == pytest.approx(plane.torque[:, 0], rel=2e-4)
    assert abs(solution.torque[0]) == pytest.approx(0.0, abs=1e-9)
    turn = np.array([[math.cos(1.3), -math.sin(1.3), 0], [math.sin(1.3), math.cos(1.3), 0], [0, 0, 1]])
    assert solution.tip[:, 1] == pytest.approx(turn @ solution.tip[:, 0], abs=1e-12)


@pytest.mark.parametrize("family", FAMILIES)
def test_torque_is_the_derivative_of_the_work(family):
    """Virtual work on the stiff arm: dW/dq_i = tau_i, for gravity, joint masses and a force at the tip."""
    rng = np.random.default_rng(11)
    arm, ranges = draw_arm(family, "bodies", rng)
    arm = replace(arm, joints=tuple(replace(j, compliance=0.0) for j in arm.joints))
    q = rng.uniform(ranges.low, ranges.high)[:, None]
    force = np.array([[7.0], [-4.0], [0.0 if arm.planar else 3.0]])
    load = np.array([2.5])
    torque = solve(arm, nominal_inputs(arm, q, load, force), 1).torque[:, 0]

    def work(at: np.ndarray) -> float:
        solution = solve(arm, nominal_inputs(arm, at, load, force), 1)
        g = np.array(arm.gravity)
        total = float((force[:, 0] + 2.5 * g) @ solution.tip[:, 0])
        for i, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True)):
            # with a slide the link begins where the slide stands
            end = solution.end_at[i, :, 0]
            start = solution.joint_at[i, :, 0] + (solution.axis[i, :, 0] * at[i, 0] if joint.prismatic else 0.0)
            total += link.line_mass * link.length * float(g @ (start + end)) / 2
            total += joint.mass * float(g @ solution.joint_at[i, :, 0])
        return total

    for i in range(arm.count):
        step = np.zeros_like(q)
        step[i] = 1e-5
        assert torque[i] == pytest.approx((work(q + step) - work(q - step)) / 2e-5, abs=1e-5)


# Play, friction, heat, time


def test_play_operator_stays_until_its_width_is_used_up():
    motor = np.array([0.0, 1.0, 0.8, 0.6, 0.4, 0.7])
    output = motor + play_path(motor, np.full(6, 0.4))
    assert output == pytest.approx([0.0, 0.8, 0.8, 0.8, 0.6, 0.6])


def test_backlash_held_lags_behind_the_side_and_seated_follows_the_load():
    """-b s/2 where friction holds, +b sgn(tau)/2 where the load seats; a row without movement changes nothing."""
    q, side = np.array([0.1, 0.5, 0.5, -0.3]), np.array([1.0, -1.0, 1.0, 1.0])
    fresh = np.array([1.0, 1.0, 0.0, 1.0])
    held = backlash(q, side, np.zeros(4), 2e-3, 10.0, 0.03, fresh)
    assert held == pytest.approx([-1e-3, 1e-3, 1e-3, -1e-3])
    seated = backlash(q, side, np.array([20.0, -20.0, -20.0, 5.0]), 2e-3, 10.0, 0.03, fresh)
    assert seated == pytest.approx([1e-3, -1e-3, -1e-3, -1e-3])


def test_approach_shorter_than_the_play_leaves_it_where_it_was():
    """What sets a memory apart from a rule in the sign of the side."""
    at = approached(np.array([0.0, 0.0]), np.array([1.0, -1.0]), np.full(2, 0.1), 0.01, np.ones(2))
    assert at[1] != pytest.approx(0.05)
    assert abs(at[1]) < 0.05


def test_pin_settles_where_the_load_presses_it():
    force = np.array([[0.0, 3.0], [-5.0, 4.0], [0.0, 9.0]])
    axis = np.repeat(np.array([[0.0], [0.0], [1.0]]), 2, axis=1)
    rest = pressed(force, axis, 2e-5).T
    assert rest == pytest.approx(np.array([[0, -2e-5, 0], [1.2e-5, 1.6e-5, 0]]))


def test_thermal_lag_answers_a_step_and_a_ramp():
    """Step: 1 - exp(-t/lag); ramp of rate r: r (t - lag (1 - exp(-t/lag)))."""
    clock = np.linspace(0.0, 10000.0, 2001)
    lag = 1800.0
    ramp = lagged(Air(clock, 20.0 + 1e-3 * clock), lag, clock)
    assert ramp == pytest.approx(20.0 + 1e-3 * (clock - lag * (1.0 - np.exp(-clock / lag))), abs=1e-9)
    stepped = np.where(clock > 0.0, 30.0, 20.0)
    answer = lagged(Air(clock, stepped), lag, clock)
    assert answer == pytest.approx(30.0 - 10.0 * np.exp(-clock / lag), abs=0.02)
    assert lagged(Air(clock, stepped), 0.0, clock) == pytest.approx(stepped)
    assert crept(np.array([5.0, 5.0 + 3600.0]), 3600.0) == pytest.approx([0.0, 1.0 - math.exp(-1.0)])


def test_tracker_keeps_its_sigma_and_its_vices():
    rng = np.random.default_rng(0)
    plain, none = noise(Tracker(1e-5, (1.2, math.sqrt(2 - 1.44))), 2, 20000, rng)
    assert none == []
    assert np.sqrt(np.mean(plain**2)) == pytest.approx(1e-5, rel=0.03)
    assert plain[0].std() / plain[1].std() == pytest.approx(1.2 / math.sqrt(0.56), rel=0.05)
    tied, _ = noise(Tracker(1e-5, (1.0, 1.0), correlation=0.5), 2, 20000, rng)
    assert np.corrcoef(tied[0, 1:], tied[0, :-1])[0, 1] == pytest.approx(0.5, abs=0.03)
    assert tied.std() == pytest.approx(1e-5, rel=0.03)
    wild, rows = noise(Tracker(1e-5, (1.0, 1.0), outlier_share=0.02), 2, 500, rng)
    assert len(rows) == 10
    assert np.linalg.norm(wild[:, rows], axis=0).min() > 5e-5


# Effects on the chain


def scene_of(family: str, stiffness: str, design: str, seed: int = 1):
    rng = np.random.default_rng(seed)
    arm, ranges = draw_arm(family, stiffness, rng)
    return stage(arm, draw_design(design, arm, ranges, rng))


@pytest.mark.parametrize(
    ("effect", "by_hand"),
    [
        (Effect("encoder_offset", (2,), "", {"offset": 1e-5}), lambda g: 1e-5 * g.jacobian[1]),
        (Effect("encoder_scale", (3,), "", {"scale": 1e-5}), lambda g: 1e-5 * g.q[2] * g.jacobian[2]),
        (Effect("joint_coupling", (3,), "", {"ratio": 1e-5}), lambda g: 1e-5 * g.q[1] * g.jacobian[2]),
        (
            Effect("gear_transmission_error", (1,), "", {"harmonic": 3.0, "sine": 1e-5, "cosine": 2e-5}),
            lambda g: (1e-5 * np.sin(3 * g.q[0]) + 2e-5 * np.cos(3 * g.q[0])) * g.jacobian[0],
        ),
        (Effect("link_length", (2,), "", {"length": 1e-5}), lambda g: 1e-5 * g.along[1]),
        (
            Effect("tool_offset", (), "", {"a": 1e-5, "b": 2e-5, "c": 0.0}),
            lambda g: 1e-5 * g.along[2] + 2e-5 * np.stack([-g.along[2][1], g.along[2][0]]),
        ),
    ],
)
def test_geometric_effects_have_the_signs_of_the_table(effect, by_hand):
    """sum J_i delta_i with J_i = z x (p - o_i), u_i = (cos phi_i, sin phi_i): by plain trigonometry."""
    scene, response = scene_of("planar_3r", "bodies", "full")
    stiff = replace(scene.arm, joints=tuple(replace(j, compliance=0.0) for j in scene.arm.joints))
    scene, response = stage(stiff, scene.design)
    q = scene.design.q
    phi = np.cumsum(q, axis=0)
    u = [np.stack([np.cos(p), np.sin(p)]) for p in phi]
    ends = np.cumsum([link.length * way for link, way in zip(stiff.links, u, strict=True)], axis=0)
    starts = [np.zeros_like(ends[0]), ends[0], ends[1]]
    jacobian = [np.stack([-(ends[2] - s)[1], (ends[2] - s)[0]]) for s in starts]
    expected = by_hand(SimpleNamespace(q=q, jacobian=jacobian, along=u))
    assert aliases.signature(effect, scene, response)[:2] == pytest.approx(expected, abs=2e-10)
    change = exact(stiff, scene.design, (effect,)) - exact(stiff, scene.design, ())
    assert change[:2] == pytest.approx(expected, abs=2e-9)


def test_cantilever_formulas_hold_link_by_link():
    """A rigid link given 1/EI bends by n (F L^3/3 + M L^2/2 + w L^4/8)/EI and turns what follows; dp by hand."""
    scene, response = scene_of("planar_2r", "bodies", "two_payloads")
    arm, flexible = scene.arm, 1e-7
    effect = Effect("link_bending", (1,), "", {"flexibility": flexible})
    q, g = scene.design.q, 9.81
    phi = np.cumsum(q, axis=0)
    one, two = arm.links
    w1, w2 = one.line_mass * g, two.line_mass * g
    beyond = (scene.design.payload + arm.joints[1].mass) * g + w2 * two.length
    across, weight = -beyond * np.cos(phi[0]), -w1 * np.cos(phi[0])
    moment = -(scene.design.payload * g * two.length + w2 * two.length**2 / 2) * np.cos(phi[1])
    length = one.length
    sag = (across * length**3 / 3 + moment * length**2 / 2 + weight * length**4 / 8) * flexible
    slope = (across * length**2 / 2 + moment * length + weight * length**3 / 6) * flexible
    n = np.stack([-np.sin(phi[0]), np.cos(phi[0])])
    turned = two.length * np.stack([-np.sin(phi[1]), np.cos(phi[1])]) * slope
    expected = n * sag + turned
    change = aliases.signature(effect, scene, response)[:2]
    assert change == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())


def test_gravity_alone_makes_clearance_a_shift_of_the_frame():
    scene, response = scene_of("welding_3r", "links", "two_payloads")
    scene = replace(scene, design=replace(scene.design, frame_free=True))
    change = aliases.signature(Effect("clearance", (2,), "", {"radius": 5e-5}), scene, response)
    left, raw = projected_rms(change, scene, response, True)
    assert raw == pytest.approx(5e-5, rel=1e-6)
    assert left < 1e-6 * raw


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (("thermal_bending", (1,)), ("gearbox_thermal", (1, 2))),
        (("servo_droop", (2,)), ("joint_compliance", (2,))),
        (("base_compliance", ()), ("joint_compliance", (1,))),
    ],
)
def test_exact_aliases_of_the_table_are_found(one, other):
    """Half of a thermal bending at each end; droop and drive; base and first joint."""
    scene, response = scene_of("planar_3r", "drives", "full")
    result = aliases.candidates(scene, response, [])
    parameters = {"gradient": 0.1, "lag": 0.0, "compliance": 1e-6}
    column = aliases.flat(aliases.signature(Effect(*one, "", parameters), scene, response), True)
    none = np.zeros((0, 0))
    reached = {(c.effect, c.at): r for r, c in aliases.correlations(column, result, none)}
    assert reached[other] == pytest.approx(1.0, abs=1e-3)
    assert reached["encoder_scale", (3,)] < 0.98


def test_response_is_the_derivative_of_the_exact_solution():
    scene, response = scene_of("spatial_3r", "drives", "forced")
    for name, parameters, at in (
        ("joint_compliance", {"compliance": 1e-9}, (2,)),
        ("link_mass", {"mass": 0.01}, (3,)),
        ("payload", {"mass": 0.01}, ()),
        ("thermal_bending", {"gradient": 1e-3, "lag": 0.0}, (2,)),
        ("tip_spring", {"rate": 0.1, "x": 0.1, "y": 0.2, "z": 0.3}, ()),
    ):
        effect = Effect(name, at, "", parameters)
        change = exact(scene.arm, scene.design, (effect,)) - exact(scene.arm, scene.design, ())
        first = aliases.signature(effect, scene, response)
        assert first == pytest.approx(change, abs=2e-3 * np.abs(change).max()), name


def test_departure_of_an_unknown_effect_is_an_error():
    scene, _ = scene_of("planar_2r", "links", "poor")
    with pytest.raises(ValueError, match="witchcraft"):
        departure(Effect("witchcraft", (1,), "", {}), scene)
    assert departed(
        nominal_inputs(scene.arm, scene.design.q, scene.design.payload, scene.design.force),
        departure(Effect("payload", (), "", {"mass": 1.0}), scene),
    ).payload == pytest.approx(scene.design.payload + 1.0)
    assert respond(scene.arm, scene.design.q, scene.design.payload, scene.design.force).payload.shape[0] == 3


# Cases


def index_of(kind: str, effect: str | None = None) -> tuple[int, int]:
    for index in range(2000):
        result, number = kind_of(index)
        if result == kind and (effect is None or SINGLES[(number // 6 + 5 * number) % len(SINGLES)] == effect):
            return index, number
    raise LookupError(kind)


def test_kinds_come_in_their_shares():
    kinds = [kind_of(index) for index in range(2000)]
    assert len(set(kinds)) == 2000
    count = {name: sum(k == name for k, _ in kinds) for name in {k for k, _ in kinds}}
    assert count["null"] + count["hostile_null"] >= 600
    assert count["null"] == count["hostile_null"]
    singles = {(SINGLES[(n // 6 + 5 * n) % len(SINGLES)], n % 6) for k, n in kinds if k == "single"}
    assert len(singles) == 6 * len(SINGLES)


@pytest.mark.parametrize("effect", ["joint_compliance", "encoder_offset", "thermal_expansion", "backlash"])
def test_dose_is_reached(effect):
    index, number = index_of("single", effect)
    case = make_case("x", (5, 0, index), "single", number)
    assert case.effects[0].effect == effect
    assert case.projected_snr == pytest.approx(case.dose, rel=0.1)
    assert case.visible


def test_null_holds_nothing_but_noise():
    """The readings less the exact nominal positions have the tracker's sigma; linear theory is near enough."""
    index, number = index_of("null")
    case = make_case("x", (5, 0, index), "null", number)
    rest = case.readings - exact(case.arm, case.design, ())[: case.readings.shape[0]]
    assert rest.std() == pytest.approx(case.tracker.sigma, rel=0.25)
    assert case.nonlinearity < 0.1
    assert not case.visible


def test_same_seed_same_files_other_seed_others(tmp_path):
    index, number = index_of("pair")
    for folder, seed in (("a", 1), ("b", 1), ("c", 2)):
        write_case(make_case("00001", (seed, 0, index), "pair", number), tmp_path / folder)
    names = ("cases/00001/arm.yaml", "cases/00001/recording.csv", "cases/00001/recording.yaml", "truth/00001.json")
    first, same, other = ([(tmp_path / folder / name).read_bytes() for name in names] for folder in "abc")
    assert first == same
    assert first[1] != other[1]


def test_files_hold_what_the_contract_asks(tmp_path):
    """Columns with their units; the tool's files name no truth."""
    index, number = index_of("invisible")
    case = make_case("00009", (3, 1, index), "invisible", number)
    write_case(case, tmp_path)
    folder = tmp_path / "cases" / "00009"
    table = pd.read_csv(folder / "recording.csv")
    pattern = r"time_s|q\d_(deg|mm)|dir\d|payload_kg|temperature_degC|[xyz]_mm|v\d_deg_s|f[xyz]_N"
    assert all(re.fullmatch(pattern, name) for name in table.columns)
    assert {"x_mm", "y_mm"} <= set(table.columns)
    assert 40 <= len(table) <= 400
    chain = yaml.safe_load((folder / "arm.yaml").read_text(encoding="utf-8"))["chain"]
    assert len(chain) == case.arm.count
    settings = yaml.safe_load((folder / "recording.yaml").read_text(encoding="utf-8"))
    assert settings["frame"] in ("free", "known")
    assert not {path.name for path in folder.iterdir()} - {"arm.yaml", "recording.csv", "recording.yaml"}
    truth = truth_of(case)
    assert truth["kind"] == "invisible"
    assert truth["effects"][0]["effect"] not in (folder / "arm.yaml").read_text(encoding="utf-8")


# Seals and runs


@pytest.fixture
def sealed(tmp_path) -> Path:
    """Three cases of a sealed half with their truths."""
    root = tmp_path / "half"
    for name in ("00000", "00001", "00002"):
        (root / "cases" / name).mkdir(parents=True)
        (root / "truth").mkdir(exist_ok=True)
        (root / "truth" / f"{name}.json").write_text(json.dumps(truth(name, "null")))
    write_seal(root, "sealed")
    return root


def answered(folder: Path, names: tuple[str, ...]) -> None:
    folder.mkdir(exist_ok=True)
    for name in names:
        record = {"case": name, "status": 0, "seconds": 0.1, "error": "", "diagnosis": said("none")}
        (folder / f"{name}.json").write_text(json.dumps(record))


def test_seal_holds_and_breaks(sealed):
    check_seal(sealed)
    path = sealed / "truth" / "00001.json"
    kept = path.read_text()
    path.write_text(kept.replace("null", "pair"))
    with pytest.raises(BrokenSealError, match=r"1 truths .* first 00001"):
        check_seal(sealed)
    path.write_text(kept)
    check_seal(sealed)
    (sealed / "truth" / "00003.json").write_text("{}")
    with pytest.raises(BrokenSealError, match="00003"):
        check_seal(sealed)
    (sealed / "truth" / "00003.json").unlink()
    text = (sealed / "seal.txt").read_text()
    (sealed / "seal.txt").write_text(text.replace("half sealed", "half disclosed"))
    with pytest.raises(BrokenSealError, match="the list"):
        check_seal(sealed)


def test_sealed_half_is_asked_once(sealed, tmp_path):
    """All answered: no run; truths opened: no run, in whatever folder."""
    answered(tmp_path / "answers", ("00000", "00001", "00002"))
    with pytest.raises(SealedTwiceError, match="not asked twice"):
        run(sealed, tmp_path / "answers")
    load(sealed, tmp_path / "answers")
    with pytest.raises(SealedTwiceError, match="opened"):
        run(sealed, tmp_path / "elsewhere")


def test_truths_stay_shut_until_all_is_answered(sealed, tmp_path):
    answered(tmp_path / "answers", ("00000", "00002"))
    with pytest.raises(FileNotFoundError, match="1 of 3"):
        load(sealed, tmp_path / "answers", partial=True)
    assert not (sealed / "scored.txt").exists()


def stand_in(case: str, answer: str, seconds: float) -> tuple[int, float, str]:
    """Answers the first case, fails at the second, dies at the third."""
    name = Path(case).name
    if name == "00001":
        raise TimeoutError(f"after {seconds} s")
    if name == "00002":
        os._exit(3)
    Path(answer).write_text(json.dumps(said("none")))
    return 0, 0.5, ""


def test_runner_survives_failures_and_deaths(sealed, tmp_path, monkeypatch):
    """Each case gets its record; only the culprits fail, and a second run finds nothing to ask."""
    monkeypatch.setattr(run_module, "ask", stand_in)
    answers = tmp_path / "answers"
    assert run(sealed, answers, jobs=2, limit=1) == 1
    assert run(sealed, answers, jobs=2, seconds=7.0) == 2
    records = [json.loads((answers / f"0000{k}.json").read_text()) for k in range(3)]
    assert [record["status"] for record in records] == [0, -1, -1]
    assert records[0]["diagnosis"]["verdict"] == "none"
    assert "after 7.0 s" in records[1]["error"]
    with pytest.raises(SealedTwiceError):
        run(sealed, answers)


def test_no_answer_in_time_is_said(tmp_path, monkeypatch):
    """Time that runs out inside the tool is no file's or reader's fault, for which the tool has exit statuses."""
    monkeypatch.setattr(command_line, "command_line", lambda _: lambda **_given: time.sleep(20.0))
    status, seconds, error = run_module.ask(str(tmp_path / "00000"), str(tmp_path / "a" / "00000.json"), 0.05)
    assert (status, error) == (run_module.FAILED, "no answer in 0.05 s")
    assert 0.05 <= seconds < 20.0


def test_command_line_says_in_one_line_what_is_wrong(sealed, tmp_path, capsys):
    assert main(["score", str(sealed), "--answers", str(tmp_path / "none")]) == 2
    assert "have no answer" in capsys.readouterr().err


# Scoring


def truth(name: str, kind: str, effects=(), **more):
    """A truth as sealed, by hand."""
    made = {
        "case": name,
        "kind": kind,
        "arm": "planar_3r",
        "design": "full",
        "effects": [{"effect": e, "at": at, "parameters": p} for e, at, p in effects],
        "projected_snr": 1.0,
        "effect_snr": [1.0] * len(effects),
        "snr_beyond_library": None,
        "noise_rms_mm": 0.02,
        "since_s": None,
        "aliases": [],
        "aliases_given_geometry": [],
        "visible": True,
        "hostility": [],
    }
    return made | more


def said(verdict: str, *missing, joint=None, since=None, held=0.0205):
    """A diagnosis, by hand: missing as (effect, at, alternatives, parameters)."""
    return {
        "verdict": verdict,
        "noise_floor_mm": 0.02,
        "rms_after_held_out_mm": held,
        "missing": [{"effect": e, "at": at, "alternatives": alt, "parameters": p} for e, at, alt, p in missing],
        "where": {"joint": joint, "since_s": since},
    }


def scored(*pairs):
    truths = [t for t, _ in pairs]
    answers = {t["case"]: Answer(t["case"], 0 if d else 1, 1.0, d) for t, d in pairs}
    return score(truths, answers)


COMPLIANCE = {"compliance_2": {"value": 2.1e-5, "unit": "rad/(N*m)"}}


def test_nulls_count_every_kind_of_alarm():
    result = scored(
        (truth("0", "null"), said("none")),
        (truth("1", "null"), said("unknown")),
        (truth("2", "hostile_null", hostility=["outliers"]), said("named", ("payload", [], [], {}))),
        (truth("3", "hostile_null", hostility=["heavy_tails"]), said("insufficient_data")),
        (truth("4", "null"), None),
    )
    assert (result.false_alarms.count, result.false_alarms.total) == (2, 5)
    assert (result.false_alarms_hostile.count, result.false_alarms_hostile.total) == (1, 2)
    assert dict(result.false_alarms_by_hostility)["outliers"].share == 1.0
    assert result.failed.count == 1


def test_singles_are_right_by_class_and_by_name():
    true = [("joint_compliance", [2], COMPLIANCE)]
    interval = {"compliance_2": {"value": 21.5, "unit": "urad/(N*m)", "ci95": [20.0, 22.0]}}
    wide = {"compliance_2": {"value": 3e-5, "unit": "rad/(N*m)", "ci95": [2.5e-5, 3.5e-5]}}
    result = scored(
        (truth("0", "single", true), said("named", ("joint_compliance", [2], [], interval), joint=2)),
        (
            truth("1", "single", true, aliases=[["servo_droop", [2]]]),
            said("alias_class", ("servo_droop", [2], [["joint_compliance", [2]]], {}), joint=2),
        ),
        (truth("2", "single", true), said("named", ("joint_compliance", [3], [], {}), joint=3)),
        (truth("3", "single", true, aliases=[["link_bending", [2]]]), said("named", ("link_bending", [2], [], {}))),
        (truth("4", "single", true), said("none")),
        (truth("5", "single", true, projected_snr=7.0), said("named", ("joint_compliance", [2], [], wide), held=0.03)),
    )
    by = dict(result.class_by_dose)
    assert (by["1.0"].count, by["1.0"].total) == (2, 5)
    assert (by["8.0"].count, by["8.0"].total) == (1, 1)
    assert dict(result.exact_by_dose)["1.0"].count == 1
    assert dict(result.named_within_true_aliases_by_dose)["1.0"].count == 3
    assert dict(result.wrong_name_by_dose)["1.0"].count == 1
    assert dict(result.detected_by_dose)["1.0"].count == 4
    assert (result.coverage.count, result.coverage.total) == (1, 2)
    assert (result.joint_right.count, result.joint_right.total) == (2, 3)
    assert result.joint_within_one.count == 3
    assert result.held_out_over_floor.count == 3
    assert result.held_out_over_floor.within == pytest.approx(2 / 3)
    assert dict(result.confusion)["joint_compliance"][0] == ("joint_compliance", 3)


def test_pairs_must_match_one_to_one():
    true = [("joint_compliance", [2], {}), ("encoder_offset", [3], {})]
    good = (("encoder_offset", [3], [], {}), ("link_bending", [2], [["joint_compliance", [2]]], {}))
    pair = truth("0", "pair", true)
    assert all_classes_right(Answer("0", 0, 1.0, said("named", *good)), pair)
    assert not all_classes_right(Answer("0", 0, 1.0, said("named", good[0])), pair)
    assert not all_classes_right(Answer("0", 0, 1.0, said("named", good[0], good[0])), pair)
    extra = ("payload", [], [], {})
    assert not all_classes_right(Answer("0", 0, 1.0, said("named", *good, extra)), pair)
    result = scored((pair, said("named", *good)), (truth("1", "pair", true), said("named", good[0])))
    assert (result.pairs_by_weaker.count, result.pairs_by_weaker.total) == (1, 2)


def test_outside_must_stay_unknown_and_invisible_be_refused():
    slip = [("slip", [2], {})]
    droop = [("servo_droop", [2], {})]
    hidden = [("encoder_offset", [1], {})]
    result = scored(
        (
            truth("0", "outside", slip, since_s=3600.0, snr_beyond_library=0.9),
            said("unknown", joint=2, since=3540.0),
        ),
        (truth("1", "outside", slip, projected_snr=4.0, snr_beyond_library=2.0), said("named", ("creep", [2], [], {}))),
        (truth("2", "outside", slip, projected_snr=0.25, snr_beyond_library=0.2), said("none")),
        (truth("3", "invisible", hidden, visible=False), said("none")),
        (truth("4", "invisible", hidden, visible=False), said("named", ("payload", [], [], {}))),
        (truth("5", "invisible", droop), said("named", ("joint_compliance", [2], [], {}))),
        (truth("6", "invisible", droop), said("alias_class", ("joint_compliance", [2], [["servo_droop", [2]]], {}))),
    )
    assert (result.unknown_recall.count, result.unknown_recall.total) == (1, 2)
    assert (result.wrong_closure.count, result.wrong_closure.total) == (1, 2)
    assert (result.wrong_closure_beyond_library.count, result.wrong_closure_beyond_library.total) == (1, 1)
    assert (result.refused.count, result.refused.total) == (1, 2)
    assert (result.aliases_declared.count, result.aliases_declared.total) == (1, 2)
    assert result.since_error_s.median == 60.0


def test_places_matter_only_where_an_effect_has_one():
    assert is_it("payload", [3], {"effect": "payload", "at": []})
    assert not is_it("backlash", [3], {"effect": "backlash", "at": [2]})
    assert is_it("thermal_expansion", [3, 1, 2], {"effect": "thermal_expansion", "at": [1, 2, 3]})


def test_intervals_are_compared_only_within_name_and_dimension():
    true = {"parameters": {"offset_2": {"value": 1e-3, "unit": "rad"}}}

    def entry(name, unit, low, high):
        return {"parameters": {name: {"value": 0.0, "unit": unit, "ci95": [low, high]}}}

    assert coverage(entry("offset_2", "mrad", 0.9, 1.1), true) == [("offset", True)]
    assert coverage(entry("delta", "deg", 0.05, 0.06), true) == [("offset", True)]
    assert coverage(entry("offset_2", "mrad", 1.1, 1.2), true) == [("offset", False)]
    for other in (entry("offset_3", "rad", 0, 1), entry("offset_2", "mm", 0, 1), entry("stiffness_2", "rad", 0, 1)):
        assert coverage(other, true) == []


def test_rates_have_exact_intervals():
    """No event in 300: upper end 1 - 0.025^(1/300)."""
    none = rate([False] * 300)
    assert (none.low, none.high) == (0.0, pytest.approx(1 - 0.025 ** (1 / 300)))
    assert rate([]).high == 1.0
    assert rate([True] * 5).low == pytest.approx(0.025 ** (1 / 5))
    assert dose_of(1.3) == 1.0
    assert dose_of(0.0) == 0.25


def test_make_run_limit_and_score_by_the_command_line(tmp_path, capsys):
    """A small disclosed half from end to end; answers by hand."""
    root, answers = tmp_path / "half", tmp_path / "answers"
    assert main(["make", "--cases", "3", "--seed", "9", "--half", "disclosed", "--out", str(root), "--jobs", "1"]) == 0
    assert main(["make", "--cases", "3", "--seed", "9", "--half", "disclosed", "--out", str(root)]) == 2
    answered(answers, ("00000", "00001", "00002"))
    assert run(root, answers) == 0
    out = tmp_path / "score.json"
    assert main(["score", str(root), "--answers", str(answers), "--json", str(out)]) == 0
    assert "| false alarms |" in capsys.readouterr().out
    assert sum(count for _, count in json.loads(out.read_text())["cases"]) == 3
