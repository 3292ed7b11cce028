"""What links of unknown mass weigh, by the measured torques of the drives.

What a drive holds is linear in masses at places on the links (C. G. Atkeson, C. H. An & J. M. Hollerbach, Int. J.
Robot. Res. 5(3) (1986) 101, doi:10.1177/027836498600500306). Torques at rest tell first moments, and no masses: of all
masses that make the measured loads those are taken that lie along the links, none below zero (C. L. Lawson & R. J.
Hanson, Solving Least Squares Problems, 1974, ch. 23), alike where nothing tells them apart; masses beside the links
where those along them do not make the loads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from linkwright.core.arm.chain.balance import PointMass
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

from .torque import loads_on_drives
from .visits import visits

Place = tuple[int, tuple[float, float, float]]
"""A link (from 0) and a point on it, from its joint: along it, along its section's height and its width, m."""

_ALIKE = 1e-4
"""Of the largest column's length: how strongly masses are held alike where torques do not tell them apart."""
_NOTHING = 1e-9


@dataclass(frozen=True)
class Held:
    """What one drive's torque (joint from 0) says of a recording: `lacking` (V,) what it holds beyond friction, a
    constant of its sensor and all that is known to weigh on it, by visit; `of_one` (V, P) what one kilogram at each
    place adds, beyond what friction and constant take up; both over `scatter` (N*m, N). `unscaled` (V, P) is the latter
    as it is, `load` (V,) all that the drive holds."""

    joint: int
    lacking: Array
    of_one: Array
    scatter: float
    unscaled: Array
    load: Array


@dataclass(frozen=True)
class Weighed:
    """An arm with the weights that torques show: `links` (from 0) got masses, `untold` are those that load no drive.
    `drives` are the joints (from 0) by whose torques, each with the largest load (N*m, N) that these links put on it
    and the standard error of a compliance that is judged by it, as a share. `beside` says that masses lie off the
    links' lines."""

    arm: Arm
    links: tuple[int, ...]
    untold: tuple[int, ...]
    drives: tuple[tuple[int, float, float], ...]
    beside: bool


def weighed_by_torque(arm: Arm, recording: Recording, *, rules: ResidualRules = RULES.residual) -> Weighed | None:
    """The arm with the weights that a recording's torques show for its links of unknown mass; None where there are no
    such links or torques, or these tell nothing."""
    lacking = of_unknown_mass(arm)
    if not lacking or arm.branches:
        return None
    places = _places(arm, lacking, rules)
    held = [item for one in recording.singles for item in held_by_drives(arm, one, places, rules=rules)]
    if not held:
        return None
    along = np.array([not any(place[1:]) for _, place in places])
    fits = {beside: masses(held, along | beside) for beside in (False, True)}
    rows = sum(len(item.lacking) for item in held)
    count = {beside: int(np.sum(fits[beside] > 0.0)) for beside in fits}
    # Schwarz's criterion, which more masses must better beyond doubt.
    worth = {beside: rows * np.log(misfit(held, fits[beside])) + count[beside] * np.log(rows) for beside in fits}
    beside = bool(worth[True] < worth[False] - rules.torque_sure**2)
    return _of_masses(arm, places, held, fits[beside], rules)


def _places(arm: Arm, lacking: Sequence[int], rules: ResidualRules) -> list[Place]:
    """Where the masses of these links may lie: at their joints, in their middles and at their ends, and beside them."""
    reach = sum(arm.lengths)
    places: list[Place] = []
    for k in lacking:
        length = arm.links[k].length
        off = max(length / 2.0, rules.mass_beside * reach)
        places += [(k, (share * length, 0.0, 0.0)) for share in (0.0, 0.5, 1.0)]
        places += [(k, (length / 2.0, *way)) for way in ((off, 0.0), (-off, 0.0), (0.0, off), (0.0, -off))]
    return places


def held_by_drives(
    arm: Arm, recording: Recording, places: Sequence[Place], *, rules: ResidualRules = RULES.residual
) -> list[Held]:
    """What each drive of a recording holds that links of unknown mass may put on it; none without torques."""
    if recording.torque is None:
        return []
    known = _weightless(arm)
    number = np.unique(visits(recording, arm, rules=rules), return_inverse=True)[1].reshape(-1)
    count = np.bincount(number)
    one = recording.kept(np.isin(np.arange(recording.size), np.unique(number, return_index=True)[1]))

    def loads(of: Arm, *, bare: bool) -> Array:
        return loads_on_drives(of, one, payload=not bare, rules=rules)

    whole, bare = loads(known, bare=False), loads(known, bare=True)
    of_one = np.stack([loads(hung_at(known, place), bare=True) - bare for place in places], axis=2)
    held: list[Held] = []
    for joint in range(arm.size):
        torque = np.bincount(number, weights=recording.torque[:, joint]) / count
        beside = [np.ones(one.size)]
        if one.sides is not None:
            beside.append(one.sides[:, joint])
        if recording.velocity is not None:
            beside.append(np.bincount(number, weights=recording.velocity[:, joint]) / count)
        design = np.column_stack(beside)

        def left(values: Array, design: Array = design) -> Array:
            return values - design @ np.linalg.lstsq(design, values, rcond=_NOTHING)[0]

        columns = left(of_one[:, joint, :])
        # Which way weights pull a drive does not show where they never change: a joint upright.
        if float(np.std(columns, axis=0).max()) <= _NOTHING:
            continue
        lacking = left(-torque - whole[:, joint])
        free = lacking - columns @ np.linalg.lstsq(columns, lacking, rcond=_NOTHING)[0]
        freedom = one.size - len(beside) - int(np.linalg.matrix_rank(columns))
        if freedom < rules.enough_freedom:
            continue
        scatter = max(float(np.sqrt(np.sum(free**2) / freedom)), _NOTHING + 1e-6 * float(np.std(lacking)))
        held.append(Held(joint, lacking / scatter, columns / scatter, scatter, of_one[:, joint, :], -torque))
    return held


