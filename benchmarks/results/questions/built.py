"""Arms that are built otherwise, or move: flanges, housings, beams on supports, open sections, short tubes, cycles."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from scipy.optimize import brentq

from benchmarks.results.row import Row
from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.chain.chain import Joint as JointOfArm
from linkwright.core.arm.chain.chain import Link as LinkOfArm
from linkwright.core.arm.errors.at_pose import errors_at
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures.motion.settling import settled, swung
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import build
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.properties import SectionProperties

from .beams import Chain, Joint, Link, Load, grid, tube
from .singly import (
    LENGTHS,
    METALS,
    RODS,
    STIFFNESS,
    Asked,
    Plane,
    lightest_rods,
    metal,
    off,
    problem_of,
    rods,
    worst,
)

_TWO_KG = Load(2.0)
_LIMIT = "max_error: '<= 0.9 mm'"
_FLANGE = (1.0 / 20e3, 1.0 / 50e3, 0.5)
_GIVE = (
    (1e-9, 0.0, 0.0, 0.0, 0.0, 0.0),
    (0.0, 4e-8, 0.0, 0.0, 0.0, 1.2e-7),
    (0.0, 0.0, 4e-8, 0.0, -1.2e-7, 0.0),
    (0.0, 0.0, 0.0, 1e-6, 0.0, 0.0),
    (0.0, 0.0, -1.2e-7, 0.0, 6e-7, 0.0),
    (0.0, 1.2e-7, 0.0, 0.0, 0.0, 6e-7),
)
"""Of a housing's far end, m and rad by N and N*m."""


def at_a_pose() -> Row:
    """The error at poses of an arm in space, its vector and its turn."""
    text = (
        "gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]\nchain:\n"
        "  - joint: {stiffness: 50 kN*m/rad}\n    link: {length: 400 mm, section: {shape: tube, diameter: 60 mm, "
        f"thickness: 3 mm}}, material: {METALS[0]}}}\n"
        "  - joint: {axis: y, stiffness: 30 kN*m/rad, mass: 2 kg}\n    link: {length: 300 mm, section: {shape: tube, "
        f"diameter: 50 mm, thickness: 3 mm}}, material: {METALS[0]}}}\n"
        "payload: {mass: 5 kg, force: [20 N, -30 N, 10 N]}\nleave_out: [shear_deformation]\n"
    )
    problem = problem_of(text, "subject_to: {mass: '<= 9 kg'}\n")
    q = grid((-90.0, 90.0), (-90.0, 90.0), each=9)
    joints = (Joint(compliance=1.0 / 50e3), Joint((0.0, 1.0, 0.0), 1.0 / 30e3, 2.0))
    links = tuple(
        Link(length, tube(d, 3e-3), metal(METALS[0])) for length, d in zip(LENGTHS, (0.06, 0.05), strict=True)
    )
    moved = Chain(joints, links, (0.0, 0.0, -9.81)).moved(q, Load(5.0, (20.0, -30.0, 10.0)))
    errors = errors_at(problem.arm, (), q)
    apart = max(
        float(np.linalg.norm(np.array(own.vector) - by_hand)) for own, by_hand in zip(errors, moved.shift, strict=True)
    )
    note = f"{len(q)} poses of an arm in space, as vectors; the greatest difference over the greatest error"
    most = float(np.linalg.norm(moved.shift, axis=1).max())
    return off("`evaluate --pose`", most + apart, most, note)


def _flanged(d: float, name: str) -> Chain:
    arm = rods(d, name)
    return replace(arm, links=(replace(arm.links[0], flange=_FLANGE), arm.links[1]))


def _housed(d: float, name: str) -> Chain:
    arm = rods(d, name)
    housing = replace(arm.links[0], compliance=_GIVE, mass_and_centre=(3.0, 0.12))
    return replace(arm, links=(housing, arm.links[1]))


def flanges() -> Asked:
    """A flange at the first link's end."""
    own = "section: {shape: circle, diameter: 50 mm}, material: aluminium-6061-t6"
    flange = ", flange: {tilting_stiffness: 20 kN*m/rad, torsional_stiffness: 50 kN*m/rad, mass: 0.5 kg}"
    arm = Plane(links=(own + flange, own)).text
    return lightest_rods("`flange`", _LIMIT, lambda d, name: worst(_flanged(d, name), _TWO_KG), 0.9e-3, arm)


