"""What gives under links that nobody has weighed: patterns of compliance times weight, which show only together.

The weights are those of `arm.effects.loads.unknown_weight`: each link's first moments about its joint, and its mass
where masses show by themselves. As long as nothing is known of them, an effect that gives under them has one column for
each; where the arm file names them, up to a factor, it has one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.effects import EFFECTS, Effect, Settings
from linkwright.core.arm.effects.loads.unknown_weight import MOMENTS, UNKNOWN_WEIGHT, unit_weights, without_unit_weights
from linkwright.core.arm.errors.recorded import Asked, seen
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.sections.numeric import Array

Weight = tuple[int, str]
"""A link (from 0) and the parameter of `unknown_weight` that says what of its weight is meant."""

_SAG = MappingProxyType({"unit_sag": 1.0})
_ROUNDING = 1e-9
_SPANNED = 1e-6
"""A known load's pattern that unknown weights leave so little of is one that they could make."""


def gives_under_weights(effect: Effect) -> bool:
    """Whether an effect has a product of compliance and unknown weight for a parameter."""
    return any(parameter.name in _SAG for parameter in effect.parameters)


def only_products(observed: Observed, effect: Effect, at: Sequence[int]) -> bool:
    """Whether an effect at places (from 0) gives under links of unknown weight.

    Links and bearings that had weights of their own to choose could do almost anything: they give under weights that
    the arm file names, drives, the base and masts under any.
    """
    first = min(at, default=0)
    if not any(link >= first for link in observed.unknown_masses) or not gives_under_weights(effect):
        return False
    return weights_given(observed) or not effect.recording.weights_named


def weights_given(observed: Observed) -> bool:
    """Whether the arm file names what its links weigh, up to a factor."""
    return bool(unit_weights(observed.arm))


def unknown_weights(observed: Observed, *, masses: bool) -> tuple[Weight, ...]:
    """All unknown weights of the links; without `masses`, those that first moments cannot say are there all the same.

    A mass at its joint lies in the link before, whose first moments hold it, unless the joint slides.
    """
    slides = any(not joint.revolute for joint in observed.arm.joints)
    weights: list[Weight] = []
    for link in observed.unknown_masses:
        if masses or slides or (link > 0 and link - 1 not in observed.unknown_masses):
            weights.append((link, "mass"))
        weights += [(link, name) for name in MOMENTS]
    return tuple(weights)


def weighed(observed: Observed, effect: Effect, at: tuple[int, ...], weights: Sequence[Weight]) -> Array:
    """What an effect of unit sag moves under a unit of each of these weights, (N, C, K); with no weights, under those
    of the arm file, (N, C, 1)."""
    if not weights:
        return observed.signature(effect.id, Settings(at, _SAG))[:, :, None]
    first = min(at, default=0)
    nothing = np.zeros(observed.residual.shape)
    parts: list[Array] = []
    for one in weights:
        if one[0] < first:
            parts.append(nothing)
            continue
        weighing = replace(observed, state=_weighing(observed, (one,), (1.0,)))
        parts.append(weighing.signature(effect.id, Settings(at, _SAG)))
    columns = np.stack(parts, axis=2)
    # A weight beside an axis that lies across gravity turns nothing but by rounding, which a fit would take for more.
    size = np.linalg.norm(columns, axis=(0, 1))
    columns[:, :, size <= _ROUNDING * size.max(initial=0.0)] = 0.0
    return columns


def turned_under_weights(
    observed: Observed, effect: str, at: tuple[int, ...], weights: Sequence[Weight], products: Array
) -> Array:
    """How far something turns under unknown weights over the readings, by its products (K,): (N, 3), rad."""
    state = _weighing(observed, weights, products.tolist()) if weights else observed.state
    settings = Settings(at, _SAG if weights else MappingProxyType({"unit_sag": float(products[0])}))
    turn = seen(state, EFFECTS[effect], settings, Asked(observed.rows, turn=True)).turn
    return np.zeros((observed.rows, 3)) if turn is None else turn


def levers(arm: Arm, weights: Sequence[Weight], least: float) -> Array:
    """How large each of these weights (K,) may be against the largest: for a first moment, how far what lies beyond its
    joint reaches against what lies beyond the first of those joints, no less than `least`."""
    steps = [
        link.length + float(np.linalg.norm(joint.origin_translation))
        for joint, link in zip(arm.joints, arm.links, strict=True)
    ]
    steps[-1] += float(np.linalg.norm(arm.tool))
    reach = np.cumsum(steps[::-1])[::-1]
    first = min(link for link, _ in weights)
    shares = [1.0 if name == "mass" else float(reach[link] / reach[first]) for link, name in weights]
    return np.maximum(np.array(shares), least)


def weights_of(observed: Observed, effect: str, at: tuple[int, ...]) -> tuple[Weight, ...]:
    """The unknown weights that an effect at places (from 0) has products with by itself; none where the file names
    them."""
    if weights_given(observed):
        return ()
    first = min(at, default=0)
    whole = unknown_weights(observed, masses=EFFECTS[effect].recording.under_forces)
    return tuple(weight for weight in whole if weight[0] >= first)


def product_entry(effect: str, numbers: tuple[int, ...], unit_sag: float) -> EffectEntry:
    """What gives under unknown weights as an entry of an arm's `effects`."""
    return EffectEntry(effect, numbers, MappingProxyType({"unit_sag": unit_sag}))


def weight_entries(weights: Sequence[Weight], values: Sequence[float]) -> tuple[EffectEntry, ...]:
    """Unknown weights (K,) as entries of an arm's `effects`, one a link; those that are rounding are left out."""
    entries: dict[int, dict[str, float]] = {}
    for (link, name), value in zip(weights, values, strict=True):
        if abs(value) > _ROUNDING * max(map(abs, values)):
            entries.setdefault(link, {})[name] = value
    return tuple(
        EffectEntry(UNKNOWN_WEIGHT.id, (link + 1,), MappingProxyType(entry)) for link, entry in entries.items()
    )


def _weighing(observed: Observed, weights: Sequence[Weight], values: Sequence[float]) -> PoseState:
    """The arm at the readings where its links weigh these multiples of an unknown weight."""
    bare = without_unit_weights(observed.state.arm)
    arm = replace(bare, effects=(*bare.effects, *weight_entries(weights, values)))
    return replace(observed.state, arm=arm)


def with_known_load(observed: Observed, effect: Effect, at: tuple[int, ...], products: Array) -> Array:
    """The products' columns and, last, what one unit of the effect's size moves under the loads that are known;
    zero where that is what unknown weights could do as well."""
    known = observed.signature(effect.id, Settings(at, MappingProxyType({effect.sizes[0].name: 1.0})))
    flat, target = products.reshape(-1, products.shape[2]), known.reshape(-1)
    size = np.linalg.norm(flat, axis=0)
    scaled = flat / np.where(size > 0.0, size, 1.0)
    left = target - scaled @ np.linalg.lstsq(scaled, target, rcond=1e-10)[0]
    if np.linalg.norm(left) <= _SPANNED * np.linalg.norm(target):
        known = np.zeros(known.shape)
    return np.concatenate([products, known[:, :, None]], axis=2)


def columns_under_weights(
    observed: Observed, effect: str, at: tuple[int, ...], weights: Sequence[Weight] | None = None
) -> Array:
    """The columns (N, C, K + 1) of an effect under unknown weights: a product for each of `weights` (its own by
    default), and its size under the loads that are known."""
    effect_here = EFFECTS[effect]
    of = weights_of(observed, effect, at) if weights is None else weights
    return with_known_load(observed, effect_here, at, weighed(observed, effect_here, at, of))
