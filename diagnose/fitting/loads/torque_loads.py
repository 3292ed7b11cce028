"""What loads an arm by the measured torques, where these go against file and recording: the loads under which drives,
links, bearings, base and masts are all judged to give.

What a drive holds is linear in the links' masses and first moments (C. G. Atkeson, C. H. An & J. M. Hollerbach, Int. J.
Robot. Res. 5(3) (1986) 101, doi:10.1177/027836498600500306), in the payload and its centre, and in what hangs on the
tip or pushes at it. Not every combination of them loads a drive: each is held near what the file says as strongly as
anybody knows it, so that torques move no other, and no mass is below zero. More numbers than those of the masses must
better Schwarz's criterion beyond doubt: where centres lie along links and beside them, what hangs on the tip at each
visit, what pushes there.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

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

from .by_drives import CARRIED, LEVEL, Drives, Fitted, System, centre_of

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


def loads_by_torque(arm: Arm, recording: Recording, rules: ResidualRules) -> TorqueLoads | None:
    """The arm and the recording with the loads that the torques of a recording show; None where it has none."""
    parts = list(recording.singles)
    unknown = of_unknown_mass(arm)
    if arm.branches or all(part.torque is None for part in parts):
        return None
    known = without_unknown(arm, unknown)
    if not all(index == 0 and _upright(undeformed(known, parts[0], rules)) for index in unknown):
        return None
    loads = TorqueLoads(arm, recording, _of_drives(known, parts, recording, rules))
    scaled = [_scaled(loads.torques, name, rules) for name in recording.names]
    system, fitted = _best(known, parts, scaled, rules)
    if system.at_tip != "nothing" or any(torque.instead for torque in loads.torques):
        loads, parts = _with_what_acts(loads, known, system, fitted, parts, rules)
    if any(torque.instead for torque in loads.torques):
        loads = _with_weights(loads, system, fitted, parts, rules)
    return loads


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
    """The drives of a recording whose torque counts by a separate scale, and tells no weights."""
    return frozenset(item.joint for item in torques if item.of == name and item.scaled and item.differs(rules))


def _best(
    arm: Arm, parts: Sequence[Recording], scaled: Sequence[frozenset[int]], rules: ResidualRules
) -> tuple[System, Fitted]:
    """The loads that make the torques best, with no more numbers than they show."""
    best: tuple[System, Fitted] | None = None
    for at_tip, stage in itertools.product(_AT_TIP, range(len(_STAGES))):
        places = _places(arm, stage, rules)
        held = tuple(
            _drives(arm, index, part, places, aside, rules)
            for index, (part, aside) in enumerate(zip(parts, scaled, strict=True))
            if part.torque is not None
        )
        system = System(arm, places, held, stage, at_tip, rules)
        fitted = system.fitted()
        better = best is None or fitted.worth < best[1].worth - rules.torque_sure**2
        if better and (at_tip == "nothing" or system.loaded(fitted)):
            best = (system, fitted)
    assert best is not None  # nothing at the tip needs no drive
    return best


def _with_what_acts(
    loads: TorqueLoads,
    known: Arm,
    system: System,
    fitted: Fitted,
    parts: list[Recording],
    rules: ResidualRules,
) -> tuple[TorqueLoads, list[Recording]]:
    """The loads with what acts on the tip that nobody recorded, and what the drives say beside that."""
    at_tip = system.at_tip
    if at_tip == "nothing" and (system.stage == 0 or any(part.payload_mass is not None for part in parts)):
        return loads, parts
    changed, arm, whole, acting = list(parts), loads.arm, float(np.mean(fitted.carried[:, 0])), list[Array]()
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
    recording = loads.recording if at_tip == "nothing" else loads.recording.of_parts(changed, arm, rules)
    torques = _of_drives(replace(known, payload=arm.payload), changed, recording, rules)
    shown = np.concatenate(acting)
    loads = replace(
        loads,
        arm=arm,
        recording=recording,
        torques=_beside(torques, loads.torques, rules),
        carried=whole if at_tip == "nothing" else None,
        hung=(float(shown.min()), float(shown.max())) if at_tip == "mass" else None,
        pushed=float(np.linalg.norm(shown, axis=1).max()) if at_tip == "force" else None,
    )
    return loads, changed


def _beside(
    anew: Sequence[DriveTorque], before: Sequence[DriveTorque], rules: ResidualRules
) -> tuple[DriveTorque, ...]:
    """What drives say of links beside what acts on the tip; of a payload recorded what they said before: what torques
    showed of the tip bears itself out."""
    payload = {(item.joint, item.of): item.payload for item in before}
    judged = [replace(item, payload=payload.get((item.joint, item.of))) for item in anew]
    return tuple(replace(item, instead=item.differs(rules) and not item.scaled) for item in judged)


def _with_weights(
    loads: TorqueLoads, system: System, fitted: Fitted, parts: Sequence[Recording], rules: ResidualRules
) -> TorqueLoads:
    """The loads with what links and the payload recorded weigh by the torques."""
    changed = list(parts)
    for one, numbers in zip(system.held, fitted.carried, strict=True):
        changed[one.part] = _carrying_payload(system.arm, parts[one.part], numbers, rules)
    put = list(zip(system.places, fitted.mass.tolist(), strict=True))
    asked = _asked(loads.arm)
    weighed = carrying(_weightless(loads.arm), put) if asked else loads.arm
    recording = loads.recording
    if any(new is not old for new, old in zip(changed, parts, strict=True)):
        recording = recording.of_parts(changed, weighed, rules)
    of_link = [np.array([place[0] == k for place in system.places], dtype=float) for k in asked]
    errors = [float(np.sqrt(combination @ fitted.covariance @ combination)) for combination in of_link]
    return replace(
        loads,
        arm=weighed,
        recording=recording,
        links=_changed(loads.arm, weighed, dict(zip(asked, errors, strict=True))),
        moved=_STAGES[system.stage] in ("ends", "beside"),
        unmade=_unmade(loads, system, fitted, rules),
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


def _places(arm: Arm, stage: int, rules: ResidualRules) -> tuple[Place, ...]:
    """Where masses of links may be."""
    places: list[Place] = []
    for k in _asked(arm):
        middle, length = centre_of(arm, k), arm.links[k].length
        places.append((k, (middle, 0.0, 0.0)))
        if stage >= _STAGES.index("ends"):
            places += [(k, (at, 0.0, 0.0)) for at in dict.fromkeys((0.0, length)) if at != middle]
        if stage >= _STAGES.index("beside"):
            off = max(0.5 * length, rules.mass_beside * sum(arm.lengths))
            places += [(k, (middle, *way)) for way in ((off, 0.0), (-off, 0.0), (0.0, off), (0.0, -off))]
    return tuple(places)


def _drives(
    arm: Arm, index: int, recording: Recording, places: Sequence[Place], aside: frozenset[int], rules: ResidualRules
) -> Drives:
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
    tip[np.abs(tip) <= LEVEL * np.abs(tip).max()] = 0.0
    of_payload = tip @ np.array(arm.gravity, dtype=float)
    carried = np.zeros((one.size, len(joints), CARRIED))
    carried[:, :, 0] = of_payload
    if one.payload_mass is not None:
        centred = loads(hung_at(bare, (last, (0.0, 0.0, 0.0))))
        for k, way in enumerate(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), start=1):
            carried[:, :, k] = loads(hung_at(bare, (last, way))) - centred
        carried *= one.payload_mass[:, None, None]
    pushed = 0.0 if one.force is None else np.einsum("vja,va->vj", tip, one.force)
    sensor_columns = [np.ones((one.size, arm.size))]
    if one.sides is not None:
        sensor_columns.append(one.sides)
    if recording.velocity is not None:
        sensor_columns.append(_by_visit(recording.velocity, visit, count))
    beside = np.stack(sensor_columns, axis=2)[:, joints]
    held = -_by_visit(recording.torque, visit, count)[:, joints]
    lacking = held - nothing - pushed
    return Drives(index, recording, joints, visit, lacking, of_one, carried, tip, beside, held)


def _by_visit(values: Array, visit: NDArray[np.int64], count: NDArray[np.int64]) -> Array:
    """The means (V, n) of values (N, n) over visits."""
    return np.stack([np.bincount(visit, weights=column) for column in values.T], axis=1) / count[:, None]


def _carrying_payload(arm: Arm, recording: Recording, numbers: Array, rules: ResidualRules) -> Recording:
    """A recording with its payload by a factor, and the moment about the tip that its centre makes (`numbers`)."""
    if recording.payload_mass is None or (numbers == np.eye(1, CARRIED)[0]).all():
        return recording
    link = undeformed(arm, recording, rules).frames.links[-1]
    ways = [columns(way, recording.size) for way in (link.along, link.height, link.width)]
    lever = np.einsum("k,kna->na", numbers[1:], np.stack(ways))
    moment = np.cross(recording.payload_mass[:, None] * lever, np.array(arm.gravity, dtype=float))
    return replace(recording, payload_mass=numbers[0] * recording.payload_mass, moment=moment)


def _unmade(loads: TorqueLoads, system: System, fitted: Fitted, rules: ResidualRules) -> tuple[tuple[int, float], ...]:
    """The drives whose load none of the loads make but for its scatter, each with the share of it that they leave."""
    names, shares = loads.recording.names, dict[int, float]()
    for one, left in zip(system.held, fitted.left, strict=True):
        rests = dict(zip(one.joints, left.T, strict=True))
        for torque in loads.torques:
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
    return float(np.linalg.norm(across)) <= LEVEL * float(np.linalg.norm(pull))