def housings() -> Asked:
    """A first link by its stiffness matrix."""
    stiffness = np.linalg.inv(np.array(_GIVE))
    scale = np.array([1.0, 1.0, 1.0, 1e3, 1e3, 1e3])
    matrix = stiffness * scale[:, None] / np.array([1e3, 1e3, 1e3, 1.0, 1.0, 1.0])
    rows = ", ".join("[" + ", ".join(f"{x:.12g}" for x in row) + "]" for row in matrix.tolist())
    arm = Plane(links=(f"stiffness: [{rows}], mass: 3 kg, center_of_mass: 120 mm", "")).text

    def mass(d: float, name: str) -> float:
        return 3.0 + rods(d, name).links[1].mass

    limit = "max_error: '<= 0.5 mm'"
    what = "`link: {stiffness}`, a housing"
    return lightest_rods(what, limit, lambda d, name: worst(_housed(d, name), _TWO_KG), 0.5e-3, arm, mass=mass)


_SPAN, _TRAVEL = 0.9, 0.7


@dataclass(frozen=True)
class _Beam:
    """A beam held at both ends: rigidities E I (N*m^2) and G A_s (N), weight (N/m)."""

    flexural: float
    shear: float
    weight: float
    clamped: bool

    def moved(self, at: float, force: float, moment: float, weight: float) -> tuple[float, float]:
        """How it moves (m) and turns (rad) at a place under a load there and a weight (N/m): two elements, exact at
        their common node (J. S. Przemieniecki, Theory of Matrix Structural Analysis, 1968, 5.6)."""
        whole, loads = np.zeros((6, 6)), np.zeros(6)
        for first, part in ((0, at), (2, _SPAN - at)):
            phi = 12.0 * self.flexural / (self.shear * part**2)
            six, four, two = 6.0 * part, (4.0 + phi) * part**2, (2.0 - phi) * part**2
            element = [
                [12.0, six, -12.0, six],
                [six, four, -six, two],
                [-12.0, -six, 12.0, -six],
                [six, two, -six, four],
            ]
            span = slice(first, first + 4)
            whole[span, span] += self.flexural / (part**3 * (1.0 + phi)) * np.array(element)
            loads[span] += weight * np.array([part / 2.0, part**2 / 12.0, part / 2.0, -(part**2) / 12.0])
        loads[2:4] += [force, moment]
        free = [2, 3] if self.clamped else [1, 2, 3, 5]
        moved = np.linalg.solve(whole[np.ix_(free, free)], loads[free])
        return float(moved[free.index(2)]), float(moved[free.index(3)])


def _aluminium_beam(*, clamped: bool) -> _Beam:
    aluminium, section = metal(METALS[0]), build("rectangular_tube", {"width": 0.06, "height": 0.08, "thickness": 3e-3})
    area, second = 0.06 * 0.08 - 0.054 * 0.074, (0.06 * 0.08**3 - 0.054 * 0.074**3) / 12.0
    shear = aluminium.shear * float(section.properties(0.33).shear_area_z)
    return _Beam(aluminium.modulus * second, shear, 9.81 * aluminium.density * area, clamped)


