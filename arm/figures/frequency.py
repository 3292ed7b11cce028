"""The pose at which an arm is slowest: the least first bending frequency over a workspace.

A scan orders poses by the Ritz value of three trial shapes (what the masses' weights along x, y and z bend the arm to,
improved once: Stodola's method; R. W. Clough & J. Penzien, Dynamics of Structures, ch. 13). From the slowest of them
climbs go by Newton steps. With the mode v held, the work of its inertia forces, v' F v of unit v, is the largest
eigenvalue where v was found, and so are its first derivatives (R. B. Nelson, AIAA J. 14 (1976) 1201-1205, for those
and for the second): each takes one response to given forces instead of a matrix and its eigenvalues.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.limits.modes import (
    SegmentedArm,
    compliance_matrices,
    coordinate_masses,
    first_frequencies,
    first_modes,
    inertia_excess,
    responses,
    segmented,
    symmetric,
)
from linkwright.core.arm.limits.weakest_poses import plainest
from linkwright.core.arm.worst.certificate import climb
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import climbing_bounds, wrapped
from linkwright.core.sections.numeric import Array

from .design import DesignExpressions, DesignValues
from .figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst

_POSES = 1024
_SLOWEST, _APART = 3, 5
"""Starts of climbs: the slowest poses scanned, and the slowest that lie apart."""
_DISTANCE = 0.3
_STEP = 1e-3
"""Of the differences (rad, m) of a work whose forces are held."""
_CLOSE = 1e-6
"""Eigenvalues nearer than this share of the largest count as this far apart: a step needs no more."""


@dataclass(frozen=True)
class Frequency:
    """The least first bending frequency over the workspace (Hz), its pose and load case (from 0)."""

    value: float
    q: tuple[float, ...]
    load_case: int


def least_frequency(
    arm: Arm,
    search: WorstSearch,
    beams: Sequence[Beam],
    p: Array,
    cases: Sequence[LoadCase],
    *,
    plain: bool = True,
) -> Frequency | None:
    """The least first bending frequency over the workspace; None where nothing gives.

    Joint ranges are scanned and the slowest poses refined; boxes and paths are scanned. With `plain` the pose is the
    plainest of those that are as slow; the value is the same without.
    """
    poses = search.poses(p, _POSES)
    best: Frequency | None = None
    carried = {arm.payloads(case): number for number, case in reversed(list(enumerate(cases)))}
    for payloads, number in carried.items():
        slow = Slowness(arm, beams, payloads)
        scanned = slow.estimates(poses)
        if not scanned.any():
            continue
        candidates = poses[_starts(poses, scanned)]
        if search.workspace.kind == "joints":
            bounds = climbing_bounds(arm, search.lower, search.upper)
            reached = climb(lambda q, _, slow=slow: slow.derivatives(q), candidates, *bounds)[0]
            candidates = np.vstack([candidates, wrapped(arm, reached, search.lower, search.upper)])
        values = first_frequencies(arm, beams, payloads, candidates)
        lowest = int(np.argmin(values))
        if best is None or values[lowest] < best.value:
            pose = candidates[lowest]
            if plain and search.workspace.kind == "joints":
                slowness = partial(_slowness, arm, beams, payloads)
                pose = plainest(slowness, pose, (search.lower, search.upper))
            best = Frequency(float(values[lowest]), tuple(pose.tolist()), number)
    return best


def frequency_of_drives(
    arm: Arm,
    search: WorstSearch,
    beams: Sequence[Beam],
    p: Array,
    cases: Sequence[LoadCase],
    *,
    weightless: bool = False,
) -> Frequency | None:
    """The least first frequency that the drives would have alone, on rigid links: no stiffer links make the arm faster.

    The links keep their masses, each at its centre (what turning about it adds is left out, which only makes the bound
    higher), or are `weightless`: then it bounds every arm with these joints, lengths and loads. None where no drive
    gives.
    """
    # Where what runs out of a sleeve has its centre is a matter of the pose; less mass is never slower.
    masses = [
        0.0 if weightless or link.runs_out else float(beam.mass) for link, beam in zip(arm.links, beams, strict=True)
    ]
    centers = [
        float(beam.lumped_at) if beam.flexural_rigidity_height is None else beam.taper.balance * float(beam.length)
        for beam in beams
    ]
    links = tuple(
        replace(
            link,
            section=None,
            section_name=None,
            material=None,
            mass=mass,
            center_of_mass=center,
            # Less mass is never slower, and where these sit along a link depends on its pieces (see `modes`).
            masses=tuple(x for x in link.masses if not weightless or x.on == "end" or not any(x.at)),
        )
        for link, mass, center in zip(arm.links, masses, centers, strict=True)
    )
    rigid = [
        Beam(length=float(beam.length), lumped_mass=mass, lumped_at=center)
        for beam, mass, center in zip(beams, masses, centers, strict=True)
    ]
    return least_frequency(arm.with_links(links), search, rigid, p, cases)


def _slowness(arm: Arm, beams: Sequence[Beam], payloads: Sequence[float], q: Array) -> Array:
    return 1.0 / first_frequencies(arm, beams, payloads, q)


def _starts(poses: Array, slowness: Array) -> list[int]:
    order = np.argsort(-slowness, kind="stable")
    apart: list[int] = []
    for index in order.tolist():
        if all(np.abs(poses[index] - poses[other]).max() > _DISTANCE for other in apart):
            apart.append(index)
        if len(apart) == _APART:
            break
    return list(dict.fromkeys([*order[:_SLOWEST].tolist(), *apart]))


class Slowness:
    """1/omega^2 (s^2) of an arm's first mode with payloads (kg) at its tips: the largest eigenvalue of F M."""

    def __init__(self, arm: Arm, beams: Sequence[Beam], payloads: Sequence[float]) -> None:
        self._beams, self._segments = beams, segmented(arm)
        self._masses = coordinate_masses(arm, self._segments, beams, payloads)
        self._root = np.sqrt(self._masses)
        size = arm.size
        pairs = list(itertools.combinations(range(size), 2))
        unit = _STEP * np.eye(size)
        both = np.array([sign * (unit[a] + unit[b]) for sign in (1.0, -1.0) for a, b in pairs]).reshape(-1, size)
        self._pairs, self._around = pairs, np.vstack([np.zeros((1, size)), unit, -unit, both])

    def _moved(self, q: Array, forces: Array) -> Array:
        """The displacements (N, 3 s) of the nodes under forces (N, 3 s) at poses q (N, n)."""
        return responses(self._segments, self._beams, q, forces)

    def estimates(self, q: Array) -> Array:
        """Lower bounds (N,) at poses q (N, n), near the true values: Ritz's, of three shapes."""
        count, size = len(q), len(self._masses)
        every = np.repeat(q, 3, axis=0)
        weights = np.array([self._masses * (np.arange(size) % 3 == axis) for axis in range(3)])
        first = self._moved(every, np.tile(weights, (count, 1)))
        inertia = first * self._masses
        second = self._moved(every, inertia).reshape(count, 3, size)
        shapes, forces = first.reshape(count, 3, size), inertia.reshape(count, 3, size)
        carried, work = shapes @ forces.transpose(0, 2, 1), forces @ second.transpose(0, 2, 1)
        # Shapes may coincide or be zero (a planar arm does not move sideways): what they span alone counts.
        values, vectors = np.linalg.eigh(0.5 * (carried + carried.transpose(0, 2, 1)))
        spanned = values > 1e-9 * values.max(axis=1, initial=1e-300, keepdims=True)
        basis = vectors * np.where(spanned, 1.0 / np.sqrt(np.where(spanned, values, 1.0)), 0.0)[:, None, :]
        ritz = basis.transpose(0, 2, 1) @ (0.5 * (work + work.transpose(0, 2, 1))) @ basis
        return np.maximum(np.linalg.eigvalsh(ritz)[:, -1], 0.0)

    def derivatives(self, q: Array) -> tuple[Array, Array, Array]:
        """Values (N,), gradients (N, n) and Hessians (N, n, n) at poses q (N, n)."""
        count, size = q.shape
        compliance = compliance_matrices(self._segments, self._beams, q)
        values, vectors = np.linalg.eigh(symmetric(compliance, self._root))
        forces = vectors[:, :, -1] * self._root
        around = (q[:, None, :] + self._around).reshape(-1, size)
        held = np.repeat(forces, len(self._around), axis=0)
        moved = self._moved(around, held).reshape(count, len(self._around), -1)
        work = np.einsum("nri,ni->nr", moved, forces)
        ahead, behind = work[:, 1 : size + 1], work[:, size + 1 : 2 * size + 1]
        hessian = np.empty((count, size, size))
        diagonal = np.arange(size)
        hessian[:, diagonal, diagonal] = (ahead + behind - 2.0 * work[:, :1]) / _STEP**2
        for k, (a, b) in enumerate(self._pairs):
            corners = work[:, 2 * size + 1 + k] + work[:, 2 * size + 1 + len(self._pairs) + k]
            sides = ahead[:, a] + behind[:, a] + ahead[:, b] + behind[:, b]
            hessian[:, a, b] = hessian[:, b, a] = (corners - sides + 2.0 * work[:, 0]) / (2.0 * _STEP**2)
        # The mode turns towards the others as the pose changes.
        change = (moved[:, 1 : size + 1] - moved[:, size + 1 : 2 * size + 1]) * self._root / (2.0 * _STEP)
        largest = values[:, -1:]
        mixed = change @ vectors[:, :, :-1]
        apart = np.maximum(largest - values[:, :-1], _CLOSE * largest + 1e-300)
        hessian += 2.0 * np.einsum("nik,njk,nk->nij", mixed, mixed, 1.0 / apart)
        return values[:, -1], (ahead - behind) / (2.0 * _STEP), hessian


