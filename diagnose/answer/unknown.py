"""What nothing in the library explains: what it depends on, its shape, and why each near entry was rejected."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.fitting.fit import Fit, displacement, fit, impossible, remaining
from linkwright.core.diagnose.fitting.held_out import residual_held_out
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.patterns.form import followed_by, form_of, sentence_of
from linkwright.core.diagnose.patterns.library import Candidate
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.residual.visits import looks_quieter
from linkwright.core.diagnose.result import Dependence, Form, RejectedForm, Unknown
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.sections.numeric import Array

from .gaussian_process import smooth_model
from .locate import depends_on

Folds = NDArray[np.int64]

_FORMS, _NEAR = 5, 12
"""So many forms describe an unknown at most, and so many of the library are told that came near."""


def describe(
    namer: Namer,
    known: Sequence[int],
    outside: Sequence[int],
    dependences: Sequence[Dependence],
    folds: Folds,
    noise_floor: float | None = None,
    at: Recording | None = None,
) -> Unknown:
    """Describe what is left beside the `known` groups, led by the `outside` forms that won.

    The smooth model of it is given at the readings `at`: by default at those that were searched, which of a long
    recording are not all. `noise_floor` (m) is what no form can tell, the RMS length of the noise; None where nobody
    knows it.
    """
    prepared, observed = namer.prepared, namer.prepared.observed
    rules = observed.rules.answer
    whole = fit(prepared, [*known, *outside])
    moved = displacement(prepared, whole, outside)[:, : observed.components]
    if not outside:
        moved = remaining(prepared, whole)[:, : observed.components]
    ranked = _ranked_forms(namer, known, folds)
    # A form that predicts nothing describes nothing, however well it can be bent to the readings fitted.
    telling = {form.name: form.share_held_out for form in ranked if form.share_held_out > rules.refuted}
    candidates = [namer.pool.groups[m].candidate for m in largest_first(prepared, whole, outside)]
    # Two that balance each other are large, and one of them alone predicts little.
    enough = observed.rules.search.rivalling * max(
        (telling.get(candidate.effect, 0.0) for candidate in candidates), default=0.0
    )
    won = next(
        (candidate for candidate in candidates if candidate.effect in telling and telling[candidate.effect] >= enough),
        None,
    )
    # Forms that tell nothing of readings they have not seen say neither what it depends on nor since when.
    leading = outside if won is not None else ()
    on = _depends(namer, leading, dependences, observed.rules.residual)
    predicted, share = _smooth(namer, known, folds, at)
    return Unknown(
        depends_on=on,
        # Forms that findings balance move the tip by more than is missing: no more than these leave is unexplained.
        amplitude=min(rms_length(moved), *(_left(prepared, members) for members in (known, ()))),
        shape=_shape(namer, known, leading, ranked, won, folds, noise_floor),
        forms=tuple(ranked),
        rejected=rejected_forms(namer, known, outside),
        since=since(namer, leading),
        decide=_decides(on, won),
        predicted=predicted if observed.view is None else None,  # no table of readings corrects a path
        held_out_share=share,
    )


def _left(prepared: Prepared, members: Sequence[int]) -> float:
    """What groups leave of the tip's residual (RMS length, m)."""
    return rms_length(remaining(prepared, fit(prepared, members))[:, : prepared.observed.components])


def _shape(
    namer: Namer,
    known: Sequence[int],
    together: Sequence[int],
    ranked: Sequence[Form],
    won: Candidate | None,
    folds: Folds,
    noise_floor: float | None,
) -> str:
    """The leading form in words: of those that won, which tell `together`, else the best of the `ranked`; "nothing
    simple" where it tells less than half of what is more than noise."""
    prepared, observed = namer.prepared, namer.prepared.observed
    rules = observed.rules.answer
    telling = [form for form in ranked if form.share_held_out > rules.refuted]
    if not telling:
        return "nothing simple"
    words = telling[0].sentence if won is None else sentence_of(won) + _place_of(won)
    beside = [prepared.beside, *(prepared.columns[m] for m in known)]
    total = float(np.sum(residual_held_out(observed, beside, folds, nuisances=1) ** 2))
    share = telling[0].share_held_out
    if together:
        left = residual_held_out(observed, [*beside, *(prepared.columns[m] for m in together)], folds, nuisances=1)
        share = 1.0 - float(np.sum(left**2)) / max(total, 1e-300)
    noise = 0.0 if noise_floor is None else observed.rows * (noise_floor * looks_quieter(observed)) ** 2
    share *= total / max(total - noise, observed.rules.search.rivalling * total)
    if share >= observed.rules.search.rivalling:
        return words
    if share < rules.refuted:
        return "nothing simple"
    return f"nothing simple (nearest comes: {words}; it tells {100.0 * share:.0f} % of it)"