def _on_beam(d: float, name: str, *, clamped: bool, rails: int) -> float:
    """The worst error of a rod on a carriage that runs along a beam of aluminium, 60 x 80 x 3 mm."""
    beam, begins = _aluminium_beam(clamped=clamped), 0.5 * (_SPAN - _TRAVEL)
    rod = Link(0.4, tube(d, 0.5 * d), metal(name))
    arm = Chain((Joint(compliance=1.0 / STIFFNESS, mass=1.0),), (rod,))
    angle = np.radians(np.linspace(-60.0, 80.0, 41))
    moved, tip = arm.moved(angle[:, None], _TWO_KG), arm.tips(angle[:, None]) + np.array([0.1, 0.0, 0.0])
    felt = -9.81 * (4.0 + 1.0 + 1.0 + rod.mass + 2.0)
    moment = -9.81 * (0.05 * 1.0 + 0.1 * 1.0 + (0.1 + 0.2 * np.cos(angle)) * rod.mass + tip[:, 0] * 2.0)
    worst_of_all = 0.0
    for place in np.linspace(0.0, _TRAVEL, 141):
        unit = [beam.moved(begins + place, *load, 0.0) for load in ((1.0, 0.0), (0.0, 1.0))]
        own = beam.moved(begins + place, 0.0, 0.0, -beam.weight)
        sunk = own[0] + (felt * unit[0][0] + moment * unit[1][0]) / rails
        turned = own[1] + (felt * unit[0][1] + moment * unit[1][1]) / rails
        x = moved.shift[:, 0] - turned * tip[:, 1]
        y = moved.shift[:, 1] + sunk + turned * tip[:, 0]
        worst_of_all = max(worst_of_all, float(np.hypot(x, y).max()))
    return worst_of_all


def supported() -> Iterator[Asked]:
    """A slide on a beam that is held at both ends."""
    for supports, rails in (("simple", 1), ("clamped", 1), ("simple", 2)):
        beam = (
            "{length: 900 mm, section: {shape: rectangular_tube, width: 60 mm, height: 80 mm, thickness: 3 mm}, "
            f"material: {METALS[0]}, supports: {supports}, rails: {rails}}}"
        )
        arm = (
            f"chain:\n  - joint: {{type: slide, range: [0 mm, 700 mm], mass: 4 kg, beam: {beam}}}\n"
            "    link: {length: 100 mm, rigid: true, mass: 1 kg}\n"
            "  - joint: {range: [-60 deg, 80 deg], stiffness: 60 kN*m/rad, mass: 1 kg}\n"
            f"    link: {{length: 400 mm, section: {{shape: circle, diameter: 40 mm}}, material: {METALS[0]}}}\n"
            "payload: {mass: 2 kg}\nleave_out: [shear_deformation]\n"
        )
        limit = 0.2e-3 if supports == "clamped" else 0.25e-3

        def figure(d: float, name: str, supports: str = supports, rails: int = rails) -> float:
            return _on_beam(d, name, clamped=supports == "clamped", rails=rails)

        def mass(d: float, name: str) -> float:
            return 1.0 + 0.4 * math.pi * d**2 / 4.0 * metal(name).density

        what = f"`beam`, {supports}, {rails} rail{'s' if rails > 1 else ''}"
        yield lightest_rods(what, f"max_error: '<= {1e3 * limit:g} mm'", figure, limit, arm, mass=mass)


def open_sections() -> Iterator[Row]:
    """What a cantilever of an open section errs at its end, load and weight at its centroid: bent, and twisted about
    its shear centre, warping held at the joint, free at the end (V. Z. Vlasov, Thin-Walled Elastic Beams, 1961)."""
    walls = {"flange_thickness": 4e-3, "web_thickness": 4e-3}
    for shape in ("channel", "i_section"):
        sizes = {"width": 0.05, "height": 0.06, **walls}
        written = ", ".join(f"{name}: {1e3 * value:g} mm" for name, value in sizes.items())
        arm = (
            "chain:\n  - joint: {range: [-1e-6 deg, 1e-6 deg]}\n"
            f"    link: {{length: 500 mm, section: {{shape: {shape}, {written}}}, material: {METALS[0]}}}\n"
            "payload: {mass: 20 kg}\nleave_out: [shear_deformation]\n"
        )
        problem = problem_of(arm, "subject_to: {mass: '<= 9 kg'}\n")
        value = evaluate(problem.arm, problem.workspace, problem.load_cases).max_error
        yield off(f"shear centre: error of a {shape}", value, _twisted(build(shape, sizes).properties(0.33)), "by hand")


