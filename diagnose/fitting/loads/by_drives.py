"""What torques say of masses at places of the links, of payloads and of what acts on the tip: least squares whose
numbers are held near the file's as strongly as anybody knows them, and no mass below zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.masses_from_torques import Place
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.sections.numeric import Array

_TURNS, _SETTLED = 40, 0.1
"""How often variances are found anew from what the loads leave, until the criterion falls by less."""
_ROUNDING = 1e-6
LEVEL = 1e-9
"""What is below this share of the largest is rounding."""
CARRIED, PUSHED = 4, 3
"""Numbers of the payload: its mass, and how far its centre is along the last link, its height and its width; and of
what acts on the tip beside it, in the mean over all visits."""


@dataclass(frozen=True)
class Drives:
    """What the drives of one recording hold by visit, `held` (V, J), what of that is not known to be there, `lacking`
    (V, J), and what may make them hold it: `of_one` (V, J, P) a kilogram at each place, `carried` (V, J, 4) the payload
    and its centre a metre further, `tip` (V, J, 3) a newton at the tip along each axis, `beside` (V, J, b) a sensor's
    constant, friction by side and by speed. `visit` (N,) numbers visits; `joints` are the drives, `part` says which of
    the recordings it is."""

    part: int
    recording: Recording
    joints: tuple[int, ...]
    visit: NDArray[np.int64]
    lacking: Array
    of_one: Array
    carried: Array
    tip: Array
    beside: Array
    held: Array

    def acting(self, at_tip: str, gravity: Array) -> Array:
        """What a unit of each number at the tip makes them hold (V, J, k)."""
        return {"nothing": self.tip[:, :, :0], "mass": (self.tip @ gravity)[:, :, None], "force": self.tip}[at_tip]


@dataclass(frozen=True)
class Fitted:
    """Masses (P,) at places, kg, and their covariance (P, P); of each recording the payload's numbers (R, 4), what acts
    on the tip at each visit (V, k) and what each drive holds beyond all that (V, J); and Schwarz's criterion, less
    where it is better."""

    mass: Array
    covariance: Array
    carried: Array
    acting: tuple[Array, ...]
    left: tuple[Array, ...]
    worth: float


@dataclass(frozen=True)
class _Step:
    """All numbers as they fit best, the curvature there, what each drive then holds beyond them (V, J) of each
    recording, and twice the negative logarithm of how likely that is."""

    solution: Array
    curvature: Array
    rest: tuple[Array, ...]
    misfit: float


@dataclass(frozen=True)
class _Noise:
    """How torques vary at a visit: the variance of each drive's noise (J,) of each recording, and of each number that
    acts on the tip."""

    drives: tuple[Array, ...]
    tip: float

    def root(self, part: int, ways: Array) -> Array:
        """The lower root (V, J, J) of the covariance of a recording's drives; `ways` (V, J, k) is what acts on them."""
        both: Array = self.tip * ways @ np.swapaxes(ways, 1, 2) + np.diag(self.drives[part])
        return np.linalg.cholesky(both).astype(float)

    def acting(self, part: int, rest: Array, ways: Array) -> tuple[Array, Array]:
        """What acts on the tip at each visit (V, k), by what drives hold beyond all else, and its covariance."""
        inverse = np.swapaxes(ways, 1, 2) / self.drives[part]
        within = np.linalg.inv(inverse @ ways + np.eye(ways.shape[2]) / self.tip).astype(float)
        return moved_by(within @ inverse, rest), within

    def anew(self, rests: Sequence[Array], ways: Sequence[Array], begun: Sequence[Array]) -> _Noise:
        """The variances that are likelier, by what drives hold beyond all else; none is less than rounding of what it
        begun with."""
        drives, squares = list[Array](), list[Array]()
        for k, (rest, way) in enumerate(zip(rests, ways, strict=True)):
            mean, within = self.acting(k, rest, way)
            unsure = np.einsum("vjk,vkl,vjl->vj", way, within, way)
            square = np.mean((rest - moved_by(way, mean)) ** 2 + unsure, axis=0)
            drives.append(np.maximum(square, _ROUNDING**2 * begun[k]))
            squares.append((mean**2 + np.diagonal(within, axis1=1, axis2=2)).reshape(-1))
        shown = np.concatenate(squares)
        return _Noise(tuple(drives), max(float(shown.mean()) if shown.size else 0.0, LEVEL**2))