def masses(held: Sequence[Held], usable: NDArray[np.bool_]) -> Array:
    """The masses (P,), kg, at usable places that make best what drives hold, none below zero."""
    design = np.concatenate([item.of_one for item in held])[:, usable]
    size = float(np.linalg.norm(design, axis=0).max())
    design = np.concatenate([design, _ALIKE * size * np.eye(design.shape[1])])
    target = np.concatenate([*(item.lacking for item in held), np.zeros(design.shape[1])])
    solution = np.zeros(len(usable))
    solution[usable] = nnls(design, target, maxiter=50 * len(usable))[0]
    return solution


def against_any_masses(arm: Arm, recording: Recording, *, rules: ResidualRules = RULES.residual) -> tuple[Held, ...]:
    """The drives whose torque goes against whatever the links of unknown mass may weigh: the other way round, masses
    make most of it, and as it is they make nothing."""
    if arm.branches:
        return ()
    if recording.torque is None:
        return ()
    turned, places = replace(recording, torque=-recording.torque), _places(arm, of_unknown_mass(arm), rules)
    as_is, other = (held_by_drives(arm, one, places, rules=rules) for one in (recording, turned))

    def explained(held_load: Held) -> float:
        """The share that masses make of what a drive holds."""
        left = held_load.lacking - held_load.of_one @ masses(
            [held_load], np.ones(held_load.of_one.shape[1], dtype=bool)
        )
        return 1.0 - float(left @ left) / max(float(held_load.lacking @ held_load.lacking), _NOTHING)

    least = -rules.torque_against
    return tuple(
        one for one, way in zip(as_is, other, strict=True) if explained(one) < 1.0 - least and explained(way) > least
    )


def misfit(held: Sequence[Held], masses_fitted: Array) -> float:
    """The mean square of what masses leave of what drives hold, over its scatter."""
    return float(np.mean(np.concatenate([item.lacking - item.of_one @ masses_fitted for item in held]) ** 2))


def _weightless(arm: Arm) -> Arm:
    """The arm with nothing for the masses that nobody knows."""
    lacking = of_unknown_mass(arm)
    return arm.with_links(
        tuple(replace(link, mass=0.0) if index in lacking else link for index, link in enumerate(arm.links))
    )


def hung_at(arm: Arm, place: Place) -> Arm:
    """The arm with a kilogram more at a place."""
    index, at = place
    link = arm.links[index]
    heavier = replace(link, masses=(*link.masses, PointMass(1.0, at)))
    return arm.with_links((*arm.links[:index], heavier, *arm.links[index + 1 :]))


def carrying(arm: Arm, solution: Sequence[tuple[Place, float]]) -> Arm:
    """The arm, its links there weightless, with masses (kg) at places: along a link as its mass and centre, those
    beside it as one."""
    links = list(arm.links)
    for index, link in enumerate(links):
        carried = [(place, mass) for (of, place), mass in solution if of == index and mass > 0.0]
        along = [(place, mass) for place, mass in carried if not any(place[1:])]
        whole = sum(mass for _, mass in along)
        if not carried:
            continue
        first = sum(place[0] * mass for place, mass in along)
        off = [(place, mass) for place, mass in carried if any(place[1:])]
        hung = sum(mass for _, mass in off)
        x, y, z = (sum(place[axis] * mass for place, mass in off) / (hung or 1.0) for axis in range(3))
        further = (PointMass(hung, (x, y, z)),) if hung else ()
        center = first / whole if whole else None
        links[index] = replace(link, mass=whole, center_of_mass=center, masses=(*link.masses, *further))
    return arm.with_links(tuple(links))


def _of_masses(
    arm: Arm, places: Sequence[Place], held: Sequence[Held], solution: Array, rules: ResidualRules
) -> Weighed | None:
    links = [k for k in of_unknown_mass(arm) if any(_seen(item, places, k, rules) for item in held)]
    if not links:
        return None
    put = [(place, mass) for place, mass in zip(places, solution.tolist(), strict=True) if place[0] in links]
    known = arm.with_links(tuple(replace(link, mass=0.0) if k in links else link for k, link in enumerate(arm.links)))
    spread = np.linalg.pinv(sum(item.of_one.T @ item.of_one for item in held), rcond=_NOTHING, hermitian=True)
    spread = spread * max(misfit(held, solution), 1.0)
    drives: list[tuple[int, float, float]] = []
    for each in held:
        load = each.unscaled @ solution
        share = each.unscaled.T @ each.load / float(each.load @ each.load)
        drives.append((each.joint, float(np.abs(load).max()), float(np.sqrt(max(share @ spread @ share, 0.0)))))
    beside = any(any(place[1:]) and mass > 0.0 for (_, place), mass in put)
    untold = tuple(k for k in of_unknown_mass(arm) if k not in links)
    return Weighed(carrying(known, put), tuple(links), untold, tuple(drives), beside)


def _seen(held: Held, places: Sequence[Place], link: int, rules: ResidualRules) -> bool:
    """Whether a drive's torque shows what a link weighs."""
    indices = [k for k, (of, _) in enumerate(places) if of == link]
    whole = float(np.linalg.norm(held.of_one, axis=0).max())
    return float(np.linalg.norm(held.of_one[:, indices], axis=0).max()) > rules.torque_seen * whole
