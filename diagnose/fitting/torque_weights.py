"""Weights of links by the measured torques, for the arm file whose compliance was judged by those torques.

What a drive holds is linear in the links' masses and first moments (C. G. Atkeson, C. H. An & J. M. Hollerbach, Int. J.
Robot. Res. 5(3) (1986) 101, doi:10.1177/027836498600500306). Not every combination of them loads a drive: each is held
near what the file says as strongly as anybody knows it, so that torques move no other. Masses go first, centres where
masses alone do not make the loads that were measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Link
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.residual.torque import DriveTorque
from linkwright.core.diagnose.several.recordings import Several
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import format_quantity


@dataclass(frozen=True)
class _Loads:
    """What the drives hold beyond what the file's weights make them, `lacking` (V,), and what a share of each link's
    mass (and a share of its length that its centre moves by) would add, `mass` and `centre` (V, L), all over their
    scatter; `drive` (V,) is which of the drives' torques each is of."""

    lacking: Array
    mass: Array
    centre: Array
    drive: Array


def with_weights(observed: Observed, corrected: Arm, of: str = "") -> tuple[Arm, tuple[str, ...]]:
    """A corrected arm with the weights that the torques show, where compliance was judged by them, and what is said of
    that. Where no weights of its links make those loads, the compliance stays if what the file's own make is nearer to
    what was measured than no load at all, and goes else. `of` takes one recording's torques."""
    usable = [
        torque
        for torque in observed.torques
        if of in ("", torque.of) and (torque.instead or not _off(torque, observed))
    ]
    judged = {item.joint for item in usable if item.instead}
    written = [entry for entry in corrected.effects if _gives(entry, judged, observed.arm)]
    if not written:
        return corrected, ()
    links = [k for k, link in enumerate(observed.arm.links) if not link.elastic and link.mass and link.length > 0.0]
    loads = _loads(observed, usable, links)
    for centres in (False, True):
        changed, errors = _fitted(observed, loads, links, centres=centres)
        arm = corrected.with_links(
            tuple(_weighing(link, changed[k]) if k in changed else link for k, link in enumerate(corrected.links))
        )
        if all(_possible(corrected.links[k], arm.links[k]) for k in changed) and _borne_out(
            observed, loads, usable, changed, links
        ):
            return arm, _said(observed, arm, links, errors, centres=centres)
    places = judged & {number - 1 for entry in written for number in entry.at} or judged
    at, many = ", ".join(str(joint + 1) for joint in sorted(places)), len(places) > 1
    why = (
        "that is judged by the measured torque, and no masses and centres along its rigid links make that load (a "
        "payload, a counterbalance or what lies beside the links does)."
    )
    beside = max(_not_made(observed, item) for item in usable if item.instead and item.joint in places)
    if beside < 1.0:
        return corrected, (
            f"The corrected arm has drive{'s' if many else ''} {at} give under a load that is {100.0 * beside:.2g} % "
            f"off what was measured: {why}",
        )
    effects = tuple(entry for entry in corrected.effects if entry not in written)
    return replace(corrected, effects=effects), (
        f"The corrected arm lacks how drive{'s' if many else ''} {at} give{'' if many else 's'}: {why}",
    )


def _not_made(observed: Observed, drive: DriveTorque) -> float:
    """What the file's weights do not make of the load that a drive's torque shows, RMS, as a share of it."""
    rows = _rows(observed, drive)
    model = np.broadcast_to(np.asarray(observed.nominal.joints[drive.joint].drive_load), (observed.rows,))
    return float(np.linalg.norm(drive.held - model[rows]) / np.linalg.norm(drive.held))


def _rows(observed: Observed, drive: DriveTorque) -> NDArray[np.bool_]:
    """The readings that a torque is of."""
    recording = observed.recording
    if isinstance(recording, Several) and observed.which is not None and drive.of:
        return observed.which == recording.names.index(drive.of)
    return np.ones(recording.size, dtype=bool)


def _off(drive: DriveTorque, observed: Observed) -> bool:
    """Whether a torque goes against the weights."""
    return any(
        factor is not None and factor.differs(observed.rules.residual) for factor in (drive.links, drive.payload)
    )


def _gives(entry: EffectEntry, judged: set[int], arm: Arm) -> bool:
    """Whether that is how a drive gives under the load that was measured, and none of the file's own."""
    effect = EFFECTS[entry.effect]
    mine = effect.place == "joint" and effect.cause == "flexibility" and entry not in arm.effects
    return mine and bool(judged & {number - 1 for number in entry.at} or (judged and not entry.at))