def _twisted(section: SectionProperties) -> float:
    material, length, eccentric = metal(METALS[0]), 0.5, abs(float(section.shear_centre_y))
    load, weight = 9.81 * 20.0, 9.81 * material.density * float(section.area)
    flexural = material.modulus * float(section.second_moment_y)
    sag = load * length**3 / (3.0 * flexural) + weight * length**4 / (8.0 * flexural)
    rigidity = material.shear * float(section.torsion_constant)
    k = math.sqrt(rigidity / (material.modulus * float(section.warping_constant)))
    # G J t - E C_w t'' = T for the twist per length t, none at the joint and even at the end.
    first = -eccentric * (load + weight * length) / rigidity
    second = (eccentric * weight / (rigidity * k) - first * math.sinh(k * length)) / math.cosh(k * length)
    twist = eccentric * (load * length + weight * length**2 / 2.0) / rigidity
    twist += first * math.sinh(k * length) / k + second * (math.cosh(k * length) - 1.0) / k
    return sag + eccentric * twist


def short_tubes() -> Asked:
    """The lightest short tube that bears a load of 2 t with a factor of 2: shear at the neutral axis (J. M. Gere and
    B. J. Goodno, Mechanics of Materials), bending at the outer fibre."""
    material = "{elastic_modulus: 70 GPa, poisson_ratio: 0.3, density: 2700 kg/m^3, yield_strength: 240 MPa}"
    section = "{shape: tube, diameter: 80 mm, thickness: 5 mm}"
    arm = (
        f"chain:\n  - joint: {{range: [0 deg, 1e-6 deg]}}\n    link: {{length: 60 mm, section: {section}, "
        f"material: {material}}}\npayload: {{mass: 2000 kg}}\n"
    )
    text = (
        "minimize: mass\nsubject_to: {safety_factor: '>= 2', section_size: [20 mm, 120 mm], thickness: [1 mm, 10 mm], "
        "local_buckling: off}\n"
    )

    def factor(diameter: float, wall: float) -> float:
        outer, inner = 0.5 * diameter, 0.5 * diameter - wall
        area = math.pi * (outer**2 - inner**2)
        weight = 9.81 * 2700.0 * area
        force, moment = 2000 * 9.81 + weight * 0.06, 2000 * 9.81 * 0.06 + weight * 0.06**2 / 2.0
        shear = force * 4 / 3 * (outer**2 + outer * inner + inner**2) / (outer**2 + inner**2) / area
        bending = moment * outer / (math.pi * (outer**4 - inner**4) / 4.0)
        return 240e6 / max(math.sqrt(3.0) * shear, bending)

    def best() -> float:
        masses: list[float] = []
        for diameter in np.linspace(0.06, 0.12, 1201).tolist():
            if factor(diameter, 1e-3) < 2.0 < factor(diameter, 1e-2):
                wall = brentq(lambda t, d=diameter: factor(d, t) - 2.0, 1e-3, 1e-2)
                masses.append(2700.0 * 0.06 * math.pi * wall * (diameter - wall))
        return min(masses)

    return Asked("`safety_factor` of a short tube", arm, text, best, "1,201 diameters, each with its least wall")


_PERIOD = 0.8


def _cycle(count: int = 400) -> tuple[str, Array, Array, Array, Array]:
    """A cycle of two joints: the table, times, coordinates, rates, accelerations."""
    rate, time = 2.0 * math.pi / _PERIOD, np.linspace(0.0, _PERIOD, count + 1)
    swings = ((0.2, 0.6, 0.0), (-0.7, 0.8, 0.7))
    q, v, a = (
        np.stack([m * (k == 0) + f * s * np.real(1j**k * np.exp(1j * (rate * time + p))) for m, s, p in swings], axis=1)
        for k, f in enumerate((1.0, rate, rate**2))
    )
    lines = [", ".join(f"{x:.12g}" for x in (t, *np.degrees(row))) for t, row in zip(time, q, strict=True)]
    return "\n".join(["time_s, q1_deg, q2_deg", *lines]) + "\n", time, q, v, a


