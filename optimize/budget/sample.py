"""Arms drawn from their tolerances, and what each cause alone would do."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from linkwright.core.arm.errors.lost_motion import farthest_by_fan, played
from linkwright.core.arm.errors.model import PoseArrays
from linkwright.core.sections.numeric import Array

from .parts import REPEATABILITY, Owner, Parts, Play, backlash_width, generator_of

_ROWS = 20_000
"""States times arms at once."""


@dataclass(frozen=True)
class Chosen:
    """Which parts of an error count, by cause (None: all), and by what they are multiplied at some owners: how much
    better a joint or link is made. With `tolerances` off every arm is as drawn on paper."""

    cause: str | None = None
    better: dict[Owner, float] = field(default_factory=dict[Owner, float])
    tolerances: bool = True

    def weight(self, cause: str, owner: Owner) -> float:
        """0 for what does not count."""
        return self.better.get(owner, 1.0) if self.cause in (None, cause) else 0.0


ALL = Chosen()


@dataclass(frozen=True)
class Draws:
    """The numbers (A,) of A arms by their keys, between -1 and 1; anew at every one of S states (A, S) where asked."""

    seed: int
    arms: int
    states: int

    def once(self, key: str) -> Array:
        """One number for each arm."""
        return generator_of(self.seed, key).uniform(-1.0, 1.0, self.arms)

    def each_time(self, key: str) -> Array:
        """One number for each arm and state."""
        return generator_of(self.seed, key).uniform(-1.0, 1.0, (self.arms, self.states))

    def scatter(self) -> Array:
        """Normal displacements (A, S, 3) of unit standard deviation."""
        return generator_of(self.seed, REPEATABILITY).standard_normal((self.arms, self.states, 3))


def errors(parts: Parts, draws: Draws, chosen: Chosen = ALL) -> Array:
    """The error (A, S) in m of each arm at each state, play counted as the arm's mode says."""
    vectors = _vectors(parts, draws, chosen)
    play = [item for item in parts.play if chosen.weight(item.cause, item.owner) > 0.0]
    if not play:
        return np.sqrt(np.einsum("asi,asi->as", vectors, vectors))
    looser = {
        k: 1.0 + width * draws.once(f"backlash {owner}") * (chosen.tolerances)
        for k, (width, owner) in enumerate((backlash_width(parts, item), item.owner) for item in play)
    }
    samples: list[Array] = []
    step = max(1, _ROWS // parts.states)
    for start in range(0, draws.arms, step):
        rows = slice(start, start + step)
        scales = [chosen.weight(item.cause, item.owner) * looser[k][rows] for k, item in enumerate(play)]
        samples.append(_played(parts, vectors[rows], play, scales))
    return np.concatenate(samples)


def _played(parts: Parts, vectors: Array, play: list[Play], scales: list[Array]) -> Array:
    arms, states = vectors.shape[:2]
    intervals = [k for k, item in enumerate(play) if item.radius is None]
    discs = [k for k, item in enumerate(play) if item.radius is not None]
    count = arms * states

    def rows(values: Iterable[Array], width: int) -> Array:
        held = [np.broadcast_to(value, (arms, states, width)).reshape(count, width) for value in values]
        return np.stack(held, axis=1) if held else np.zeros((count, 0, width))

    reach = rows((scales[k][:, None, None] * play[k].vector[None] for k in intervals), 3)
    seating = rows((play[k].seating[None, :, None] for k in intervals), 1)[:, :, 0]
    normals = rows((play[k].vector[None] for k in discs), 3)
    loads = rows((play[k].seating[None] for k in discs), 3)
    arrays = PoseArrays(vectors.reshape(count, 3), reach, seating, normals, loads, np.tile(parts.load_scale, arms))
    # Discs have one radius whatever the arm; only what is chosen changes it.
    radii = np.array([(play[k].radius or 0.0) * float(scales[k][0]) for k in discs])
    if parts.arm.play == "worst" and discs and not parts.planar:
        return farthest_by_fan(arrays, radii).reshape(arms, states)
    error = played(arrays, radii, parts.arm.play, planar=parts.planar, statistics=parts.arm.statistics)
    return error.error.reshape(arms, states)


def _vectors(parts: Parts, draws: Draws, chosen: Chosen) -> Array:
    """The error vectors (A, S, 3) without play."""
    total = np.zeros((draws.arms, parts.states, 3))
    for item in parts.fixed:
        weight = chosen.weight(item.cause, item.owner)
        if weight == 0.0:
            continue
        width = 0.0 if item.factor is None else parts.widths.get((item.factor, item.owner[1]), 0.0)
        if width == 0.0 or not chosen.tolerances:
            total += weight * item.vector[None]
        else:
            better = chosen.better.get(item.owner, 1.0)
            softer = 1.0 / (1.0 + better * width * draws.once(f"{item.factor} {item.owner}"))
            total += weight * softer[:, None, None] * item.vector[None]
    if not chosen.tolerances:
        return total
    for item in parts.varying:
        weight = chosen.weight(item.cause, item.owner)
        if weight == 0.0:
            continue
        number = (draws.each_time(item.key) if item.each_time else draws.once(item.key)[:, None])[:, :, None]
        total += weight * number * item.vector[None]
        if item.bent is not None:
            total += weight * number**2 * item.bent[None]
    scatter = chosen.weight(REPEATABILITY, ("tip", -1)) * parts.scatter
    if scatter > 0.0:
        moved = scatter * draws.scatter()
        if parts.planar:
            moved[:, :, 2] = 0.0
        total += moved
    return total


def causes(parts: Parts) -> tuple[str, ...]:
    """All causes of an error, each once, in the order in which they were found."""
    named = [item.cause for group in (parts.fixed, parts.play, parts.varying) for item in group]
    return tuple(dict.fromkeys([*named, *([REPEATABILITY] if parts.scatter > 0.0 else [])]))


def owners(parts: Parts) -> tuple[Owner, ...]:
    """The joints and links that have any part in the error, from the base out."""
    named = {item.owner for group in (parts.fixed, parts.play, parts.varying) for item in group}
    return tuple(sorted((item for item in named if item[1] >= 0), key=lambda item: (item[1], item[0])))


def quantile(values: Array, share: float) -> Array:
    """What a share of the values along the first axis does not exceed: the smallest that so many are below or at."""
    place = min(len(values), max(1, int(np.ceil(share * len(values) - 1e-9))))
    return np.partition(values, place - 1, axis=0)[place - 1]


Heard = Callable[[str, float], None]
"""Told what is being done and which share of it is done."""
