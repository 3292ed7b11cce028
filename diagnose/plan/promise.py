"""What a recording at given readings will show, by the diagnosis' test, patterns and criterion.

Nothing of the search is asked: the readings are taken as they stand in the file, a sound arm is simulated at them, and
the gate is calibrated on its noise as a diagnosis would.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.answer.detectable import detectable, is_plain, largest_size
from linkwright.core.diagnose.fitting.prepare import Prepared, limits, nuisances
from linkwright.core.diagnose.patterns.library import Candidate, candidates, parameter_of
from linkwright.core.diagnose.patterns.packed import Columns, packed
from linkwright.core.diagnose.patterns.pool import make_pool
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.result import Detectable
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.diagnose.search.calibrate import Draws, one_more
from linkwright.core.diagnose.several.recordings import Several, together
from linkwright.core.sections.numeric import Array

from .plan_request import Asked, Place, view
from .simulate import Plan, simulate
from .torques import TorquePromise
from .written import weightless

Named = tuple[str, tuple[int, ...]]
"""An effect and the joints or links (from 1) where it acts."""
NEVER = 0.9999
"""Correlation: patterns as alike over all poses tried are distinguished by no pose."""


@dataclass(frozen=True)
class Rival:
    """Another cause: how alike the patterns are (0 to 1), and the size from which on the two are distinguished;
    infinite where that is beyond what is possible."""

    effect: str
    at: tuple[int, ...]
    likeness: float
    resolved_size: float


@dataclass(frozen=True)
class Shown:
    """The smallest size of a parameter that will be seen (SI unit of `kind`), `rms` (m) how far that moves the tip,
    what is usual at most, its rivals, hardest first, and all `others` that there are, alike or not. Places count from
    1."""

    effect: str
    at: tuple[int, ...]
    parameter: str
    kind: str
    smallest: float
    rms: float
    usual: float
    rivals: tuple[Rival, ...]
    others: tuple[Named, ...]

    @property
    def pairs(self) -> frozenset[frozenset[Named]]:
        """The pairs of it and another."""
        return frozenset(frozenset(((self.effect, self.at), other)) for other in self.others)

    @property
    def open_pairs(self) -> frozenset[frozenset[Named]]:
        """Those of them in which it is not distinguished from the other at usual sizes; all, where none shows."""
        left = {(rival.effect, rival.at) for rival in self.inseparable}
        seen = self.smallest <= self.usual
        return frozenset(pair for pair in self.pairs if not seen or pair & left)

    @property
    def inseparable(self) -> tuple[Rival, ...]:
        """The causes from which it is not told at sizes that are usual."""
        return tuple(rival for rival in self.rivals if rival.resolved_size > self.usual)

    @property
    def resolved_size(self) -> float:
        """The size from which on it is distinguished from every cause but those."""
        return max(
            [self.smallest, *(rival.resolved_size for rival in self.rivals if rival.resolved_size <= self.usual)]
        )


@dataclass(frozen=True)
class Promise:
    """What readings will show: a `Shown` for each cause asked for, and those that they cannot show at all; and what the
    drives' torques will tell."""

    shown: tuple[Shown, ...]
    unseen: tuple[Named, ...]
    torques: tuple[TorquePromise, ...] = ()

    @property
    def pairs(self) -> int:
        """How many pairs there are of a cause asked for, as far as it is seen, and another; two that are both asked for
        are one pair."""
        return len(self._pairs)

    @property
    def separated(self) -> int:
        """How many of those are distinguished at usual sizes, whichever of the two is there."""
        return len(self._pairs.difference(*(item.open_pairs for item in self.shown)))

    @cached_property
    def _pairs(self) -> frozenset[frozenset[Named]]:
        return frozenset[frozenset[Named]]().union(*(item.pairs for item in self.shown))


def promised(arm: Arm, recording: Recording, axes: Sequence[str], asked: Asked) -> Promise:
    """What an instrument that sees the tip's components `axes` will show at these readings."""
    prepared = _sound(arm, recording, axes, asked)
    pool = prepared.pool
    detectables = _detectables(prepared, axes, asked) if pool.groups else ()
    wanted = [item for item in detectables if is_asked(item.effect, tuple(n - 1 for n in item.at), asked.effects)]
    shown = tuple(_shown(prepared, item, asked) for item in wanted)
    there = {(item.effect, item.at) for item in wanted}
    known = [group.candidate for group in pool.groups] + list(pool.invisible)
    absent = dict.fromkeys(
        (item.effect, item.numbers) for item in known if is_asked(item.effect, item.at, asked.effects)
    )
    return Promise(shown, tuple(item for item in absent if item not in there))