def _loads(observed: Observed, told: Sequence[DriveTorque], links: Sequence[int]) -> _Loads:
    """The loads of the drives at each visit's first reading."""
    arm, recording = observed.arm, observed.recording
    once = np.zeros(recording.size, dtype=bool)
    once[np.unique(observed.block, return_index=True)[1]] = True

    def drives(links_of: tuple[Link, ...]) -> Array:
        other = arm.with_links(links_of)
        state = solve(
            other,
            [recording.q[:, index] for index in range(arm.size)],
            beams_of(other),
            payload_mass=np.zeros(recording.size),
            tip_force=(0.0, 0.0, 0.0),
        )
        loads = [np.broadcast_to(np.asarray(joint.drive_load), (recording.size,)) for joint in state.joints]
        return np.stack(loads, axis=1)

    def changed(k: int, change: tuple[float, float]) -> Array:
        return drives((*arm.links[:k], _weighing(arm.links[k], change), *arm.links[k + 1 :])) - bare

    bare = drives(arm.links)
    heavier = np.stack([changed(k, (1.0, 0.0)) for k in links], axis=2) if links else np.zeros((*bare.shape, 0))
    further = np.stack([changed(k, (0.0, 1.0)) for k in links], axis=2) if links else np.zeros((*bare.shape, 0))
    lacking, mass, centre, drive = list[Array](), list[Array](), list[Array](), list[Array]()
    for place, item in enumerate(told):
        own = _rows(observed, item)
        held, rows = np.zeros(recording.size), own & once
        held[own] = item.held
        model = np.broadcast_to(np.asarray(observed.nominal.joints[item.joint].drive_load), (recording.size,))
        # Torques that are met to the last digit are still those of a real sensor.
        over = 1.0 / max(item.scatter, observed.rules.residual.torque_seen * item.spread)
        lacking.append(over * (held - model)[rows])
        mass.append(over * heavier[rows, item.joint])
        centre.append(over * further[rows, item.joint])
        drive.append(np.full(int(rows.sum()), place))
    return _Loads(np.concatenate(lacking), np.concatenate(mass), np.concatenate(centre), np.concatenate(drive))


def _fitted(
    observed: Observed, loads: _Loads, links: Sequence[int], *, centres: bool
) -> tuple[MappingProxyType[int, tuple[float, float]], Array]:
    """By how large a share of its mass each link is heavier, and by what share of its length times its file's mass its
    first moment is more; and how well the masses are known (shares, standard errors)."""
    rules = observed.rules.fitting
    design = np.concatenate([loads.mass, loads.centre], axis=1) if centres else loads.mass
    usual = np.repeat([1.0, rules.centre_off], len(links))[: design.shape[1]]
    curvature = design.T @ design + np.diag(1.0 / usual**2)
    solution = np.linalg.solve(curvature, design.T @ loads.lacking)
    errors = np.sqrt(np.diag(np.linalg.inv(curvature)))[: len(links)]
    shift = solution[len(links) :] if centres else np.zeros(len(links))
    pairs = zip(links, solution[: len(links)].tolist(), shift.tolist(), strict=True)
    return MappingProxyType({k: (more, moved) for k, more, moved in pairs}), errors


def _weighing(link: Link, change: tuple[float, float]) -> Link:
    """A rigid link that is heavier by a share of its mass, its first moment more by a share of mass times length
    beyond what that makes of it."""
    assert link.mass is not None
    middle = 0.5 * link.length if link.center_of_mass is None else link.center_of_mass
    more, moved = change
    mass = link.mass * (1.0 + more)
    if moved == 0.0 or mass <= 0.0:
        return replace(link, mass=mass)
    return replace(link, mass=mass, center_of_mass=middle + link.mass * moved * link.length / mass)


def _possible(before: Link, after: Link) -> bool:
    """Whether a file may say so: a mass, and a centre no further off than the link is long, or where it was."""
    centre = after.center_of_mass
    there = centre is None or centre == before.center_of_mass or abs(centre) <= after.length
    return after.mass is not None and after.mass > 0.0 and there


def _borne_out(
    observed: Observed,
    loads: _Loads,
    drives: Sequence[DriveTorque],
    changed: MappingProxyType[int, tuple[float, float]],
    links: Sequence[int],
) -> bool:
    """Whether the weights make the load on each drive that is judged by it, but for its scatter."""
    shares = np.array([changed[k] for k in links]).reshape(-1, 2)
    left = loads.lacking - loads.mass @ shares[:, 0] - loads.centre @ shares[:, 1]
    rules = observed.rules.residual
    for place, drive in enumerate(drives):
        least = max(drive.scatter, rules.torque_seen * drive.spread)
        beyond = max(float(np.mean(left[loads.drive == place] ** 2)) - 1.0, 0.0) ** 0.5 * least
        if drive.instead and beyond > rules.torque_seen * drive.spread:
            return False
    return True


def _said(observed: Observed, arm: Arm, links: Sequence[int], errors: Array, *, centres: bool) -> tuple[str, ...]:
    """What the file holds of weights now, and what of it the torques do not show."""
    rules, parts, guessed = observed.rules.fitting, list[str](), list[str]()
    for k, error in zip(links, errors.tolist(), strict=True):
        before, after = observed.arm.links[k].mass or 0.0, arm.links[k].mass or 0.0
        if error > rules.telling:
            guessed.append(str(k + 1))
        if abs(after - before) > error * before:
            within = f"within {100.0 * 1.96 * error:.2g} %"
            parts.append(f"link {k + 1} {format_quantity(after, 'mass', digits=3)} ({within})")
    sentences = [f"The corrected arm has the weights that the torques show: {', '.join(parts)}."] if parts else []
    if centres:
        sentences.append(
            "Masses alone do not make the measured loads: centres of mass along the links are changed too."
        )
    if guessed:
        sentences.append(
            f"Of link{'s' if len(guessed) > 1 else ''} {', '.join(guessed)} the torques tell the mass not by itself, "
            "only what it adds to the drives' loads with the others: what else it weighs stays near the file's."
        )
    return tuple(sentences)