def predictable(namer: Namer, known: Sequence[int], folds: Folds) -> float:
    """The share of what is left beside the `known` groups that forms or a smooth model predict where they have not
    seen it: next to nothing for scatter, however large."""
    forms = [form.share_held_out for form in _ranked_forms(namer, known, folds)]
    return max([_smooth(namer, known, folds)[1], *forms])


def _smooth(namer: Namer, known: Sequence[int], folds: Folds, at: Recording | None = None) -> tuple[Array, float]:
    """A smooth model of what is left beside the `known` groups, at readings (N, D), m, and the share of the sum of
    squares that it, with the scales of the whole, predicts on folds that it has not seen."""
    prepared, width = namer.prepared, namer.prepared.observed.components
    left = remaining(prepared, fit(prepared, list(known)))[:, :width]
    beside = [prepared.columns[m][:, :width] for m in known]
    inputs = _inputs(namer)
    whole = smooth_model(inputs, left, beside)
    missed, total = 0.0, 0.0
    for fold in np.unique(folds).tolist():
        out = folds == fold
        if out.all() or (~out).sum() < 8:
            continue
        others = [part[~out] for part in beside]
        model = smooth_model(inputs[~out], left[~out], others, alike=whole)
        missed += float(np.sum((left[out] - model.predict(inputs[out])) ** 2))
        total += float(np.sum(left[out] ** 2))
    return whole.predict(inputs if at is None else _inputs(namer, at)), 1.0 - missed / total if total > 0.0 else 0.0


def largest_first(prepared: Prepared, fitted: Fit, forms: Sequence[int]) -> list[int]:
    """Forms by what they move the tip by, the largest first."""
    width = prepared.observed.components
    return sorted(forms, key=lambda m: -rms_length(displacement(prepared, fitted, (m,))[:, :width]))


def _place_of(candidate: Candidate) -> str:
    """Which joint a form belongs to, or where it is drawn to, as words; nothing where it has no place."""
    point = [f"{candidate.shapes[name]:.2f}" for name in ("at_x", "at_y", "at_z") if name in candidate.shapes]
    if point:
        return f"; it is near ({', '.join(point)}) m"
    if len(candidate.at) == 2:
        return f" (joint {candidate.at[0] + 1} by joint {candidate.at[1] + 1})"
    return f" (joint {candidate.at[0] + 1})" if len(candidate.at) == 1 else ""


def since(namer: Namer, outside: Sequence[int]) -> float | None:
    """Since when (s, or the number of the reading where no time was recorded: None then) a step is seen."""
    if namer.prepared.observed.recording.time is None:
        return None
    for member in outside:
        shapes = namer.pool.groups[member].candidate.shapes
        if "since" in shapes:
            return float(shapes["since"])
    return None


def _depends(
    namer: Namer, outside: Sequence[int], dependences: Sequence[Dependence], rules: ResidualRules
) -> tuple[str, ...]:
    names = [name for member in outside for name in followed_by(namer.pool.groups[member].candidate)]
    return tuple(dict.fromkeys([*names, *depends_on(dependences, rules=rules)]))


