"""Findings so large that first order does not hold about the arm file: a zero off by degrees, a tool by centimetres.

What they move beyond first order would be named for something else. So it is worked out by finite motions, taken off
the residual (`observe(..., about=...)`), and the search is made again until that no longer changes: Gauss-Newton, with
the search as its step. What is one to first order need not be one beyond it: the search is made about each of those
names, and the best answer counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.diagnose.fitting.corrected_arm import as_entry
from linkwright.core.diagnose.fitting.fit import beyond_nuisances, fit
from linkwright.core.diagnose.patterns.basis import tip_of
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.residual.observe import beyond_first_order
from linkwright.core.diagnose.residual.observed import Observed, rms_length

from .aliases import likenesses
from .naming import Named, Namer

Array = NDArray[np.float64]
Entries = tuple[EffectEntry, ...]
Search = Callable[[Entries, Sequence[Candidate]], tuple[Namer, Named]]
"""A search about some motions, on from what was named before."""


def about_large(namer: Namer, named: Named, search: Search) -> tuple[Namer, Named]:
    """The search made again about what it found, by `search`, where that is so large that it matters; else as it is."""
    members = _members(namer, named)
    if not _may_matter(namer, members):
        return namer, named
    beginnings = [(_motions(namer, each), candidates_of(namer, each)) for each in _beginnings(namer, members)]
    if not any(_matters(namer, entries) for entries, _ in beginnings):
        return namer, named
    best: tuple[Namer, Named] | None = None
    for entries, before in beginnings:
        trial = _settled(*search(entries, before), search)
        # One at a time: each has patterns and a pool of its own.
        best = trial if best is None or _criterion(*trial) < _criterion(*best) else best
        del trial
    return best if best is not None else (namer, named)


def _criterion(namer: Namer, named: Named) -> float:
    """The criterion of what was named for the readings as they are, not by the scatter that each search has found."""
    observed = namer.prepared.observed
    return namer.criterion_of(named.everything) + 2.0 * observed.rows * float(np.sum(np.log(observed.scale)))


def _settled(namer: Namer, named: Named, search: Search) -> tuple[Namer, Named]:
    for _ in range(namer.rules.motion_rounds):
        found = _motions(namer, _members(namer, named))
        if not _matters(namer, found):
            break
        namer, named = search(found, candidates_of(namer, named.members))
    return namer, named


def _members(namer: Namer, named: Named) -> Sequence[int]:
    """What was named; the library's best answer where nothing of it was."""
    return named.members or min(namer.best_of_library().values(), key=lambda subset: subset.criterion).members


def candidates_of(namer: Namer, members: Sequence[int]) -> list[Candidate]:
    """The candidates that some groups are."""
    return [namer.pool.groups[m].candidate for m in members]


def _may_matter(namer: Namer, members: Sequence[int]) -> bool:
    """Whether anything moves the tip so far that its square over the tip's distance is near what matters, or what it
    changes of how far the loads bend the arm: a zero that is off by a mrad turns 30 mm of sag by 0.03 mm."""
    observed = namer.prepared.observed
    least = namer.rules.may_matter * namer.rules.motion_matters
    reach = rms_length(tip_of(observed))
    furthest = max((rms_length(move) for move in _moves(namer, members)), default=0.0)
    bent = rms_length(columns(observed.state.tip(), observed.rows) - columns(observed.nominal.tip(), observed.rows))
    return reach > 0.0 and furthest * (furthest + bent) / reach > least * _scatter(observed)


def _scatter(observed: Observed) -> float:
    return float(np.sqrt(np.sum(observed.scale[: observed.components] ** 2)))


def _moves(namer: Namer, members: Sequence[int]) -> list[Array]:
    """What each of some groups moves the tip by, as fitted, (N, D), m."""
    fitted = fit(namer.prepared, members)
    width = namer.prepared.observed.components
    return [(namer.prepared.columns[m] @ fitted.sizes[fitted.members.index(m)])[:, :width] for m in members]


def _matters(namer: Namer, found: Entries) -> bool:
    """Whether what lies beyond first order is another than that allowed for, by more than the nuisances take up."""
    observed = namer.prepared.observed
    width = observed.components
    change = np.zeros(observed.residual.shape)
    change[:, :width] = beyond_first_order(observed, found) - beyond_first_order(observed, observed.about)
    return rms_length(beyond_nuisances(namer.prepared, change)[:, :width]) > namer.rules.motion_matters * _scatter(
        observed
    )


def _motions(namer: Namer, members: Sequence[int]) -> Entries:
    """Some groups as entries of an arm file, as fitted; what is a share of loads or lacks a size stays out."""
    fitted = fit(namer.prepared, members)
    pairs = [(namer.pool.groups[m].candidate, s.tolist()) for m, s in zip(fitted.members, fitted.sizes, strict=True)]
    return tuple(
        as_entry(candidate, candidate.from_slopes(sizes))
        for candidate, sizes in pairs
        if not candidate.share and candidate.only is None and len(sizes) == len(candidate.sizes)
    )


def _beginnings(namer: Namer, members: Sequence[int]) -> Iterator[Sequence[int]]:
    """What was found, and the same with the one that moves most under each of its other names."""
    yield members
    largest = members[int(np.argmax([rms_length(move) for move in _moves(namer, members)]))]
    shared, _ = likenesses(namer, members, largest)
    families, rules = {namer.pool.groups[m].candidate.family for m in members}, namer.rules
    for number in np.argsort(-shared).tolist():
        family = namer.pool.groups[number].candidate.family
        if shared[number] < rules.alike or len(families) - len(members) >= rules.motion_names:
            break
        if family not in families:
            families.add(family)
            yield [number if m == largest else m for m in members]
