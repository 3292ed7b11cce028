"""A chain of beams and springs by hand: what its tip moves and turns by, with none of the code under test.

Each link is a cantilever in both planes (W. C. Young and R. G. Budynas, Roark's Formulas for Stress and Strain, 7th
ed., table 8.1, cases 1a, 2a and 3a), twists by T L / G J and stretches by N L / E A; joints turn by torque over
stiffness, and every turn carries all that is beyond it. Shear is left out, as the arms of these questions leave it out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from linkwright.core.sections.numeric import Array

GRAVITY = 9.81
DOWN = (0.0, -GRAVITY, 0.0)


@dataclass(frozen=True)
class Metal:
    """A material: elastic modulus and shear modulus (Pa), density (kg/m^3), thermal expansion (1/K)."""

    modulus: float
    shear: float
    density: float
    expansion: float = 0.0


@dataclass(frozen=True)
class Section:
    """Area (m^2), second moments (m^4) against bending in the plane of the height and of the width, J (m^4)."""

    area: float
    upright: float
    sideways: float
    torsion: float


def tube(diameter: float, wall: float) -> Section:
    """A round tube; a rod where its wall is half the diameter."""
    inner = diameter - 2.0 * wall
    second = math.pi * (diameter**4 - inner**4) / 64.0
    return Section(math.pi * (diameter**2 - inner**2) / 4.0, second, second, 2.0 * second)


def box(width: float, height: float, wall: float) -> Section:
    """A rectangular tube, thin-walled in torsion (R. Bredt, 1896)."""
    inner_width, inner_height = width - 2.0 * wall, height - 2.0 * wall
    middle = (width - wall, height - wall)
    return Section(
        width * height - inner_width * inner_height,
        (width * height**3 - inner_width * inner_height**3) / 12.0,
        (height * width**3 - inner_height * inner_width**3) / 12.0,
        2.0 * wall * (middle[0] * middle[1]) ** 2 / (middle[0] + middle[1]),
    )


@dataclass(frozen=True)
class Link:
    """A link along its own x axis. `compliance` (6 x 6: m and rad by N and N*m, along and about its axes) replaces its
    bending; then its `mass` hangs at `centre` (m). A `flange` at its far end gives under moments across and along the
    link (rad/(N*m)) and has a mass."""

    length: float
    section: Section
    metal: Metal
    flange: tuple[float, float, float] = (0.0, 0.0, 0.0)
    compliance: tuple[tuple[float, ...], ...] | None = None
    mass_and_centre: tuple[float, float] | None = None

    @property
    def mass(self) -> float:
        """Its mass with its flange, kg."""
        own = self.metal.density * self.section.area * self.length
        return (own if self.mass_and_centre is None else self.mass_and_centre[0]) + self.flange[2]


@dataclass(frozen=True)
class Joint:
    """A joint that turns about `axis` of the link before: compliance (rad/(N*m)), mass (kg), total backlash (rad)."""

    axis: tuple[float, float, float] = (0.0, 0.0, 1.0)
    compliance: float = 0.0
    mass: float = 0.0
    backlash: float = 0.0


@dataclass(frozen=True)
class Load:
    """What is at the tip: kg and N."""

    mass: float = 0.0
    force: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Moved:
    """At N poses: how the tip moves (N, 3) m and turns (N, 3) rad, the same by half of each backlash (K arrays), and
    the torque of each drive (N, n)."""

    shift: Array
    turn: Array
    lost: tuple[tuple[Array, Array], ...]
    torque: Array

    def worst(self, *, of_turn: bool = False, along: Sequence[float] | None = None, lost_alone: bool = False) -> float:
        """The greatest over all poses and sides of the backlash: of the length, or along a direction."""
        first = self.turn if of_turn else self.shift
        parts = [pair[1] if of_turn else pair[0] for pair in self.lost]
        start = np.zeros_like(first) if lost_alone else first
        greatest = 0.0
        for sides in itertools.product((-1.0, 1.0), repeat=len(parts)):
            vector = start + sum((side * part for side, part in zip(sides, parts, strict=True)), np.zeros_like(first))
            sizes = np.linalg.norm(vector, axis=1) if along is None else np.abs(vector @ np.array(along))
            greatest = max(greatest, float(sizes.max()))
        return greatest


@dataclass(frozen=True)
class Chain:
    """An arm; `gravity` (m/s^2) is what its masses feel, `warmer` (K) by how much its links are warm."""

    joints: tuple[Joint, ...]
    links: tuple[Link, ...]
    gravity: tuple[float, float, float] = DOWN
    warmer: float = 0.0
    longer: tuple[float, ...] = field(default=())

    @property
    def mass(self) -> float:
        """The links' mass, kg."""
        return sum(link.mass for link in self.links)

    def frames(self, q: Array) -> tuple[list[Array], list[Array]]:
        """The joints' axes (N, 3) and the links' axes as columns (N, 3, 3) at poses q (N, n)."""
        turned = np.tile(np.eye(3), (len(q), 1, 1))
        axes: list[Array] = []
        frames: list[Array] = []
        for k, joint in enumerate(self.joints):
            axes.append(turned @ np.array(joint.axis))
            turned = turned @ _about(joint.axis, q[:, k])
            frames.append(turned)
        return axes, frames

    def tips(self, q: Array) -> Array:
        """The tips (N, 3) at poses q (N, n), m."""
        _, frames = self.frames(q)
        return np.sum([frame[:, :, 0] * link.length for frame, link in zip(frames, self.links, strict=True)], axis=0)

    def moved(self, q: Array, load: Load) -> Moved:
        """What the loads do to the tip at poses q (N, n)."""
        count, felt = len(q), np.array(self.gravity)
        axes, frames = self.frames(q)
        end, shift, turn, moment = (np.zeros((count, 3)) for _ in range(4))
        force = np.tile(np.array(load.force) + load.mass * felt, (count, 1))
        lost: list[tuple[Array, Array]] = []
        torques: list[Array] = []
        for k in reversed(range(len(self.links))):
            link, joint, frame = self.links[k], self.joints[k], frames[k]
            force = force + link.flange[2] * felt
            own = np.einsum("nij,ni->nj", frame, moment)
            across, along, _ = link.flange
            flexed = np.einsum("nij,nj->ni", frame, own * np.array([along, across, across]))
            more_longer = self.longer[k] if self.longer else 0.0
            moves, turns = self._link(link, frame, force, moment, more_longer)
            step = link.length * frame[:, :, 0]
            turned = flexed + turns
            shift, turn = shift + moves + np.cross(turned, end), turn + turned
            weight, centre = self._weight(link)
            moment = moment + np.cross(step, force) + np.cross(centre * frame[:, :, 0], weight * felt)
            force, end = force + weight * felt, end + step
            torques.append(np.einsum("ni,ni->n", axes[k], moment))
            turned = axes[k] * (joint.compliance * torques[-1])[:, None]
            shift, turn = shift + np.cross(turned, end), turn + turned
            if joint.backlash:
                half = 0.5 * joint.backlash * axes[k]
                lost.append((np.cross(half, end), half))
            force = force + joint.mass * felt
        return Moved(shift, turn, tuple(lost), np.stack(torques[::-1], axis=1))

    def _weight(self, link: Link) -> tuple[float, float]:
        own = link.metal.density * link.section.area * link.length
        return (own, 0.5 * link.length) if link.mass_and_centre is None else link.mass_and_centre

    def _link(self, link: Link, frame: Array, force: Array, moment: Array, longer: float) -> tuple[Array, Array]:
        """How a link's end moves and turns, in the base frame."""
        f, m = (np.einsum("nij,ni->nj", frame, vector) for vector in (force, moment))
        if link.compliance is not None:
            both = np.hstack([f, m]) @ np.array(link.compliance).T
            moves, turns = both[:, :3], both[:, 3:]
        else:
            moves, turns = self._cantilever(link, frame, f, m)
            moves[:, 0] += link.metal.expansion * link.length * self.warmer + longer
        return np.einsum("nij,nj->ni", frame, moves), np.einsum("nij,nj->ni", frame, turns)

    def _cantilever(self, link: Link, frame: Array, f: Array, m: Array) -> tuple[Array, Array]:
        length, section, metal = link.length, link.section, link.metal
        w = np.einsum("nij,i->nj", frame, metal.density * section.area * np.array(self.gravity))
        upright, sideways = metal.modulus * section.upright, metal.modulus * section.sideways
        moves, turns = np.zeros_like(f), np.zeros_like(f)
        moves[:, 0] = (f[:, 0] * length + w[:, 0] * length**2 / 2.0) / (metal.modulus * section.area)
        moves[:, 1] = (f[:, 1] * length**3 / 3.0 + m[:, 2] * length**2 / 2.0 + w[:, 1] * length**4 / 8.0) / upright
        turns[:, 2] = (f[:, 1] * length**2 / 2.0 + m[:, 2] * length + w[:, 1] * length**3 / 6.0) / upright
        moves[:, 2] = (f[:, 2] * length**3 / 3.0 - m[:, 1] * length**2 / 2.0 + w[:, 2] * length**4 / 8.0) / sideways
        turns[:, 1] = -(f[:, 2] * length**2 / 2.0 - m[:, 1] * length + w[:, 2] * length**3 / 6.0) / sideways
        turns[:, 0] = m[:, 0] * length / (metal.shear * section.torsion)
        return moves, turns

    def compliance(self, q: Array) -> Array:
        """How the tip moves under 1 N along each axis (columns) at poses q (N, n): (N, 3, 3) m/N."""
        bare = replace(self, gravity=(0.0, 0.0, 0.0), warmer=0.0, longer=())
        columns = [bare.moved(q, Load(force=(float(k == 0), float(k == 1), float(k == 2)))).shift for k in range(3)]
        return np.stack(columns, axis=2)


def _about(axis: Sequence[float], angle: Array) -> Array:
    """Rotations (N, 3, 3) about a unit vector (Rodrigues)."""
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, cosine = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + sine * skew + (1.0 - cosine) * (skew @ skew)


def grid(*ranges: tuple[float, float], each: int = 61) -> Array:
    """Poses (N, n) all over ranges (degrees), their ends among them."""
    axes = [np.radians(np.linspace(*span, each)) for span in ranges]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(ranges))