def _detectables(prepared: Prepared, axes: Sequence[str], asked: Asked) -> Sequence[Detectable]:
    """What of every cause that shows at all will be seen."""
    rules, everything = asked.rules, np.ones(len(prepared.pool.groups), dtype=bool)
    test = one_more(
        prepared.products,
        prepared.vector,
        (),
        prepared.criterion,
        Draws(prepared.visits, len(axes), rules.search.draws, np.random.default_rng(asked.seed)),
        among=(everything,),
    )[0]
    # What an effect does of itself is what is promised, not the variant that would show best.
    return detectable(prepared, test, 1.0, rules.search.false_alarm, plainest=True)


def is_asked(effect: str, at: tuple[int, ...], asked: Sequence[Place]) -> bool:
    """Whether an effect at places (from 0) is among those asked for: none named are all."""
    return not asked or any(effect == name and (not places or places == at) for name, places in asked)


def seen_columns(observed: Observed, columns: Array, axes: Sequence[str], scatter: Array) -> Array:
    """Columns (N, C, d) as the instrument's readings have them, over their scatter (k,), (N, k, d)."""
    if observed.view is not None:  # its readings are what was planned for
        return columns[:, : len(scatter)] / scatter[:, None]
    width = observed.components
    return np.einsum("kc,ncd->nkd", view(axes, width), columns[:, :width]) / scatter[:, None]


def _sound(arm: Arm, recording: Recording, axes: Sequence[str], request: Asked) -> Prepared:
    """The recording that a sound arm would give, ready to be searched."""
    made = _simulated(weightless(arm), recording, request)
    observed = observe(arm, made, rules=request.rules)
    scatter = request.scatter(axes)
    observed = replace(observed, scale=np.full(observed.residual.shape[1], request.sigma))

    def white(columns: Array) -> Array:
        rows = seen_columns(observed, columns, axes, scatter)
        return rows.reshape(rows.shape[0] * rows.shape[1], rows.shape[2])

    beside, names = nuisances(observed)
    patterns = list(candidates(observed))
    rules = request.rules.fitting
    pool = make_pool(
        white(beside), [(item, white(columns), limits(item, columns, rules=rules)) for item, columns in patterns],
        rules=request.rules,
    )  # fmt: skip
    seen = {id(group.candidate) for group in pool.groups}
    columns = Columns(packed(array) for candidate, array in patterns if id(candidate) in seen)
    vector = pool.projected(white(observed.residual[:, :, None])[:, 0])
    return Prepared(observed, vector, pool, columns, beside, names, ())


def _simulated(arm: Arm, recording: Recording, request: Asked) -> Recording:
    """The readings of an arm as its model says, by the instrument that was asked for: what each of several recordings
    reads by itself."""
    plan = Plan(
        1,
        every_row=True,
        noise=request.sigma,
        at=recording,
        seed=request.seed,
        slots=request.slots,
        instrument=request.reads,
        camera_noise=request.camera_noise,
        bar=request.bar,
    )
    parts = recording.parts()
    if request.touches:
        # What touches stands elsewhere then: where the arm as it is meets what it touches.
        plans = [replace(plan, at=part, seed=request.seed + number) for number, part in enumerate(parts)]
        made = [simulate(arm.on(item.branch), how).recording for item, how in zip(parts, plans, strict=True)]
        return together(made, arm, rules=request.rules.residual) if isinstance(recording, Several) else made[0]
    if not request.slots and len({part.branch for part in parts}) == 1:
        return simulate(arm.on(parts[0].branch), plan).recording
    read: list[Recording] = []
    for number, part in enumerate(parts):
        plans = replace(plan, at=part, seed=request.seed + number)
        if request.slots:
            there = part.instrument
            plans = replace(plans, instrument=replace(there, anchor=there.anchor or request.reads.anchor))
        read.append(simulate(arm.on(part.branch), plans).recording)
    turns = [item.orientation for item in read if item.orientation is not None]
    return replace(
        recording,
        tip=np.concatenate([item.tip for item in read]),
        orientation=np.concatenate(turns) if turns else recording.orientation,
    )


