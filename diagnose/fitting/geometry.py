"""Zeros and lengths of all joints and links fitted together, exactly, before anything else is sought.

Zeros that are off by degrees do not add up to first order, and what lies beyond it looks like tilts, eccentricities
and tools. So the readings are set against the arm with all zeros and lengths as they fit best: Gauss-Newton on the
exact chain, readings that lie far off weighed down. What each is off by has a Cauchy prior of its usual size: it leaves
large ones where the data put them, and small what the data do not tell apart. To first order a zero at the wrist is
lengths of the last link, or a tool; so zeros are fitted first, and lengths beside them as those stand.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.patterns.library import Candidate, candidates, columns_of, of_single_numbers, parameter_of
from linkwright.core.diagnose.residual.observe import beyond_first_order, observed_about
from linkwright.core.diagnose.residual.observed import Observed, rms_length
from linkwright.core.diagnose.residual.robust_scale import HUBER

from .corrected_arm import as_entry
from .prepare import nuisances

_STEPS = 12
_REWEIGHTED = 8


def about_geometry(
    observed: Observed, without: frozenset[str] = frozenset(), noise_floor: float | None = None
) -> Observed:
    """The readings set against the arm with its zeros and lengths as they fit best.

    Args:
        observed: The readings against the arm file.
        without: Ids of effects that are out of the question.
        noise_floor: What repeats of a pose differ by, m; None where there are none.

    Returns:
        The same readings, first order taken about those zeros and lengths (`Observed.about`); as they came where all
        readings together do not tell that from first order about the arm file: by what repeats differ by, or where
        that is less or there are none, by what zeros and lengths leave.
    """
    others = frozenset(effect.id for effect in EFFECTS.values() if not of_single_numbers(effect))
    known = [item for item, _ in candidates(observed, without | others) if item.only is None]
    single = [item for item in known if len(item.at) == 1 and len(item.sizes) == 1]
    zeros = [item for item in single if EFFECTS[item.effect].place == "joint"]
    now, entries = observed, observed.about
    # What curves goes first: about zeros, what lengths do is still of first order, and not the other way about.
    for among in (zeros, single):
        for _ in range(_STEPS if among else 0):
            entries, left = _fitted(now, among)
            change = beyond_first_order(now, entries) - beyond_first_order(now, now.about)
            noise = left if noise_floor is None else min(left, noise_floor)
            # Of one standard error in all, no pattern could make a difference.
            if rms_length(change) * np.sqrt(change.size) <= noise:
                break
            now = observed_about(observed, entries, ())
    return observed_about(observed, entries, ()) if now.about else now


def _fitted(observed: Observed, single: Sequence[Candidate]) -> tuple[tuple[EffectEntry, ...], float]:
    """Zeros and lengths as they fit best to first order about the state observed, from the sizes that they have there,
    and the RMS length (m) that they leave of the tip."""
    width = observed.components
    shown = [(item, columns) for item in single if (columns := columns_of(observed, item)) is not None]
    usual = np.array([max(map(abs, parameter_of(EFFECTS[c.effect], c.sizes[0]).typical)) for c, _ in shown])
    beside, _ = nuisances(observed)
    design = np.concatenate([*(columns for _, columns in shown), beside], axis=2)[:, :width]
    target, sizes = observed.tip_residual(), np.array([_size_there(observed, item) for item, _ in shown])
    weight, left = np.ones(len(target)), target
    for _ in range(_REWEIGHTED):
        unit = float(np.sqrt(np.sum(weight[:, None] * left**2) / left.size))
        held = np.zeros(design.shape[2])
        held[: len(shown)] = unit / np.hypot(usual, sizes)
        root = np.sqrt(weight)[:, None]
        rows = np.vstack([(design * root[:, :, None]).reshape(-1, design.shape[2]), np.diag(held)])
        # With its prior: what no reading shows (the last zero of a tip on its axis) has a column of rounding alone.
        scale = np.linalg.norm(rows, axis=0)
        scale = np.where(scale > 0.0, scale, 1.0)
        wanted = np.concatenate([(target * root).reshape(-1), np.zeros(len(held))])
        values = np.linalg.lstsq(rows / scale, wanted, rcond=1e-9)[0] / scale
        sizes, left = values[: len(shown)], target - design @ values
        distance = np.linalg.norm(left, axis=1)
        middle = float(np.median(distance))
        weight = np.minimum(1.0, HUBER * middle / np.maximum(distance, 1e-300)) if middle > 0.0 else weight
    entries = tuple(as_entry(item, [size]) for (item, _), size in zip(shown, sizes.tolist(), strict=True))
    return entries, rms_length(left)


def _size_there(observed: Observed, item: Candidate) -> float:
    """The size of a zero or length in the state that first order is taken about; zero where it is not there."""
    there = (entry for entry in observed.about if (entry.effect, entry.at) == (item.effect, item.numbers))
    return sum(entry.parameters.get(item.sizes[0], 0.0) for entry in there)