def moved_by(ways: Array, by: Array) -> Array:
    """Sums (V, m) of ways (V, m, k) times numbers (V, k)."""
    return (ways @ by[:, :, None])[:, :, 0]


@dataclass(frozen=True)
class System:
    """What the torques of recordings are fitted by: masses of links at places, payloads, each sensor's own."""

    arm: Arm
    places: tuple[Place, ...]
    held: tuple[Drives, ...]
    stage: int
    at_tip: str
    rules: ResidualRules

    @property
    def gravity(self) -> Array:
        """The acceleration of gravity in the base frame (3,), m/s^2."""
        return np.array(self.arm.gravity, dtype=float)

    @cached_property
    def spans(self) -> list[slice]:
        """Where the payloads' numbers are, after the masses."""
        first, each = len(self.places), CARRIED + PUSHED
        return [slice(first + each * k, first + each * (k + 1)) for k in range(len(self.held))]

    @cached_property
    def ways(self) -> list[Array]:
        """What a unit of each number that acts on the tip makes the drives of each recording hold (V, J, k)."""
        return [one.acting(self.at_tip, self.gravity) for one in self.held]

    @cached_property
    def said(self) -> tuple[Array, Array]:
        """What the file says of masses and payloads, and how strongly anybody knows it (a standard deviation)."""
        links, reach = self.arm.links, sum(self.arm.lengths)
        mass = [links[k].mass or 0.0 for k, _ in self.places]
        at_centre = [at == (centre_of(self.arm, k), 0.0, 0.0) for k, at in self.places]
        lever, whole = self.rules.mass_beside * reach, sum(link.mass or 0.0 for link in links)
        means, usual = [np.array(mass) * at_centre], [np.array(mass)]
        for one in self.held:
            payload = one.recording.payload_mass
            logged = payload is not None
            means.append(np.array([1.0 if logged else self.arm.payload.mass, *[0.0] * (CARRIED + PUSHED - 1)]))
            changes = payload is None or float(np.ptp(payload)) > 0.0
            known = [1.0, lever, lever, lever] if logged else [whole, 0.0, 0.0, 0.0]
            usual += [
                float(self.stage > 0 and changes) * np.array(known),
                np.full(PUSHED, whole * float(np.linalg.norm(self.gravity))),
            ]
        return np.concatenate(means), np.concatenate(usual)

    @cached_property
    def designs(self) -> list[Array]:
        """What all numbers make the drives of each recording hold (V, J, C), the sensors' numbers last."""
        sensor_count = sum(one.beside.shape[1] * one.beside.shape[2] for one in self.held)
        first = len(self.said[0])
        designs: list[Array] = []
        for one, span in zip(self.held, self.spans, strict=True):
            design = np.zeros((*one.lacking.shape, len(self.said[0]) + sensor_count))
            design[:, :, : len(self.places)] = one.of_one
            design[:, :, span.start : span.start + CARRIED] = one.carried
            way = one.acting(self.at_tip, self.gravity)
            design[:, :, span.start + CARRIED : span.start + CARRIED + way.shape[2]] = way
            for k in range(one.beside.shape[1]):
                design[:, k, first : first + one.beside.shape[2]] = one.beside[:, k]
                first += one.beside.shape[2]
            designs.append(design)
        return designs

    @cached_property
    def free(self) -> NDArray[np.int64]:
        """Which of all numbers are fitted: those that nobody is sure of and that the torques show."""
        usual = self.said[1]
        shows = np.any([design.any(axis=(0, 1)) for design in self.designs], axis=0)
        return np.flatnonzero(np.concatenate([usual > 0.0, np.ones(len(shows) - len(usual), dtype=bool)]) & shows)

    def fitted(self) -> Fitted:
        """What comes nearest to the torques and to what the file says. What acts on the tip is another at each visit,
        of one variance, which with what each drive scatters by is made likelier turn by turn (A. P. Dempster, N. M.
        Laird & D. B. Rubin, J. R. Stat. Soc. B 39 (1977) 1)."""
        ways = self.ways
        begun = [np.var(one.lacking, axis=0) + LEVEL**2 for one in self.held]
        reach = float(np.mean([np.sum(way**2, axis=2).mean() for way in ways]))
        noise = _Noise(tuple(begun), float(np.mean([item.mean() for item in begun])) / max(reach, LEVEL**2))
        worth, step = np.inf, self._step(noise)
        for _ in range(_TURNS):
            before, worth = worth, step.misfit
            noise = noise.anew(step.rest, ways, begun)
            step = self._step(noise)
            if before - worth < _SETTLED:
                break
        count = len(self.places)
        known = self.free[self.free < len(self.said[0])]
        masses = known[known < count]
        covariance = np.zeros((count, count))
        within = np.linalg.pinv(step.curvature, hermitian=True)
        covariance[np.ix_(masses, masses)] = within[: len(masses), : len(masses)]
        acting = [noise.acting(k, rest, way)[0] for k, (rest, way) in enumerate(zip(step.rest, ways, strict=True))]
        left = [rest - moved_by(way, act) for rest, way, act in zip(step.rest, ways, acting, strict=True)]
        numbers = int(np.sum(step.solution[:count] > 0.0) + np.sum(known >= count)) + (self.at_tip != "nothing")
        return Fitted(
            step.solution[:count],
            covariance,
            np.array([step.solution[span][:CARRIED] for span in self.spans]),
            tuple(
                act + step.solution[span][CARRIED : CARRIED + act.shape[1]]
                for act, span in zip(acting, self.spans, strict=True)
            ),
            tuple(left),
            step.misfit + numbers * float(np.log(sum(rest.size for rest in left))),
        )

    def _step(self, noise: _Noise) -> _Step:
        """All numbers as they fit best where torques vary so much."""
        means, usual = self.said
        known, count = self.free[self.free < len(usual)], self.designs[0].shape[2]
        at_file = np.concatenate([means, np.zeros(count - len(means))])
        at_file[self.free] = 0.0
        near = np.zeros((len(known), len(self.free)))
        near[:, : len(known)] = np.diag(1.0 / usual[known])
        rows, wanted, spread = list[Any]([near]), list[Any]([means[known] / usual[known]]), 0.0
        for k, (one, design, way) in enumerate(zip(self.held, self.designs, self.ways, strict=True)):
            root = noise.root(k, way)
            rows.append(np.linalg.solve(root, design[:, :, self.free]).reshape(-1, len(self.free)))
            wanted.append(np.linalg.solve(root, (one.lacking - design @ at_file)[:, :, None]).reshape(-1))
            spread += 2.0 * float(np.log(np.diagonal(root, axis1=1, axis2=2)).sum())
        system, target = np.concatenate(rows), np.concatenate(wanted)
        least = np.where(self.free < len(self.places), 0.0, -np.inf)
        solution = at_file.copy()
        solution[self.free] = lsq_linear(system, target, (least, np.inf), method="bvls").x
        rest = tuple(one.lacking - design @ solution for one, design in zip(self.held, self.designs, strict=True))
        misfit = float(np.sum((system @ solution[self.free] - target) ** 2)) + spread
        return _Step(solution, system.T @ system, rest, misfit)

    def loaded(self, fitted: Fitted) -> bool:
        """Whether what acts on the tip loads some drive by more than anybody would leave be."""
        for one, way, acting in zip(self.held, self.ways, fitted.acting, strict=True):
            by_tip = np.sqrt(np.mean(moved_by(way, acting) ** 2, axis=0))
            if (by_tip > self.rules.torque_off * np.std(one.held, axis=0)).any():
                return True
        return False


def centre_of(arm: Arm, link: int) -> float:
    """How far along a link its centre of mass is, m."""
    centre = arm.links[link].center_of_mass
    return 0.5 * arm.links[link].length if centre is None else centre
