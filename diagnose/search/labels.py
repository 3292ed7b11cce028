"""Labels that stand beside the wrong readings: sides or payloads logged a visit late or early, turned round or swapped,
the sides of two joints in each other's columns, payloads in another unit.

Where nothing in the library explains a mismatch, or it is only scatter, each such mistake is tried: the recording is
searched again with the labels put right, where a few of the library, taken one after the other, then explain most. A
mistake is told only where the physics then named, if any, leaves the noise floor, and with the labels as they stand
does not: else it is not the labels that explain anything.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.fitting.fit import fit, impossible, remaining
from linkwright.core.diagnose.fitting.prepare import Patterns, nuisances, packed_up, prepare, set_up
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.patterns.library import Candidate, candidates, columns_of
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed, rms_length
from linkwright.core.diagnose.residual.visits import visits
from linkwright.core.diagnose.result import Mislabelled
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.units import registry

from .naming import Namer, name_missing

_LEVELS, _SIDES, _TAKEN, _SEARCHED = 4, 3, 4, 3
"""Levels of payload of which every two are exchanged; pairs of joints whose sides are; causes of the library that are
taken to see how promising labels put right are; and how many of these are searched as a whole."""

_UNITS = (("lb", "lb"), ("N", "N/gn"), ("g", "g"))
"""In which a payload may have been written down, and as masses."""


@dataclass(frozen=True)
class _Tried:
    said: str
    recording: Recording


def mislabelled(
    logged: Observed, recording: Recording, asked: Options, floor: float, left: float, tell: Callable[[float], None]
) -> Mislabelled | None:
    """The mistake of labels that explains what is `left` (RMS, m) over a noise `floor` (RMS, m); None where none does.

    `logged` is the recording with its labels as they stand, bad rows set aside. The search is that of the diagnosis
    itself, by the same rules.
    """
    rules = asked.rules
    enough = min(rules.mistakes.label_leaves * left, rules.fitting.at_the_floor * floor)
    arm, about = logged.arm_given, logged.about
    tried = [*_relabelled(arm, recording, rules), *_crossed(observe(arm, recording, about=about, rules=rules))]

    def promises() -> Iterator[tuple[float, _Tried, Observed, Patterns]]:
        for number, item in enumerate(tried):
            tell(0.6 * number / len(tried))
            observed = observe(arm, item.recording, scale=logged.scale, about=about, rules=rules)
            patterns = packed_up(candidates(observed, asked.without))
            yield _promise(observed, patterns), item, observed, patterns

    namers: list[tuple[float, Namer, str]] = []
    for _, item, observed, patterns in heapq.nsmallest(_SEARCHED, promises(), key=itemgetter(0)):
        tell(0.6 + 0.1 * len(namers))
        prepared = prepare(observed, asked, floor, patterns)
        namer = Namer(prepared, thorough=False, seed=asked.seed)
        if prepared.pool.groups:
            answers = [(), *(subset.members for subset in namer.best_of_library().values())]
            namers.append((min(_left(namer, members) for members in answers), namer, item.said))
    rms, namer, said = min(namers, key=itemgetter(0), default=(np.inf, None, ""))
    if namer is None or rms > enough:
        return None
    named = name_missing(namer, lambda _: None)
    if named.outside:
        return None
    rms = _left(namer, named.members)
    groups = [namer.pool.groups[member].candidate for member in named.members]
    if _left_as_logged(logged, groups) <= enough:
        return None
    findings = tuple((candidate.effect, candidate.numbers) for candidate in groups)
    return Mislabelled(said, findings, rms) if rms <= enough else None


def _promise(observed: Observed, patterns: Patterns) -> float:
    """What a few of the library, taken one after the other, leave of a mismatch: mean square, weighed."""
    alone = set_up(observed, patterns)
    products, members, criterion = alone.products, list[int](), alone.criterion
    barred = np.zeros(len(alone.pool.groups), dtype=bool)
    while len(members) < _TAKEN and not barred.all():
        value = criterion.of_many(products.rss, products.gains(), criterion.price, criterion.ranks)
        best = int(np.argmin(np.where(barred, np.inf, value)))
        if not np.isfinite(value[best]):
            break
        members.append(best)
        barred[best] = True
        products = products.beside(alone.pool.columns([best]))
    return products.rss / max(len(alone.vector), 1)


def _left(namer: Namer, members: tuple[int, ...]) -> float:
    width = namer.prepared.observed.components
    return rms_length(remaining(namer.prepared, fit(namer.prepared, members))[:, :width])


def _left_as_logged(logged: Observed, named: Sequence[Candidate]) -> float:
    """The RMS length (m) of what some candidates leave of the tip with the labels as they stand, at possible sizes."""
    patterns = ((item, columns_of(logged, item)) for item in named)
    alone = set_up(logged, packed_up((item, columns) for item, columns in patterns if columns is not None))
    fitted = fit(alone, range(len(alone.pool.groups)))
    if impossible(alone, fitted) is not None:
        return np.inf
    return rms_length(remaining(alone, fitted)[:, : logged.components])


def _relabelled(arm: Arm, recording: Recording, rules: Rules) -> Iterator[_Tried]:
    """The recording with one mistake put right, each in turn."""
    visit = visits(recording, arm, rules=rules.residual)
    sides, payload = recording.sides, recording.payload_mass
    if sides is not None and len(np.unique(sides, axis=0)) > 1:
        for which, late in (("late", 1), ("early", -1)):
            for unit, source, keep in _sources(visit, late):
                sentence = f"the sides (dirN) were logged one {unit} {which}"
                yield _Tried(sentence, replace(recording, sides=sides[source]).kept(keep))
        yield _Tried("the sides (dirN) were logged with the opposite sign", replace(recording, sides=-sides))
    if payload is not None and len(levels := np.unique(payload)) > 1:
        for which, late in (("late", 1), ("early", -1)):
            for unit, source, keep in _sources(visit, late):
                sentence = f"payload_kg was logged one {unit} {which}"
                yield _Tried(sentence, replace(recording, payload_mass=payload[source]).kept(keep))
        for unit, weighed in _UNITS:
            mass = float(registry().convert(Decimal(1), weighed, "kg"))
            yield _Tried(f"payload_kg holds {unit}", replace(recording, payload_mass=payload * mass))
            yield _Tried(
                f"payload_kg was taken for {unit} and converted", replace(recording, payload_mass=payload / mass)
            )
        if len(levels) <= _LEVELS:  # of more nobody confuses just two
            for one, other in itertools.combinations(levels.tolist(), 2):
                sentence = f"payloads of {one:g} kg and {other:g} kg have changed places in payload_kg"
                yield _Tried(sentence, replace(recording, payload_mass=_swapped(payload, one, other)))


def _crossed(observed: Observed) -> Iterator[_Tried]:
    """The recording with the sides of two joints exchanged: those pairs where each one's sides tell most of how the
    other is off, beside what every joint's sides tell."""
    recording = observed.recording
    if recording.sides is None:
        return
    joints = range(recording.sides.shape[1])
    # How far a joint's motion to and fro moves the tip, by the sides of each joint.
    moved = [observed.drive_moved(joint)[:, :, None] * np.nan_to_num(recording.sides)[:, None, :] for joint in joints]
    columns = np.stack([moved[joint][:, :, joint] for joint in joints], axis=2)
    beside = orthonormal(observed.whitened(np.concatenate([nuisances(observed)[0], columns], axis=2)))
    left = observed.whitened(observed.residual)
    left -= beside @ (beside.T @ left)
    ranked: list[tuple[float, int, int]] = []
    for one, other in itertools.combinations(joints, 2):
        if np.array_equal(recording.sides[:, one], recording.sides[:, other]):
            continue
        crossed = observed.whitened(np.stack([moved[one][:, :, other], moved[other][:, :, one]], axis=2))
        crossed -= beside @ (beside.T @ crossed)
        ranked.append((float(np.sum((orthonormal(crossed).T @ left) ** 2)), one, other))
    for _, one, other in sorted(ranked, reverse=True)[:_SIDES]:
        sides = recording.sides.copy()
        sides[:, [one, other]] = sides[:, [other, one]]
        sentence = f"the sides of joints {one + 1} and {other + 1} stand in each other's columns (dirN)"
        yield _Tried(sentence, replace(recording, sides=sides))


def _sources(visit: NDArray[np.int64], late: int) -> Iterator[tuple[str, NDArray[np.int64], NDArray[np.bool_]]]:
    """From which row each row takes its label, where labels were logged one visit or one reading `late`, and the rows
    whose label is known then: not that of the first or the last."""
    last = int(visit[-1])
    first = np.searchsorted(visit, np.arange(last + 1))
    yield "visit", first[np.clip(visit + late, 0, last)], (visit + late >= 0) & (visit + late <= last)
    if len(first) < len(visit):  # else a reading is a visit
        rows = np.arange(len(visit)) + late
        yield "reading", np.clip(rows, 0, len(visit) - 1), (rows >= 0) & (rows < len(visit))


def _swapped(payload: Array, one: float, other: float) -> Array:
    return np.where(payload == one, other, np.where(payload == other, one, payload))
