"""What loads an arm by the measured torques, where these go against file and recording: the loads under which drives,
links, bearings, base and masts are all judged to give.

What a drive holds is linear in the links' masses and first moments (C. G. Atkeson, C. H. An & J. M. Hollerbach, Int. J.
Robot. Res. 5(3) (1986) 101, doi:10.1177/027836498600500306), in the payload and its centre, and in what hangs on the
tip or pushes at it. Not every combination of them loads a drive: each is held near what the file says as strongly as
anybody knows it, so that torques move no other, and no mass is below nought. More numbers than those of the masses must
better Schwarz's criterion beyond doubt: where centres lie along links and beside them, what hangs on the tip at each
visit, what pushes there.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass, without_unknown
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.masses_from_torques import Place, carrying, hung_at
from linkwright.core.diagnose.residual.observe import undeformed
from linkwright.core.diagnose.residual.torque import DriveTorque, drive_torques, loads_on_drives
from linkwright.core.diagnose.residual.visits import visits
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.sections.numeric import Array

_TURNS, _SETTLED = 40, 0.1
"""How often variances are found anew from what the loads leave, until the criterion falls by less."""
_ROUNDING = 1e-6
_LEVEL = 1e-9
_CARRIED, _PUSHED = 4, 3
"""Numbers of the payload: its mass, and how far its centre is along the last link, its height and its width; and of
what acts on the tip beside it, in the mean over all visits."""
_STAGES = ("centres", "payload", "ends", "beside")
"""What is asked, one after the other: masses where the file has them; the payload too; masses at the links' ends too;
beside them too."""
_AT_TIP = ("nothing", "mass", "force")
"""What may act on the tip at each visit that nobody recorded."""


@dataclass(frozen=True)
class TorqueLoads:
    """An arm and a recording with the loads that torques show, and what these say of the file's, drive by drive.

    `links` (from 0) weigh other than in the file, each with how well its mass is known (a share, standard error); where
    `moved`, centres are elsewhere too. Of what nobody recorded, `carried` (kg) hangs at the tip throughout, `hung` (kg)
    is the least and the most that hangs there visit by visit, `pushed` (N) the largest force there. `unmade` are drives
    (from 0), each with the share of what their load changes by that none of these make.
    """

    arm: Arm
    recording: Recording
    torques: tuple[DriveTorque, ...]
    links: tuple[tuple[int, float], ...] = ()
    moved: bool = False
    carried: float | None = None
    hung: tuple[float, float] | None = None
    pushed: float | None = None
    unmade: tuple[tuple[int, float], ...] = ()

    def as_recorded(self, readings: Recording, before: Recording) -> Recording:
        """Readings of this recording with the loads that stood in the recording `before`."""
        if self.recording is before:
            return readings
        place = {name: index for index, name in enumerate(before.names_of_readings())}
        rows = np.array([place[name] for name in readings.names_of_readings()], dtype=int)
        payload, force = (None if item is None else item[rows] for item in (before.payload_mass, before.force))
        return replace(readings, payload_mass=payload, force=force, moment=None)


@dataclass(frozen=True)
class _Drives:
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
class _Fitted:
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
        return _moved(within @ inverse, rest), within

    def anew(self, rests: Sequence[Array], ways: Sequence[Array], begun: Sequence[Array]) -> _Noise:
        """The variances that are likelier, by what drives hold beyond all else; none is less than rounding of what it
        begun with."""
        drives, squares = list[Array](), list[Array]()
        for k, (rest, way) in enumerate(zip(rests, ways, strict=True)):
            mean, within = self.acting(k, rest, way)
            unsure = np.einsum("vjk,vkl,vjl->vj", way, within, way)
            square = np.mean((rest - _moved(way, mean)) ** 2 + unsure, axis=0)
            drives.append(np.maximum(square, _ROUNDING**2 * begun[k]))
            squares.append((mean**2 + np.diagonal(within, axis1=1, axis2=2)).reshape(-1))
        shown = np.concatenate(squares)
        return _Noise(tuple(drives), max(float(shown.mean()) if shown.size else 0.0, _LEVEL**2))


def _moved(ways: Array, by: Array) -> Array:
    """Sums (V, m) of ways (V, m, k) times numbers (V, k)."""
    return (ways @ by[:, :, None])[:, :, 0]


@dataclass(frozen=True)
class _System:
    """What the torques of recordings are fitted by: masses of links at places, payloads, each sensor's own."""

    arm: Arm
    places: tuple[Place, ...]
    held: tuple[_Drives, ...]
    stage: int
    at_tip: str
    rules: ResidualRules

    @property
    def gravity(self) -> Array:
        return np.array(self.arm.gravity, dtype=float)

    @cached_property
    def spans(self) -> list[slice]:
        """Where the payloads' numbers are, after the masses."""
        first, each = len(self.places), _CARRIED + _PUSHED
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
        own = [at == (_centre(self.arm, k), 0.0, 0.0) for k, at in self.places]
        lever, whole = self.rules.mass_beside * reach, sum(link.mass or 0.0 for link in links)
        means, usual = [np.array(mass) * own], [np.array(mass)]
        for one in self.held:
            payload = one.recording.payload_mass
            logged = payload is not None
            means.append(np.array([1.0 if logged else self.arm.payload.mass, *[0.0] * (_CARRIED + _PUSHED - 1)]))
            changes = payload is None or float(np.ptp(payload)) > 0.0
            known = [1.0, lever, lever, lever] if logged else [whole, 0.0, 0.0, 0.0]
            usual += [
                float(self.stage > 0 and changes) * np.array(known),
                np.full(_PUSHED, whole * float(np.linalg.norm(self.gravity))),
            ]
        return np.concatenate(means), np.concatenate(usual)

    @cached_property
    def designs(self) -> list[Array]:
        """What all numbers make the drives of each recording hold (V, J, C), the sensors' own numbers last."""
        own = sum(one.beside.shape[1] * one.beside.shape[2] for one in self.held)
        first = len(self.said[0])
        designs: list[Array] = []
        for one, span in zip(self.held, self.spans, strict=True):
            design = np.zeros((*one.lacking.shape, len(self.said[0]) + own))
            design[:, :, : len(self.places)] = one.of_one
            design[:, :, span.start : span.start + _CARRIED] = one.carried
            way = one.acting(self.at_tip, self.gravity)
            design[:, :, span.start + _CARRIED : span.start + _CARRIED + way.shape[2]] = way
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

    def fitted(self) -> _Fitted:
        """What comes nearest to the torques and to what the file says. What acts on the tip is another at each visit,
        of one variance, which with what each drive scatters by is made likelier turn by turn (A. P. Dempster, N. M.
        Laird & D. B. Rubin, J. R. Stat. Soc. B 39 (1977) 1)."""
        ways = self.ways
        begun = [np.var(one.lacking, axis=0) + _LEVEL**2 for one in self.held]
        reach = float(np.mean([np.sum(way**2, axis=2).mean() for way in ways]))
        noise = _Noise(tuple(begun), float(np.mean([item.mean() for item in begun])) / max(reach, _LEVEL**2))
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
        left = [rest - _moved(way, act) for rest, way, act in zip(step.rest, ways, acting, strict=True)]
        numbers = int(np.sum(step.solution[:count] > 0.0) + np.sum(known >= count)) + (self.at_tip != "nothing")
        return _Fitted(
            step.solution[:count],
            covariance,
            np.array([step.solution[span][:_CARRIED] for span in self.spans]),
            tuple(
                act + step.solution[span][_CARRIED : _CARRIED + act.shape[1]]
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

    def loaded(self, fitted: _Fitted) -> bool:
        """Whether what acts on the tip loads some drive by more than anybody would leave be."""
        for one, way, acting in zip(self.held, self.ways, fitted.acting, strict=True):
            by_tip = np.sqrt(np.mean(_moved(way, acting) ** 2, axis=0))
            if (by_tip > self.rules.torque_off * np.std(one.held, axis=0)).any():
                return True
        return False


def loads_by_torque(arm: Arm, recording: Recording, rules: ResidualRules) -> TorqueLoads | None:
    """The arm and the recording with the loads that the torques of a recording show; None where it has none."""
    parts = list(recording.singles)
    unknown = of_unknown_mass(arm)
    if arm.branches or all(part.torque is None for part in parts):
        return None
    known = without_unknown(arm, unknown)
    if not all(index == 0 and _upright(undeformed(known, parts[0], rules)) for index in unknown):
        return None
    found = TorqueLoads(arm, recording, _of_drives(known, parts, recording, rules))
    scaled = [_scaled(found.torques, name, rules) for name in recording.names]
    system, fitted = _best(known, parts, scaled, rules)
    if system.at_tip != "nothing" or any(torque.instead for torque in found.torques):
        found, parts = _with_what_acts(found, known, system, fitted, parts, rules)
    if any(torque.instead for torque in found.torques):
        found = _with_weights(found, system, fitted, parts, rules)
    return found


def _of_drives(
    arm: Arm, parts: Sequence[Recording], recording: Recording, rules: ResidualRules
) -> tuple[DriveTorque, ...]:
    """What the torques of recordings say of each drive."""
    return tuple(
        replace(torque, of=name)
        for name, part in zip(recording.names, parts, strict=True)
        for torque in drive_torques(arm, part, undeformed(arm, part, rules), visits(part, arm, rules=rules), rules)
    )


def _scaled(torques: Sequence[DriveTorque], name: str, rules: ResidualRules) -> frozenset[int]:
    """The drives of a recording whose torque counts by a scale of its own, and tells no weights."""
    return frozenset(item.joint for item in torques if item.of == name and item.scaled and item.differs(rules))


def _best(
    arm: Arm, parts: Sequence[Recording], scaled: Sequence[frozenset[int]], rules: ResidualRules
) -> tuple[_System, _Fitted]:
    """The loads that make the torques best, with no more numbers than they show."""
    best: tuple[_System, _Fitted] | None = None
    for at_tip, stage in itertools.product(_AT_TIP, range(len(_STAGES))):
        places = _places(arm, stage, rules)
        held = tuple(
            _drives(arm, index, part, places, aside, rules)
            for index, (part, aside) in enumerate(zip(parts, scaled, strict=True))
            if part.torque is not None
        )
        system = _System(arm, places, held, stage, at_tip, rules)
        fitted = system.fitted()
        better = best is None or fitted.worth < best[1].worth - rules.torque_sure**2
        if better and (at_tip == "nothing" or system.loaded(fitted)):
            best = (system, fitted)
    assert best is not None  # nothing at the tip needs no drive
    return best


def _with_what_acts(
    found: TorqueLoads,
    known: Arm,
    system: _System,
    fitted: _Fitted,
    parts: list[Recording],
    rules: ResidualRules,
) -> tuple[TorqueLoads, list[Recording]]:
    """The loads with what acts on the tip that nobody recorded, and what the drives say beside that."""
    at_tip = system.at_tip
    if at_tip == "nothing" and (system.stage == 0 or any(part.payload_mass is not None for part in parts)):
        return found, parts
    changed, arm, whole, acting = list(parts), found.arm, float(np.mean(fitted.carried[:, 0])), list[Array]()
    for one, numbers, by_visit in zip(system.held, fitted.carried, fitted.acting, strict=True):
        part = parts[one.part]
        if at_tip == "mass":
            by_visit = by_visit + (numbers[0] if part.payload_mass is None else 0.0)
            before = 0.0 if part.payload_mass is None else part.payload_mass
            changed[one.part] = replace(part, payload_mass=before + by_visit[one.visit, 0])
        if at_tip == "force":
            changed[one.part] = replace(part, force=by_visit[one.visit] + (0.0 if part.force is None else part.force))
        acting.append(by_visit)
    if at_tip == "nothing":
        arm = replace(arm, payload=replace(arm.payload, mass=whole))
    recording = found.recording if at_tip == "nothing" else found.recording.of_parts(changed, arm, rules)
    torques = _of_drives(replace(known, payload=arm.payload), changed, recording, rules)
    shown = np.concatenate(acting)
    found = replace(
        found,
        arm=arm,
        recording=recording,
        torques=_beside(torques, found.torques, rules),
        carried=whole if at_tip == "nothing" else None,
        hung=(float(shown.min()), float(shown.max())) if at_tip == "mass" else None,
        pushed=float(np.linalg.norm(shown, axis=1).max()) if at_tip == "force" else None,
    )
    return found, changed


def _beside(
    anew: Sequence[DriveTorque], before: Sequence[DriveTorque], rules: ResidualRules
) -> tuple[DriveTorque, ...]:
    """What drives say of links beside what acts on the tip; of a payload recorded what they said before: what torques
    showed of the tip bears itself out."""
    payload = {(item.joint, item.of): item.payload for item in before}
    judged = [replace(item, payload=payload.get((item.joint, item.of))) for item in anew]
    return tuple(replace(item, instead=item.differs(rules) and not item.scaled) for item in judged)


def _with_weights(
    found: TorqueLoads, system: _System, fitted: _Fitted, parts: Sequence[Recording], rules: ResidualRules
) -> TorqueLoads:
    """The loads with what links and the payload recorded weigh by the torques."""
    changed = list(parts)
    for one, numbers in zip(system.held, fitted.carried, strict=True):
        changed[one.part] = _carrying_payload(system.arm, parts[one.part], numbers, rules)
    put = list(zip(system.places, fitted.mass.tolist(), strict=True))
    asked = _asked(found.arm)
    weighed = carrying(_weightless(found.arm), put) if asked else found.arm
    recording = found.recording
    if any(new is not old for new, old in zip(changed, parts, strict=True)):
        recording = recording.of_parts(changed, weighed, rules)
    of_link = [np.array([place[0] == k for place in system.places], dtype=float) for k in asked]
    errors = [float(np.sqrt(own @ fitted.covariance @ own)) for own in of_link]
    return replace(
        found,
        arm=weighed,
        recording=recording,
        links=_changed(found.arm, weighed, dict(zip(asked, errors, strict=True))),
        moved=_STAGES[system.stage] in ("ends", "beside"),
        unmade=_unmade(found, system, fitted, rules),
    )


def _changed(before: Arm, after: Arm, errors: dict[int, float]) -> tuple[tuple[int, float], ...]:
    """The links (from 0) whose mass is another by more than its standard error (kg), with that as a share."""
    masses = {k: (before.links[k].mass or 0.0, after.links[k].mass or 0.0) for k in errors}
    return tuple((k, errors[k] / was) for k, (was, now) in masses.items() if abs(now - was) > errors[k])


def _asked(arm: Arm) -> list[int]:
    """The links (from 0) whose mass the file gives as a number: sections and materials say what the others weigh."""
    return [k for k, link in enumerate(arm.links) if link.section is None and link.mass]


def _weightless(arm: Arm) -> Arm:
    """The arm without the masses that are asked."""
    links = list(arm.links)
    for k in _asked(arm):
        links[k] = replace(links[k], mass=0.0, center_of_mass=None)
    return arm.with_links(tuple(links))


def _centre(arm: Arm, link: int) -> float:
    found = arm.links[link].center_of_mass
    return 0.5 * arm.links[link].length if found is None else found


def _places(arm: Arm, stage: int, rules: ResidualRules) -> tuple[Place, ...]:
    """Where masses of links may be."""
    places: list[Place] = []
    for k in _asked(arm):
        middle, length = _centre(arm, k), arm.links[k].length
        places.append((k, (middle, 0.0, 0.0)))
        if stage >= _STAGES.index("ends"):
            places += [(k, (at, 0.0, 0.0)) for at in dict.fromkeys((0.0, length)) if at != middle]
        if stage >= _STAGES.index("beside"):
            off = max(0.5 * length, rules.mass_beside * sum(arm.lengths))
            places += [(k, (middle, *way)) for way in ((off, 0.0), (-off, 0.0), (0.0, off), (0.0, -off))]
    return tuple(places)


def _drives(
    arm: Arm, index: int, recording: Recording, places: Sequence[Place], aside: frozenset[int], rules: ResidualRules
) -> _Drives:
    """What the drives of a recording hold, but for those set aside, and what may make them hold it."""
    assert recording.torque is not None
    visit = np.unique(visits(recording, arm, rules=rules), return_inverse=True)[1].reshape(-1)
    count = np.bincount(visit)
    one = recording.kept(np.isin(np.arange(recording.size), np.unique(visit, return_index=True)[1]))
    joints = tuple(joint for joint in range(arm.size) if joint not in aside)
    bare, last = _weightless(arm), arm.size - 1

    def loads(of: Arm, **at_tip: Array | None) -> Array:
        read = replace(one, **{"payload_mass": None, "force": None, **at_tip})  # pyright: ignore[reportArgumentType]
        return loads_on_drives(of, read, payload=bool(at_tip), rules=rules)[:, joints]

    nothing, still = loads(bare), np.zeros(one.size)
    of_one = np.zeros((one.size, len(joints), len(places)))
    for k, place in enumerate(places):
        of_one[:, :, k] = loads(hung_at(bare, place)) - nothing
    pushes = [np.tile(way, (one.size, 1)) for way in np.eye(3)]
    tip = np.stack([loads(bare, payload_mass=still, force=push) - nothing for push in pushes], axis=2)
    tip[np.abs(tip) <= _LEVEL * np.abs(tip).max()] = 0.0
    of_payload = tip @ np.array(arm.gravity, dtype=float)
    carried = np.zeros((one.size, len(joints), _CARRIED))
    carried[:, :, 0] = of_payload
    if one.payload_mass is not None:
        centred = loads(hung_at(bare, (last, (0.0, 0.0, 0.0))))
        for k, way in enumerate(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), start=1):
            carried[:, :, k] = loads(hung_at(bare, (last, way))) - centred
        carried *= one.payload_mass[:, None, None]
    pushed = 0.0 if one.force is None else np.einsum("vja,va->vj", tip, one.force)
    own = [np.ones((one.size, arm.size))]
    if one.sides is not None:
        own.append(one.sides)
    if recording.velocity is not None:
        own.append(_by_visit(recording.velocity, visit, count))
    beside = np.stack(own, axis=2)[:, joints]
    held = -_by_visit(recording.torque, visit, count)[:, joints]
    lacking = held - nothing - pushed
    return _Drives(index, recording, joints, visit, lacking, of_one, carried, tip, beside, held)


def _by_visit(values: Array, visit: NDArray[np.int64], count: NDArray[np.int64]) -> Array:
    """The means (V, n) of values (N, n) over visits."""
    return np.stack([np.bincount(visit, weights=column) for column in values.T], axis=1) / count[:, None]


def _carrying_payload(arm: Arm, recording: Recording, numbers: Array, rules: ResidualRules) -> Recording:
    """A recording with its payload by a factor, and the moment about the tip that its centre makes (`numbers`)."""
    if recording.payload_mass is None or (numbers == np.eye(1, _CARRIED)[0]).all():
        return recording
    link = undeformed(arm, recording, rules).frames.links[-1]
    ways = [columns(way, recording.size) for way in (link.along, link.height, link.width)]
    lever = np.einsum("k,kna->na", numbers[1:], np.stack(ways))
    moment = np.cross(recording.payload_mass[:, None] * lever, np.array(arm.gravity, dtype=float))
    return replace(recording, payload_mass=numbers[0] * recording.payload_mass, moment=moment)


def _unmade(
    found: TorqueLoads, system: _System, fitted: _Fitted, rules: ResidualRules
) -> tuple[tuple[int, float], ...]:
    """The drives whose load none of the loads make but for its scatter, each with the share of it that they leave."""
    names, shares = found.recording.names, dict[int, float]()
    for one, left in zip(system.held, fitted.left, strict=True):
        rests = dict(zip(one.joints, left.T, strict=True))
        for torque in found.torques:
            if torque.of == names[one.part] and torque.joint in rests and torque.instead:
                square = float(np.mean(rests[torque.joint] ** 2)) - torque.scatter**2
                share = max(square, 0.0) ** 0.5 / torque.spread
                shares[torque.joint] = max(shares.get(torque.joint, 0.0), share)
    return tuple((joint, share) for joint, share in sorted(shares.items()) if share > rules.torque_seen)


def _upright(state: PoseState) -> bool:
    """Whether nothing that the first link weighs loads its drive."""
    joint, pull = state.joints[0], np.array(state.arm.gravity, dtype=float)
    axis = columns(joint.axis, 1)[0]
    across = np.cross(axis, pull) if joint.revolute else axis * float(axis @ pull)
    return float(np.linalg.norm(across)) <= _LEVEL * float(np.linalg.norm(pull))