def _in_mujoco(diameter: float, q: Array, v: Array, a: Array) -> Array:
    """What a cycle takes of the drives (N, 2): rods of aluminium and a ball of 2 kg of steel as MuJoCo has them."""
    density, bodies = metal(METALS[0]).density, ""
    for number, (length, at) in enumerate(zip(LENGTHS, (0.0, LENGTHS[0]), strict=True)):
        mass = density * math.pi * diameter**2 / 4.0 * length
        thin, thick = mass * diameter**2 / 8.0, mass * (length**2 / 12.0 + diameter**2 / 16.0)
        bodies += f'<body pos="{at} 0 0"><joint type="hinge" axis="0 0 1"/>{_body(0.5 * length, mass, thin, thick)}'
        bodies += "" if number else f'<body pos="{length} 0 0">{_body(0.0, 1.0, 1e-9, 1e-9)}</body>'
    ball = 0.4 * 2.0 * (3.0 * 2.0 / (4.0 * math.pi * 7850.0)) ** (2.0 / 3.0)
    bodies += f'<body pos="{LENGTHS[1]} 0 0">{_body(0.0, 2.0, ball, ball)}</body></body></body>'
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="0 -9.81 0"/><worldbody>{bodies}</worldbody></mujoco>'
    )
    data, torques = mujoco.MjData(model), list[Array]()
    for data.qpos, data.qvel, data.qacc in zip(q, v, a, strict=True):
        mujoco.mj_inverse(model, data)
        torques.append(data.qfrc_inverse.copy())
    return np.array(torques)


def _body(at: float, mass: float, thin: float, thick: float) -> str:
    return f'<inertial pos="{at} 0 0" mass="{mass!r}" diaginertia="{thin!r} {thick!r} {thick!r}"/>'


def cycles() -> Iterator[Row]:
    """The thickest rods that a cycle lets drives move."""
    table, time, q, v, a = _cycle()
    rigid = Plane().text.replace("stiffness: 60 kN*m/rad, ", "")
    for figure, most in (("rms_torque", 60.0), ("peak_torque", 100.0)):
        text = (
            "minimize: max_error\nload_cases: [{payload: {mass: 2 kg}}, {motion: cycle.csv, payload: {mass: 2 kg}}]\n"
            f"subject_to: {{{figure}: '<= {most:g} N*m', {RODS}}}\nchoose: {{section: [circle], same: [size]}}\n"
        )

        def beyond(d: float, figure: str = figure, most: float = most) -> float:
            torque = _in_mujoco(d, q, v, a)
            rms = np.sqrt(np.trapezoid(torque**2, time, axis=0) / _PERIOD)
            return float((np.abs(torque) if figure == "peak_torque" else rms).max()) - most

        section = optimise(problem_of(rigid, text, {"cycle.csv": table})).arm.links[0].section
        assert section is not None
        chosen = float(section.properties(0.3).height)
        note = f"{1e3 * chosen:.4g} mm, the diameter that is left; torques by MuJoCo"
        yield off(f"`motion: cycle.csv` and `{figure}`", chosen, brentq(beyond, 0.012, 0.12), note)


def settling() -> Row:
    """How long a rod without mass on one drive that gives and damps swings after a stop: ln(A / x) over zeta omega, the
    amplitude A from the inertial load at the stop (W. T. Thomson, Theory of Vibration)."""
    drive = JointOfArm(range=(-1.0, 1.0), stiffness=20e3)
    slow = EffectEntry("joint_compliance", (), {"compliance": 0.0, "retardation": 6e-3})
    arm = Arm("swing", (drive,), (LinkOfArm(0.4, mass=0.0),), gravity=(0.0, 0.0, 0.0), effects=(slow,))
    _, _, q, _, a = _cycle()
    value = settled(swung(arm, beams_of(arm), 3.0, q[:, :1], a[:, :1]), 2e-5).max()
    omega = math.sqrt(20e3 / (3.0 * 0.4**2))
    zeta = 0.5 * omega * 6e-3
    size = float(np.abs(a[:, 0]).max()) * 0.4 / omega**2 / math.sqrt(1.0 - zeta**2)
    return off("`settling_time`", float(value), math.log(size / 2e-5) / (zeta * omega), "one mode, in closed form")


def rows() -> list[Row]:
    """All of them."""
    asked = (flanges(), housings(), *supported(), short_tubes())
    return [at_a_pose(), *(item.row() for item in asked), *open_sections(), *cycles(), settling()]