def _ranked_forms(namer: Namer, known: Sequence[int], folds: Folds) -> list[Form]:
    """The forms that describe most of what the known physics leaves, the best variant of each, checked on held-out
    rows."""
    prepared, observed = namer.prepared, namer.prepared.observed
    known_products = prepared.products.beside(namer.pool.columns(known))
    gained = known_products.gains()
    price = namer.criterion.price
    worth = (
        -namer.criterion.count * np.log1p(-np.minimum(gained / max(known_products.rss, 1e-300), 1.0 - 1e-12)) - price
    )
    base = residual_held_out(observed, [prepared.beside, *(prepared.columns[m] for m in known)], folds, nuisances=1)
    total = float(np.sum(base**2))
    forms: list[Form] = []
    seen: set[str] = set()
    for number in np.argsort(-worth).tolist():
        candidate = namer.pool.groups[number].candidate
        if not candidate.outside or candidate.effect in seen or worth[number] <= 0.0 or len(forms) == _FORMS:
            continue
        seen.add(candidate.effect)
        columns = [prepared.beside, *(prepared.columns[m] for m in known), prepared.columns[number]]
        left = residual_held_out(observed, columns, folds, nuisances=1)
        share = 1.0 - float(np.sum(left**2)) / max(total, 1e-300)
        forms.append(Form(candidate.effect, float(gained[number] / known_products.rss), share, sentence_of(candidate)))
    return forms


def rejected_forms(namer: Namer, known: Sequence[int], others: Sequence[int]) -> tuple[RejectedForm, ...]:
    """The entries of the library that came nearest without being taken, and why."""
    prepared = namer.prepared
    known_products = prepared.products.beside(namer.pool.columns(known))
    gained = known_products.gains()
    whole = [*known, *others]
    best = namer.criterion_of(whole)
    forms: list[RejectedForm] = []
    seen: set[object] = {namer.pool.groups[m].candidate.family for m in known}
    for number in np.argsort(-gained).tolist():
        group = namer.pool.groups[number]
        if not namer.library[number] or group.candidate.family in seen or len(forms) == _NEAR:
            continue
        seen.add(group.candidate.family)
        trial = [*known, number]
        fitted = fit(prepared, trial)
        share = float(gained[number] / max(prepared.products.rss, 1e-300))
        reason = impossible(prepared, fitted)
        if reason is None:
            worse = namer.criterion_of(trial) - best
            explained = 100.0 * float(gained[number]) / max(known_products.rss, 1e-300)
            reason = f"explains {explained:.0f} % of what is left, and its criterion is worse by {worse:.0f}"
            if worse < 0.0:
                reason = f"explains {explained:.0f} % of what is left: its criterion is better, but not beyond chance"
        forms.append(RejectedForm(group.candidate.effect, group.candidate.numbers, share, reason))
    return tuple(forms)


def _inputs(namer: Namer, at: Recording | None = None) -> Array:
    """What a smooth model goes by at the readings `at`, by default those searched: coordinates, and what varied of
    time, temperature, payload and the sides that joints came from in what was searched."""
    searched = namer.prepared.observed.recording
    recording = searched if at is None else at

    def further(of: Recording) -> tuple[Array | None, ...]:
        sides = () if of.sides is None else of.sides.T
        return of.time, of.temperature, of.payload_mass, *sides

    columns = [
        values[:, None]
        for searched_values, values in zip(further(searched), further(recording), strict=True)
        if searched_values is not None and values is not None and np.ptp(searched_values) > 0.0
    ]
    return np.concatenate([recording.q, *columns], axis=1)


def _decides(on: Sequence[str], won: Candidate | None) -> str:
    """Which recording would tell more; what a column is that all of it follows."""
    if won is not None and form_of(won).by_column:
        return f"say what {', '.join(won.shapes)} is; a payload is written payload_kg, a temperature temperature_degC"
    if "time" in on:
        return "visit the same few poses again and again for as long as it takes, with a target on the base as well"
    if "temperature_degC" in on:
        return "warm the arm up and let it cool at a few fixed poses, with a temperature at each link"
    if any(name.startswith(("dir", "side", "velocity")) for name in on):
        return "visit each pose from both sides of every joint, slowly and fast"
    if "payload_kg" in on:
        return "visit the same poses with three payloads, and with a side force at the tip"
    return "a dense grid of poses where the displacement is largest, each with two payloads and from both sides"
