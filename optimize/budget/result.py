"""The error budget of an arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.avoid.obstacle import Obstacle
from linkwright.core.arm.avoid.poses import NoRoom, Room, room_of
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.optimize.robust.search import upper_rank
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .parts import Owner, Parts, parts_of
from .sample import ALL, Chosen, Draws, Heard, causes, errors, owners, quantile
from .sheet import Option, Sheet

_POSES = 64
_LOOKED_AT, _ARMS = 1024, 40
"""Poses at which so many arms are looked at for their worst."""
_HALF = 0.5
_LEAST = 1e-3
"""A gain below this share of the worst error is none."""


@dataclass(frozen=True)
class Cause:
    """What a cause alone does: at the worst pose what the share of arms does not exceed, its root mean square over the
    poses and arms (both m), and its part of the mean square of all causes alone."""

    name: str
    at_worst: float
    average: float
    share: float


@dataclass(frozen=True)
class Gain:
    """What a better part brings: how much less (m) the worst error that the share of arms keeps is, and the average.

    `owner` is the joint or link that is made twice as good; of a part that could be bought it is None, with its `name`,
    its `price` (EUR) and what a euro of it buys (m).
    """

    owner: Owner | None
    name: str
    worst: float
    average: float
    price: float | None = None

    @property
    def per_euro(self) -> float | None:
        """How much less the worst error is for a euro, m."""
        return None if self.price is None else self.worst / self.price


@dataclass(frozen=True)
class Budget:
    """What an arm is to be expected to err by, in m, to first order.

    `worst` is the worst error over the poses that the sheet's share of arms keeps (`worst_upper`: with 95 % confidence,
    None where the draws are too few), `median` that of half of them, `average` the root mean square over arms and
    poses; `nominal` the worst of the arm exactly as on paper. `pose` and `load_case` (from 1) are where the share of
    arms errs most, `at_worst` by how much. `halved` are joints and links made twice as good, `options` parts to be
    bought, both by what they bring. `samples` are the worst errors of all arms, sorted. `room` is
    where the poses looked at may put the arm.
    """

    arm: Arm
    sheet: Sheet
    load_cases: tuple[LoadCase, ...]
    poses: int
    nominal: float
    worst: float
    worst_upper: float | None
    median: float
    average: float
    pose: tuple[float, ...]
    load_case: int
    at_worst: float
    causes: tuple[Cause, ...]
    halved: tuple[Gain, ...]
    options: tuple[Gain, ...]
    samples: tuple[float, ...]
    unwarmed: tuple[int, ...]
    room: Room


def budget(
    arm: Arm,
    sheet: Sheet,
    workspace: Workspace | None = None,
    load_cases: Sequence[LoadCase] = (),
    *,
    avoid: Sequence[Obstacle] = (),
    progress: Heard | None = None,
) -> Budget:
    """The budget of an arm over a workspace (its joint ranges by default) and load cases (its payload by default),
    at poses that keep out of what the arm's file and `avoid` name.

    Raises `PropertyNeeded` or `MissingProperty` where the arm lacks a figure, `Unreachable` where the workspace cannot
    be reached, `NoRoom` where what is to be avoided leaves no pose, `InputError` where errors count from a
    calibrated state.
    """
    cases = tuple(load_cases) or arm.cases
    if any(case.relative_to is not None for case in cases):
        raise InputError("", "relative_to", "goes without a budget, which is of the whole error")
    report = progress or _silent
    room = room_of(arm, None, avoid)
    poses, evenly = _poses(arm, sheet, workspace or Workspace(), cases, room)
    parts = parts_of(arm, sheet, poses, cases)
    spread = _spread(len(poses), evenly, len(cases))
    named = causes(parts)
    if not named:
        would_do = "stiffness, backlash or clearance of joints, sections of links, or a sheet with tolerances"
        raise InputError("", "", f"{arm.name} has no data of anything that errs; give {would_do}")
    draws = Draws(sheet.seed, sheet.draws, parts.states)
    result = errors(parts, draws)
    quantile_worst = quantile(result, sheet.share)
    place = int(np.argmax(quantile_worst))
    worst, average = _figures(result, sheet.share, spread)
    samples = np.sort(result.max(axis=1))
    upper = upper_rank(sheet.share, sheet.draws)
    places = owners(parts)
    done, steps = 0, len(named) + len(places) + len(sheet.options)
    alone: list[tuple[str, float, float]] = []
    for name in named:
        report(f"what {name} does alone", done / steps)
        each = errors(parts, draws, Chosen(cause=name))
        alone.append((name, float(quantile(each, sheet.share)[place]), _root_mean_square(each[:, spread])))
        done += 1
    whole = sum(value**2 for _, _, value in alone) or 1.0
    halved: list[Gain] = []
    for owner in places:
        report(f"a better {owner[0]} {owner[1] + 1}", done / steps)
        better = _figures(errors(parts, draws, Chosen(better={owner: _HALF})), sheet.share, spread)
        halved.append(Gain(owner, f"{owner[0]} {owner[1] + 1}", worst - better[0], average - better[1]))
        done += 1
    options: list[Gain] = []
    for option in sheet.options:
        report(f"with {option.name}", done / steps)
        better = _with_option(option, poses, cases, spread)
        options.append(Gain(None, option.name, worst - better[0], average - better[1], option.price))
        done += 1
    nominal = errors(parts, Draws(sheet.seed, 1, parts.states), Chosen(tolerances=False))
    return Budget(
        arm=arm,
        sheet=sheet,
        load_cases=cases,
        poses=len(poses),
        nominal=float(nominal.max()),
        worst=worst,
        worst_upper=None if upper is None else float(samples[upper - 1]),
        median=float(quantile(samples, 0.5)),
        average=average,
        pose=tuple(poses[place % len(poses)].tolist()),
        load_case=place // len(poses) + 1,
        at_worst=float(quantile_worst[place]),
        causes=tuple(
            sorted((Cause(name, top, mean, mean**2 / whole) for name, top, mean in alone), key=lambda x: -x.at_worst)
        ),
        halved=tuple(sorted((item for item in halved if item.worst > _LEAST * worst), key=lambda x: -x.worst)),
        options=tuple(sorted(options, key=_worth)),
        samples=tuple(samples.tolist()),
        unwarmed=parts.unwarmed,
        room=room,
    )


def _silent(text: str, share: float) -> None:
    del text, share


def _worth(gain: Gain) -> tuple[bool, float]:
    """What brings most for a euro goes first; without a price, after those, what brings most."""
    per_euro = gain.per_euro
    return per_euro is None, -(gain.worst if per_euro is None else per_euro)


def _root_mean_square(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _figures(samples: Array, share: float, spread: NDArray[np.bool_]) -> tuple[float, float]:
    return float(quantile(samples.max(axis=1), share)), _root_mean_square(samples[:, spread])


def _spread(poses: int, evenly: int, loads: int) -> NDArray[np.bool_]:
    """Which states are those spread over the workspace: the last of each load case. The average is over them alone."""
    return np.tile(np.arange(poses) >= poses - evenly, loads)


def _with_option(
    option: Option, poses: Array, cases: Sequence[LoadCase], spread: NDArray[np.bool_]
) -> tuple[float, float]:
    parts: Parts = parts_of(option.arm, option.sheet, poses, cases)
    worst = errors(parts, Draws(option.sheet.seed, option.sheet.draws, parts.states), ALL)
    return _figures(worst, option.sheet.share, spread)


def _poses(arm: Arm, sheet: Sheet, workspace: Workspace, cases: Sequence[LoadCase], room: Room) -> tuple[Array, int]:
    """The worst poses of the arm as on paper and of some drawn arms, as far as these keep to their room; then others
    spread over its workspace, and how many those are."""
    search = WorstSearch(error_model(arm, cases), workspace)
    p = beam_values(beams_of(arm, cases))
    worst = np.array([pose.q for pose in search.worst(p, certify=False).poses])
    worst = worst[room.allows(arm, worst)]
    spread = search.poses(p, _LOOKED_AT)
    spread = np.vstack([spread[room.allows(arm, spread)], worst])
    others = search.poses(p, _POSES) if room.everywhere else spread[: len(spread) - len(worst)][:_POSES]
    evenly = others[:_POSES] if workspace.kind == "joints" else others  # the rest are corners
    if not len(evenly):
        raise NoRoom(f"what is to be avoided leaves none of {_LOOKED_AT} poses of the workspace")
    parts = parts_of(arm, sheet, spread, cases)
    result = errors(parts, Draws(sheet.seed, _ARMS, parts.states))
    of_arms = spread[np.unique(result.argmax(axis=1) % len(spread))]
    return np.vstack([worst, of_arms, others[len(evenly) :], evenly]), len(evenly)