def _shown(prepared: Prepared, detected: Detectable, request: Asked) -> Shown:
    """What was found detectable, with its rivals."""
    pool, at = prepared.pool, tuple(number - 1 for number in detected.at)
    variants = [
        k
        for k, group in enumerate(pool.groups)
        if (group.candidate.effect, group.candidate.at) == (detected.effect, at)
        and group.visible == detected.visible
        and detected.parameter in group.candidate.sizes
    ]
    number = min(variants, key=lambda k: not is_plain(pool.groups[k].candidate))
    candidate = pool.groups[number].candidate
    usual = usual_size(candidate, detected.parameter)
    rivals = rivals_of(prepared, number, detected.parameter, request)
    there = [group.candidate for group in pool.groups if _may_be(candidate, group.candidate, request)]
    others = tuple(dict.fromkeys((item.effect, item.numbers) for item in there))
    return Shown(
        detected.effect,
        detected.at,
        detected.parameter,
        detected.kind,
        detected.value,
        detected.rms,
        usual,
        rivals,
        others,
    )


def usual_size(candidate: Candidate, name: str) -> float:
    """The largest usual size of a parameter; the whole of what an arm file has data for but leaves out."""
    if candidate.share:
        return 1.0
    return max(abs(limit) for limit in parameter_of(EFFECTS[candidate.effect], name).typical)


def middle_size(candidate: Candidate, name: str) -> float:
    """The middle of what is usual of a parameter, as a ratio: a tenth of it is as likely as ten times as much."""
    if candidate.share:
        return 1.0
    return math.sqrt(math.prod(abs(limit) for limit in parameter_of(EFFECTS[candidate.effect], name).typical))


def rivals_of(prepared: Prepared, number: int, parameter: str, asked: Asked) -> tuple[Rival, ...]:
    """What a group's parameter might be taken for, hardest to tell first: each other cause by its likest variant."""
    pool = prepared.pool
    group = pool.groups[number]
    place = group.candidate.sizes.index(parameter)
    pattern = group.forward[:, place]
    length = float(np.linalg.norm(pattern))
    mixed = pool.gram[:, group.start : group.stop] @ (pattern / length)
    shared = np.sqrt(np.minimum(np.add.reduceat(mixed**2, pool.starts), 1.0))
    largest = largest_size(group.candidate, parameter)
    price = prepared.criterion.price
    hardest: dict[object, Rival] = {}
    for other in np.flatnonzero(shared**2 >= asked.rules.search.rivalling).tolist():
        candidate = pool.groups[other].candidate
        if not _may_be(group.candidate, candidate, asked):
            continue
        likeness = float(shared[other])
        size = _resolved_size(likeness, length, float(price[other] - price[number]), asked.rules)
        rival = Rival(candidate.effect, candidate.numbers, likeness, size if size <= largest else math.inf)
        known = hardest.get(candidate.family)
        if known is None or (known.resolved_size, known.likeness) < (rival.resolved_size, rival.likeness):
            hardest[candidate.family] = rival
    return tuple(sorted(hardest.values(), key=lambda item: (-item.resolved_size, -item.likeness)))


def _may_be(one: Candidate, other: Candidate, request: Asked) -> bool:
    """Whether one might be taken for the other, and that is asked."""
    if not another_cause(one, other) or other.only is not None:
        return False
    return not request.pairs_only or is_asked(other.effect, other.at, request.effects)


def another_cause(one: Candidate, other: Candidate) -> bool:
    """Whether two candidates are two causes: not the same effect at places that they share."""
    return one.effect != other.effect or not (set(one.at) & set(other.at) or one.at == other.at)


def _resolved_size(likeness: float, length: float, dearer: float, rules: Rules) -> float:
    """The size, of a pattern of this `length` for size one, from which on a rival is refused with high power: its
    criterion is worse by the non-centrality that it leaves and by what it costs more."""
    if likeness >= NEVER and dearer <= 0.0:
        return math.inf
    search = rules.search
    margin = max((search.refuted if likeness >= search.alike else search.confident) - dearer, 0.0)
    sure = math.sqrt(rules.answer.told) - math.sqrt(search.confident)
    needed = math.sqrt(margin) + sure if margin > 0.0 else 0.0
    return needed / (length * math.sqrt(max(1.0 - likeness**2, 1e-12)))
