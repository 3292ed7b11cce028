"""A planar arm by hand: what its tip errs by, where it reaches and what it weighs, with none of the code under test.

Each link is a cantilever in the plane (W. C. Young and R. G. Budynas, Roark's Formulas for Stress and Strain, 7th ed.,
table 8.1, cases 1a, 2a and 3a): a force F and a moment M at its end and its weight w per length move the end by
F L^3/3EI + M L^2/2EI + w L^4/8EI across and by (N L + w L^2/2)/EA along itself and turn it by
F L^2/2EI + M L/EI + w L^3/6EI. Joints turn by torque over stiffness, growth lengthens links by alpha L dT, and every
turn carries all that is beyond it.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from linkwright.core.sections.numeric import Array

GRAVITY = 9.81


@dataclass(frozen=True)
class Stuff:
    """A material: elastic modulus (Pa), density (kg/m^3), thermal expansion (1/K)."""

    modulus: float
    density: float
    expansion: float


@dataclass(frozen=True)
class Planar:
    """An arm: a value per link or joint. Lengths, outer diameters and walls (m; a wall of half the diameter is a solid
    rod), materials, joint masses (kg), stiffnesses (N m/rad), total backlash (rad), ranges (rad); how much warmer (K)
    it is than 20 degC, as far as growth counts."""

    lengths: tuple[float, ...]
    diameters: tuple[float, ...]
    walls: tuple[float, ...]
    stuffs: tuple[Stuff, ...]
    joints: tuple[float, ...]
    stiffnesses: tuple[float, ...]
    backlash: tuple[float, ...]
    ranges: tuple[tuple[float, float], ...]
    warmer: float

    def _sections(self) -> tuple[list[float], list[float]]:
        """Areas (m^2) and second moments (m^4) of the links."""
        inner = [d - 2.0 * t for d, t in zip(self.diameters, self.walls, strict=True)]
        areas = [math.pi * (d**2 - i**2) / 4.0 for d, i in zip(self.diameters, inner, strict=True)]
        seconds = [math.pi * (d**4 - i**4) / 64.0 for d, i in zip(self.diameters, inner, strict=True)]
        return areas, seconds

    @property
    def mass(self) -> float:
        """The links' mass, kg."""
        areas = self._sections()[0]
        parts = zip(areas, self.lengths, self.stuffs, strict=True)
        return sum(area * length * item.density for area, length, item in parts)

    def tips(self, q: Array) -> Array:
        """The tips (N, 2) at poses (N, n), m."""
        angles = np.cumsum(q, axis=1)
        return np.stack([np.cos(angles) @ np.array(self.lengths), np.sin(angles) @ np.array(self.lengths)], axis=1)

    def worst(self, q: Array, loads: tuple[tuple[float, float, float], ...]) -> float:
        """The worst error (m) over poses (N, n) and loads: each a payload (kg) and a force on the tip (N, N)."""
        return max((float(self.errors(q, *load).max()) for load in loads), default=0.0) if len(q) else 0.0

    def errors(self, q: Array, payload: float, fx: float, fy: float) -> Array:
        """The error (m) at each pose, its play where the tip is farthest off."""
        angles = np.cumsum(q, axis=1)
        areas, seconds = self._sections()
        end = np.zeros((len(q), 2))
        moved, moment = np.zeros((len(q), 2)), np.zeros(len(q))
        force = np.tile([fx, fy - payload * GRAVITY], (len(q), 1))
        levers: list[Array] = []
        for k in reversed(range(len(self.lengths))):
            along = np.stack([np.cos(angles[:, k]), np.sin(angles[:, k])], axis=1)
            across = np.stack([-along[:, 1], along[:, 0]], axis=1)
            span, stuff = self.lengths[k], self.stuffs[k]
            stiff, long = stuff.modulus * seconds[k], stuff.modulus * areas[k]
            weight = np.array([0.0, -stuff.density * areas[k] * GRAVITY])
            f, n, w, a = (force * across).sum(1), (force * along).sum(1), across @ weight, along @ weight
            sag = (f * span**3 / 3.0 + moment * span**2 / 2.0 + w * span**4 / 8.0) / stiff
            slope = (f * span**2 / 2.0 + moment * span + w * span**3 / 6.0) / stiff
            stretch = (n * span + a * span**2 / 2.0) / long + stuff.expansion * span * self.warmer
            moved += sag[:, None] * across + stretch[:, None] * along + slope[:, None] * _turned(end)
            moment = moment + f * span + w * span**2 / 2.0
            force = force + weight * span
            end = end + span * along
            moved += (moment / self.stiffnesses[k])[:, None] * _turned(end)
            levers.append(0.5 * self.backlash[k] * _turned(end))
            force = force + np.array([0.0, -self.joints[k] * GRAVITY])
        sides = itertools.product((-1.0, 1.0), repeat=len(levers))
        played = (moved + sum(side * lever for side, lever in zip(item, levers, strict=True)) for item in sides)
        return np.max([np.hypot(*item.T) for item in played], axis=0)

    def poses_of(self, places: Array, turns: int) -> tuple[Array, Array]:
        """All poses (N, n) of two links, and of three with so many values of the last angle, that have their tip at
        one of the places (M, 2); and which places have one (M)."""
        first = self.lengths[0]
        last = np.zeros(1) if len(self.lengths) == 2 else np.linspace(*self.ranges[2], turns)
        # The links beyond the elbow are one, from it to the tip, which stands askew by what the last joint turns.
        rest = self.lengths[1] + (0.0 if len(self.lengths) == 2 else self.lengths[2]) * np.exp(1j * last)
        target = (places[:, 0] + 1j * places[:, 1])[:, None]
        second, askew = np.abs(rest)[None], np.angle(rest)[None]
        with np.errstate(invalid="ignore", divide="ignore"):
            cosine = (np.abs(target) ** 2 - first**2 - second**2) / (2.0 * first * second)
        bend = np.arccos(np.clip(cosine, -1.0, 1.0))
        results: list[Array] = []
        reached = np.zeros(len(places), dtype=bool)
        for side in (1.0, -1.0):
            elbow = side * bend
            shoulder = np.angle(target) - np.angle(first + second * np.exp(1j * elbow))
            each = [_within(shoulder, self.ranges[0]), _within(elbow - askew, self.ranges[1])]
            each += [] if len(self.lengths) == 2 else [np.broadcast_to(last[None], elbow.shape)]
            q = np.stack(each, axis=-1)
            limits = np.array(self.ranges)
            kept = np.all((q >= limits[:, 0] - 1e-12) & (q <= limits[:, 1] + 1e-12), axis=-1)
            kept &= np.abs(cosine) <= 1.0 + 1e-9
            results.append(q[kept])
            reached |= kept.any(axis=1)
        q = np.vstack(results)
        return q, reached

    def grid(self, each: int) -> Array:
        """Poses (N, n) all over the joint ranges, their ends among them."""
        sides = [np.linspace(*own, each) for own in self.ranges]
        return np.stack(np.meshgrid(*sides, indexing="ij"), axis=-1).reshape(-1, len(sides))


def _turned(vectors: Array) -> Array:
    return np.stack([-vectors[:, 1], vectors[:, 0]], axis=1)


def _within(angle: Array, span: tuple[float, float]) -> Array:
    """Angles by whole turns as near to the middle of a range as can be."""
    middle = 0.5 * (span[0] + span[1])
    return middle + (angle - middle + np.pi) % (2.0 * np.pi) - np.pi
