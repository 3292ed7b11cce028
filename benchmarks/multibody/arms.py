"""The arms of the second proof: slender ones that bend by millimetres, stiff ones, and one of seven axes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from benchmarks.blind.generator.arms import ALUMINIUM, JOINTS, STEEL, Family, Ranges, X
from benchmarks.blind.generator.beams import tube
from benchmarks.blind.generator.mechanics import Arm, Link
from benchmarks.blind.generator.vectors import Array
from benchmarks.multibody.engine import Machine, machine, settle

_SEVEN = ((0.34, 5.0), (0.2, 4.0), (0.2, 3.5), (0.2, 3.0), (0.2, 2.0), (0.1, 1.5), (0.16, 0.6))
_KINDS = {
    "slender_2r": Family("z z", ((0.7, 0.052), (0.55, 0.042)), (-1.4, -2.3), (1.4, 2.3)),
    "slender_3r": Family("z z z", ((0.7, 0.06), (0.55, 0.048), (0.3, 0.036)), (-1.5, -2.2, -2.2), (1.5, 2.2, 2.2)),
    "drives_3r": Family("z z z", ((0.85, 0.13), (0.7, 0.1), (0.3, 0.07)), (-1.7, -2.2, -2.2), (1.7, 2.2, 2.2)),
    "spatial_3r": Family(
        "z y y", ((0.4, 0.1), (0.65, 0.058), (0.5, 0.046)), (-2.5, -0.6, -2.2), (2.5, 1.7, 0.8), "z x x"
    ),
    "spatial_6r": Family(
        "z y y x y x",
        ((0.4, 0.14), (0.6, 0.08), (0.4, 0.07), (0.2, 3.0, 0.0), (0.1, 2.0, 0.0), (0.15, 1.0, 0.0)),
        (-2.5, -0.4, -1.8, -2.5, -1.8, -2.8),
        (2.5, 1.5, 0.6, 2.5, 1.8, 2.8),
        "z x x x x wrist",
    ),
    "seven_axes": Family(
        "z y z y z y z",
        tuple((length, mass, 0.0) for length, mass in _SEVEN),
        (-2.8, -1.9, -2.8, -1.9, -2.8, -1.9, -2.9),
        (2.8, 1.9, 2.8, 1.9, 2.8, 1.9, 2.9),
        "z z z z z z wrist",
    ),
}
FAMILIES = tuple(_KINDS)


def _bar(length: float, diameter: float, wall: float, material: tuple[float, ...], way: tuple[float, ...] = X) -> Link:
    e, nu, rho, alpha = material
    section = tube(diameter, wall, nu)
    return Link(length, (way[0], way[1], way[2]), rho * section.area, section, e, nu, rho, alpha, diameter)


def _body(length: float, mass: float, way: tuple[float, ...] = X) -> Link:
    return Link(length, (way[0], way[1], way[2]), mass / length, None, expansion=23e-6)


def draw_arm(family: str, rng: np.random.Generator) -> tuple[Arm, Ranges]:
    """An arm of the family and the ranges of its joints; links' sizes are whole tenths of a millimetre."""
    material = STEEL if rng.random() < 0.5 else ALUMINIUM

    def mm(value: float) -> float:
        return round(value * 1e4 * float(rng.uniform(0.9, 1.1))) / 1e4

    def bar(length: float, diameter: float, way: tuple[float, ...] = X) -> Link:
        return _bar(mm(length), mm(diameter), round(max(0.002, 0.04 * diameter), 4), material, way)

    kind = _KINDS[family]
    links = tuple(
        bar(length, rest[0], way) if len(rest) == 1 else _body(mm(length), rest[0], way)
        for (length, *rest), way in zip(kind.links, kind.along(), strict=True)
    )
    joints = tuple(JOINTS[name] for name in kind.joints.split())
    joints = tuple(replace(j, mass=round(float(rng.uniform(0.2, 2.0)), 1) if i else 0.0) for i, j in enumerate(joints))
    gravity = (0.0, -9.81, 0.0) if kind.planar else (0.0, 0.0, -9.81)
    payload = round(float(rng.uniform(1.0, 4.0)), 1)
    arm, ranges = Arm(family, family, joints, links, gravity, payload, kind.planar), Ranges(kind.low, kind.high)
    if family in ("slender_2r", "slender_3r"):
        return arm, ranges
    return _with_drives(arm, ranges, rng), ranges


def at_rest(body: Machine, q: Array, payload: float) -> tuple[Array, Array]:
    """Torques of the drives (n, m) and sags of the tip (m,) of the arm as its file has it, at joint angles (n, m)."""
    torque, sag = np.zeros_like(q), np.zeros(q.shape[1])
    gravity = np.array(body.arm.gravity)
    for k in range(q.shape[1]):
        angles = np.zeros(body.size)
        angles[list(body.drive)] = q[:, k]
        bent = settle(body, angles, body.compliance, payload * gravity)
        torque[:, k] = bent.load[list(body.drive)]
        rigid = settle(body, angles, np.zeros(body.size), payload * gravity)
        sag[k] = float(np.linalg.norm(bent.tip - rigid.tip))
    return torque, sag


def _with_drives(arm: Arm, ranges: Ranges, rng: np.random.Generator) -> Arm:
    """Drives that give 0.1 to 0.6 mrad under their greatest torque, as catalogue figures of three digits."""
    q = rng.uniform(np.array(ranges.low)[:, None], np.array(ranges.high)[:, None], (arm.count, 60))
    torque, _ = at_rest(machine(arm), q, arm.payload)
    joints = []
    for joint, most in zip(arm.joints, np.abs(torque).max(axis=1), strict=True):
        stiff = float(f"{max(float(most), 5.0) / float(rng.uniform(0.1e-3, 0.6e-3)):.2e}")
        joints.append(replace(joint, compliance=1.0 / stiff))
    return replace(arm, joints=tuple(joints))


def rounded_degrees(q: Array) -> Array:
    """Angles as a controller prints them, thousandths of a degree, in rad."""
    return np.asarray(np.round(np.degrees(q), 3) * (math.pi / 180.0), dtype=np.float64)
