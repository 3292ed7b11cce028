"""A chain of elastic rods as one Cosserat rod, integrated along its length: an outside check of exact motion.

The rod shares no code with the project; `rods_of` takes an arm's figures over. Forces are dead, so the force in every
cut is known beforehand; the moment follows m' = -p' x n, the strains from force and moment in the rod's own axes, and
the unknown moment at the base is the one that leaves none at the tip (shooting). S. S. Antman, Nonlinear Problems of
Elasticity (Springer, 2005), chapter 8.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import root
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.vectors import Scalar
from linkwright.core.arm.errors.model import beams_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rod:
    """One link, SI: its joint's axis and what the drive gives (rad per N m), its rigidities along x (its own), y
    (height) and z (width), its mass per length, and the mass at its joint."""

    length: float
    axis: tuple[float, float, float]
    compliance: float
    axial: float
    shear_y: float
    shear_z: float
    torsion: float
    bend_y: float
    """Resists bending towards y, the height."""
    bend_z: float
    mass_per_length: float
    joint_mass: float


def _local_axes(axis: Array) -> Array:
    """Columns: along x, then the height (in the plane in which the joint turns the link), then the width."""
    along = np.array([1.0, 0.0, 0.0])
    height = np.cross(axis, along)
    if np.linalg.norm(height) < 1e-9:
        height = np.array([0.0, 1.0, 0.0])
    width = np.cross(along, height)
    return np.stack([along, height / np.linalg.norm(height), width / np.linalg.norm(width)], axis=1)


def rod_tip(rods: list[Rod], q: Array, gravity: Array, payload: float, force: Array) -> tuple[Array, Array]:
    """Where the tip is (m) and how it is turned, at joint angles q (rad)."""
    ahead = [force + payload * gravity]
    for rod in reversed(rods):
        ahead.append(ahead[-1] + rod.length * rod.mass_per_length * gravity)
        ahead.append(ahead[-1] + rod.joint_mass * gravity)
    ahead.reverse()  # at each joint with its mass, without it, and last at the tip

    def shot(base_moment: Array) -> tuple[Array, Array, Array]:
        place, frame, moment = np.zeros(3), np.eye(3), base_moment
        for number, rod in enumerate(rods):
            axis = np.array(rod.axis)
            world = frame @ axis
            frame = frame @ Rotation.from_rotvec(axis * (q[number] + rod.compliance * (world @ moment))).as_matrix()
            own = _local_axes(axis)
            start = ahead[2 * number + 1]

            def slope(s: float, y: Array, rod: Rod = rod, own: Array = own, start: Array = start) -> Array:
                turned: Array = y[3:12].reshape(3, 3)
                axes: Array = turned @ own
                n, m = axes.T @ (start - s * rod.mass_per_length * gravity), axes.T @ y[12:]
                strain = np.array([1.0 + n[0] / rod.axial, n[1] / rod.shear_y, n[2] / rod.shear_z])
                # A moment about the width bends towards the height.
                curvature = np.array([m[0] / rod.torsion, m[1] / rod.bend_z, m[2] / rod.bend_y])
                step, turn = axes @ strain, axes @ curvature
                across = np.array([[0, -turn[2], turn[1]], [turn[2], 0, -turn[0]], [-turn[1], turn[0], 0]])
                force_here = start - s * rod.mass_per_length * gravity
                return np.concatenate([step, (across @ turned).reshape(-1), -np.cross(step, force_here)])

            begun = np.concatenate([place, frame.reshape(-1), moment])
            solved: Any = solve_ivp(slope, (0.0, rod.length), begun, method="DOP853", rtol=1e-11, atol=1e-13)
            end: Array = solved.y[:, -1]
            place, frame, moment = end[:3], end[3:12].reshape(3, 3), end[12:]
        return place, frame, moment

    def left_at_tip(base_moment: Array) -> Array:
        return shot(base_moment)[2]

    result = root(left_at_tip, np.zeros(3), tol=1e-12)
    place, frame, left = shot(result.x)
    if np.linalg.norm(left) > 1e-7:
        raise ValueError("the rod's base moment was not found")
    return place, frame


def rods_of(arm: Arm) -> list[Rod]:
    """The rods of an arm that is what its file says."""

    def number(rigidity: Scalar | None) -> float:
        assert isinstance(rigidity, float), "the rod takes links that are uniform and elastic"
        return rigidity

    return [
        Rod(
            length=float(beam.length),
            axis=joint.axis,
            compliance=1.0 / (joint.stiffness or math.inf),
            axial=number(beam.axial_rigidity),
            shear_y=number(beam.shear_rigidity_height),
            shear_z=number(beam.shear_rigidity_width),
            torsion=number(beam.torsional_rigidity),
            bend_y=number(beam.flexural_rigidity_height),
            bend_z=number(beam.flexural_rigidity_width),
            mass_per_length=float(beam.mass_per_length),
            joint_mass=joint.mass,
        )
        for joint, beam in zip(arm.joints, beams_of(arm), strict=True)
    ]
