"""Beams with seven degrees of freedom a node (three shifts, three turns, warping), to check torsion against.

Nothing of the project is used. Members are divided into short elements: Euler-Bernoulli bending in both planes about
principal axes, axial strain, and cubic Hermite twist with Saint-Venant's and Vlasov's energy (V. Z. Vlasov,
Thin-walled Elastic Beams, 2nd ed., 1961). Nodes are at centroids; an element's own freedoms are those of its shear
centre across the member, u_s = u + r x e, and of its centroid along it. Weight is shared out among the nodes, at
centroids.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class Rod:
    """A straight member: unit directions along it, of its height and of its width; rigidities (SI); where its shear
    centre is along height and width (m); mass per length (kg/m); and whether each end holds warping."""

    length: float
    along: Array
    height: Array
    width: Array
    axial: float
    bending_height: float
    bending_width: float
    torsion: float
    warping: float
    shear_centre: tuple[float, float]
    mass: float
    held: tuple[bool, bool]


ELEMENTS = 24


def _stiffness(rod: Rod, size: float) -> Array:
    """Of an element in its own axes: shifts (along, height, width), turns about them, and the rate of twist, twice."""
    k = np.zeros((14, 14))

    def put(places: Sequence[int], values: Array, signs: Sequence[float]) -> None:
        k[np.ix_(places, places)] += values * np.outer(signs, signs)

    put((0, 7), rod.axial / size * np.array([[1.0, -1.0], [-1.0, 1.0]]), (1, 1))
    bend = np.array(
        [
            [12.0, 6.0 * size, -12.0, 6.0 * size],
            [6.0 * size, 4.0 * size**2, -6.0 * size, 2.0 * size**2],
            [-12.0, -6.0 * size, 12.0, -6.0 * size],
            [6.0 * size, 2.0 * size**2, -6.0 * size, 4.0 * size**2],
        ]
    )
    # The slope towards the height is a turn about the width, that towards the width one about the height, negative.
    put((1, 5, 8, 12), rod.bending_height / size**3 * bend, (1, 1, 1, 1))
    put((2, 4, 9, 11), rod.bending_width / size**3 * bend, (1, -1, 1, -1))
    twist = np.array(
        [
            [36.0, 3.0 * size, -36.0, 3.0 * size],
            [3.0 * size, 4.0 * size**2, -3.0 * size, -(size**2)],
            [-36.0, -3.0 * size, 36.0, -3.0 * size],
            [3.0 * size, -(size**2), -3.0 * size, 4.0 * size**2],
        ]
    )
    put((3, 6, 10, 13), rod.torsion / (30.0 * size) * twist + rod.warping / size**3 * bend, (1, 1, 1, 1))
    return k


def _to_shear_centre(rod: Rod) -> Array:
    """From a node's seven freedoms in the base frame to those of the shear centre along the rod's axes."""
    axes = np.array([rod.along, rod.height, rod.width])
    e = rod.shear_centre[0] * rod.height + rod.shear_centre[1] * rod.width
    cross = np.array([[0.0, e[2], -e[1]], [-e[2], 0.0, e[0]], [e[1], -e[0], 0.0]])
    node = np.eye(7)
    node[:3, :3], node[:3, 3:6], node[3:6, 3:6] = axes, axes @ cross, axes
    node[0, 3:6] = 0.0  # what stretches it acts at its centroid
    return scipy.linalg.block_diag(node, node)


@dataclass(frozen=True)
class Frame:
    """The chain of rods, clamped at its start: stiffness of what is `free` of all freedoms, and the nodes' masses."""

    stiffness: Array
    masses: Array
    free: Array
    size: int

    @property
    def _tip(self) -> int:
        return 7 * (len(self.masses) - 1)

    def moved(self, gravity: Sequence[float], tip_mass: float) -> Array:
        """The six freedoms of the tip under weights and a mass at the tip."""
        load = np.zeros(self.size)
        for axis in range(3):
            load[axis : self._tip + 7 : 7] = self.masses * gravity[axis]
            load[self._tip + axis] += tip_mass * gravity[axis]
        moved = np.zeros(self.size)
        moved[self.free] = np.linalg.solve(self.stiffness, load[self.free])
        return moved[self._tip : self._tip + 6]

    def first_frequency(self, tip_mass: float) -> float:
        """With masses at centroids alone, Hz."""
        mass = np.zeros(self.size)
        for axis in range(3):
            mass[axis : self._tip + 7 : 7] = self.masses
            mass[self._tip + axis] += tip_mass
        flexibility = np.linalg.inv(self.stiffness)
        root = np.sqrt(mass[self.free])
        largest = np.linalg.eigvalsh(root[:, None] * flexibility * root[None, :])[-1]
        return float(1.0 / (2.0 * np.pi * np.sqrt(largest)))


def frame(rods: Sequence[Rod]) -> Frame:
    """Rods end to end; each end's warping is its own: where one ends and another begins both are as `held` says."""
    count = ELEMENTS * len(rods) + 1
    size = 7 * count + len(rods)  # what warps at a rod's start is a freedom beside its node's
    stiffness, masses = np.zeros((size, size)), np.zeros(count)
    fixed = set(range(6))
    for number, rod in enumerate(rods):
        step = rod.length / ELEMENTS
        change = _to_shear_centre(rod)
        element = change.T @ _stiffness(rod, step) @ change
        start = 7 * count + number
        for k in range(ELEMENTS):
            first = number * ELEMENTS + k
            places = [*range(7 * first, 7 * first + 14)]
            if k == 0:
                places[6] = start
            stiffness[np.ix_(places, places)] += element
            masses[first : first + 2] += 0.5 * rod.mass * step
        if rod.held[0]:
            fixed.add(start)
        if rod.held[1]:
            fixed.add(7 * (number + 1) * ELEMENTS + 6)
    fixed.add(6)  # the base node's own rate of twist is no freedom of any rod
    free = np.array([k for k in range(size) if k not in fixed])
    return Frame(stiffness[np.ix_(free, free)], masses, free, size)