class Modes(PoseFamily[Frequency]):
    """Rayleigh's quotient of trial shapes: a cut holds the payloads (kg) and the shape beside the pose."""

    name: str = "modes"
    needs: frozenset[str] = frozenset({"masses"})
    called: str = "first_frequency"
    bounds_many: ClassVar[bool] = False
    stiffer_is_better: ClassVar[bool] = True
    # Inertia over stiffness goes with the frequency squared.
    slope: ClassVar[float] = 2.0

    def prepare(self, problem: Asked) -> tuple[Arm, SegmentedArm]:
        """The arm in segments."""
        return problem.arm, segmented(problem.arm)

    def groups(self, problem: Asked) -> int:
        """One: a cut says what is carried."""
        del problem
        return 1

    def more(self, prepared: tuple[Arm, SegmentedArm]) -> int:
        """The payload of each tip, and the shape."""
        return len(prepared[1].ways) + 3 * len(prepared[1].owner)

    def rows(
        self,
        prepared: tuple[Arm, SegmentedArm],
        group: int,
        pose: tuple[Any, Any],
        design: DesignExpressions,
        held: Held,
    ) -> Iterator[tuple[int, Any]]:
        """The shape's inertia over its stiffness at the frequency asked for."""
        del group
        arm, segments = prepared
        q, more = pose
        places, tips = [q[k] for k in range(arm.size)], len(segments.ways)
        payloads, shapes = [more[k] for k in range(tips)], [more[k] for k in range(tips, more.numel())]
        for number, value, slack in held.on(FIRST_FREQUENCY.name):
            excess = inertia_excess(arm, segments, places, design.beams, payloads, shapes, value)
            yield number, excess + 1.0 - ca.exp(2.0 * slack)

    def evaluate(self, design: DesignValues) -> Frequency | None:
        """The slowest mode; None where nothing in the model gives."""
        return least_frequency(design.arm, design.search, design.beams, design.p, design.load_cases)

    def values(self, result: Frequency) -> Mapping[str, float | None]:
        """The least frequency."""
        return {FIRST_FREQUENCY.name: result.value}

    def unknown(self, result: Frequency | None) -> Mapping[str, str]:
        """A rigid arm has none."""
        return {} if result else {self.called: "nothing in the model gives, so there is no bending frequency"}

    def worst(self, prepared: tuple[Arm, SegmentedArm], problem: Asked, design: DesignValues) -> list[Worst]:
        """The slowest mode; none where nothing in the model gives."""
        del prepared
        slowest = self.evaluate(design)
        if slowest is None:
            return []
        payloads = design.arm.payloads(problem.load_cases[slowest.load_case])
        modes = first_modes(design.arm, design.beams, payloads, np.array([slowest.q]))
        cut = Cut(slowest.q, 0, (*payloads, *modes.shape[0].tolist()))
        return [Worst(FIRST_FREQUENCY.name, float(modes.frequency[0]), cut)]

    def at_cut(self, prepared: tuple[Arm, SegmentedArm], problem: Asked, arm: Arm, cut: Cut) -> float:
        """The first frequency (Hz) at the cut's pose with its payloads."""
        beams, payloads = beams_of(arm, problem.load_cases), cut.more[: len(prepared[1].ways)]
        return float(first_frequencies(arm, beams, payloads, np.array([cut.q]))[0])


MODES = Modes()
"""The first bending mode."""

FIRST_FREQUENCY = Figure(
    name="first_frequency",
    synonyms=("frequency", "natural_frequency", "eigenfrequency", "resonance", "fundamental_frequency"),
    title="first frequency",
    kind="frequency",
    unit="Hz",
    senses=(">=",),
    key="first_frequency_Hz",
    follows=ThroughPoses(MODES),
    more_is_better=True,
    note="least",
    where=lambda result: result.q,
)
