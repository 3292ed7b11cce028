"""Arms of the first look's table: their files, tips and torques, by rotation matrices and Newton's and Euler's
equations written here, which share nothing with the code that is judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
AXES = {"x": np.array([1.0, 0.0, 0.0]), "y": np.array([0.0, 1.0, 0.0]), "z": np.array([0.0, 0.0, 1.0])}


@dataclass(frozen=True)
class Machine:
    """Axes of the joints by letter, links (n, 3), m, their masses (n,), kg, centres along them (n,), 0 to 1, moments of
    inertia (n,), kg m^2, about any axis, and gravity (3,), m/s^2."""

    axes: str
    links: Array
    masses: Array
    centres: Array
    inertias: Array
    gravity: Array

    @property
    def size(self) -> int:
        """The number of joints."""
        return len(self.axes)

    def file(self, factors: Array | None = None, effort: Array | None = None, *, weighs: bool = True) -> str:
        """The arm file, its masses `factors` (n,) times the true ones."""
        by = np.ones(self.size) if factors is None else factors
        lines = ["name: trial", f"gravity: [{', '.join(f'{item:.6g} m/s^2' for item in self.gravity)}]", "chain:"]
        for k, axis in enumerate(self.axes):
            length = float(np.linalg.norm(self.links[k]))
            effort_text = "" if effort is None else f", effort: {effort[k]:.5g} N*m"
            lines.append(f"  - joint: {{type: revolute, axis: {axis}, range: [-178 deg, 178 deg]{effort_text}}}")
            direction = ", ".join(f"{item:.9g}" for item in self.links[k] / length)
            link = f"    link: {{length: {1e3 * length:.7g} mm, direction: [{direction}], rigid: true"
            if weighs:
                inertia = f"{by[k] * self.inertias[k]:.7g} kg*m^2"
                link += f", mass: {by[k] * self.masses[k]:.7g} kg, center_of_mass: "
                link += f"{1e3 * length * self.centres[k]:.7g} mm"
                link += f", inertia: {{xx: {inertia}, yy: {inertia}, zz: {inertia}}}"
            else:
                link += ", mass: 0 kg"
            lines.append(link + "}")
        return "\n".join(lines) + "\n"

    def frames(self, q: Array, links: Array | None = None) -> tuple[Array, Array, Array]:
        """Axes (N, n, 3), origins (N, n + 1, 3), m, and rotations (N, n, 3, 3) of the joints in the base frame."""
        links = self.links if links is None else links
        count = len(q)
        turn, place = np.broadcast_to(np.eye(3), (count, 3, 3)), np.zeros((count, 3))
        axes, origins, turns = [], [place], []
        for k, letter in enumerate(self.axes):
            axes.append(turn @ AXES[letter])
            turn = turn @ about(AXES[letter], q[:, k])
            turns.append(turn)
            place = place + turn @ links[k]
            origins.append(place)
        return np.stack(axes, axis=1), np.stack(origins, axis=1), np.stack(turns, axis=1)

    def tip(self, q: Array, links: Array | None = None) -> Array:
        """Tips (N, 3), m."""
        return self.frames(q, links)[1][:, -1]

    def torques(self, q: Array, v: Array, a: Array) -> Array:
        """Torques (N, n), N*m, of a motion without friction."""
        axes, origins, turns = self.frames(q)
        count = len(q)
        spin: Array
        turning: Array
        push: Array
        spin, turning, push = np.zeros((count, 3)), np.zeros((count, 3)), np.broadcast_to(-self.gravity, (count, 3))
        forces, moments, centres = [], [], []
        for k in range(self.size):
            turned = np.asarray(np.cross(spin, axes[:, k] * v[:, k : k + 1]), dtype=np.float64)
            turning = turning + axes[:, k] * a[:, k : k + 1] + turned
            spin = spin + axes[:, k] * v[:, k : k + 1]
            out = turns[:, k] @ self.links[k]
            centre = self.centres[k] * out
            forces.append(self.masses[k] * _pushed(push, spin, turning, centre))
            moments.append(self.inertias[k] * turning)
            centres.append(origins[:, k] + centre)
            push = _pushed(push, spin, turning, out)
        torque = np.zeros((count, self.size))
        for k in range(self.size):
            moment = np.zeros((count, 3))
            for j in range(k, self.size):
                moment = moment + moments[j] + np.cross(centres[j] - origins[:, k], forces[j])
            torque[:, k] = np.sum(axes[:, k] * moment, axis=1)
        return torque

    def weights(self, q: Array) -> Array:
        """Torques (N, n), N*m, that hold the arm at rest."""
        return self.torques(q, np.zeros_like(q), np.zeros_like(q))


def _pushed(push: Array, spin: Array, turning: Array, arm: Array) -> Array:
    """The acceleration (N, 3) at the end of an arm (N, 3) of a body."""
    return np.asarray(push + np.cross(turning, arm) + np.cross(spin, np.cross(spin, arm)), dtype=np.float64)


def about(axis: Array, angle: Array) -> Array:
    """Rotations (N, 3, 3) about an axis (3,) by angles (N,), rad (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + sine * cross + (1.0 - cosine) * (cross @ cross)


def machine(kind: str, rng: np.random.Generator) -> Machine:
    """A machine of a kind: a desktop arm of four joints, a cobot of six, a plane arm of two or three."""
    if kind == "plane":
        size = int(rng.integers(2, 4))
        axes, lengths = "z" * size, rng.uniform(0.15, 0.5, size)
        directions, gravity = np.tile(AXES["x"], (size, 1)), np.array([0.0, -9.81, 0.0])
    elif kind == "desktop":
        axes, lengths = "zyyy", rng.uniform([0.08, 0.12, 0.1, 0.06], [0.15, 0.25, 0.2, 0.1])
        directions, gravity = np.stack([AXES[each] for each in "zzxx"]), np.array([0.0, 0.0, -9.81])
    else:
        lengths = rng.uniform([0.2, 0.35, 0.3, 0.1, 0.08, 0.06], [0.4, 0.6, 0.5, 0.15, 0.12, 0.1])
        axes, directions = "zyyxyx", np.stack([AXES[each] for each in "zzxxxx"])
        gravity = np.array([0.0, 0.0, -9.81])
    heavy = {"plane": 4.0, "desktop": 0.4, "cobot": 6.0}[kind]
    size = len(axes)
    masses = heavy * rng.uniform(0.6, 1.2, size) * np.linspace(1.0, 0.35, size)
    links = directions * lengths[:, None]
    inertias = masses * lengths**2 / 12.0
    return Machine(axes, links, masses, rng.uniform(0.35, 0.6, size), inertias, gravity)
