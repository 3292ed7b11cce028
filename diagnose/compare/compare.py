"""Two recordings of one arm, before and after a service say: what changed.

Both are diagnosed, and then both are fitted with one common model, the union of what was found: a parameter that only
one of them shows is thereby measured in the other as well. Differences are tested by their standard errors (Student's
t, the fewer degrees of freedom of both) and adjusted for their number by Holm's method (S. Holm, Scand. J. Statist. 6
(1979) 65-70).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from scipy import stats

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.fitting.corrected_arm import as_entry
from linkwright.core.diagnose.fitting.fit import t_quantile
from linkwright.core.diagnose.fitting.prepare import nuisances
from linkwright.core.diagnose.patterns.library import Candidate, columns_of, kind_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed, rms_length
from linkwright.core.diagnose.residual.visits import blocks_of
from linkwright.core.diagnose.result import Covered, Diagnosis, Finding, FittedParameter
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.diagnose.search.large_motions import ROUNDS
from linkwright.core.sections.numeric import Array

from .places import Region, SharedPoses, regions, shared_poses


@dataclass(frozen=True)
class Change:
    """A parameter of the common model in both recordings: `difference` is second less first with its 95 % `interval`
    (SI of the parameters' kind), `p_value` that of no change, `adjusted` the same by Holm's method, `level` below which
    that is beyond doubt."""

    effect: str
    first: FittedParameter
    second: FittedParameter
    difference: float
    interval: tuple[float, float]
    p_value: float
    adjusted: float
    level: float = RULES.compare.level

    @property
    def changed(self) -> bool:
        """Whether the difference is beyond doubt."""
        return self.adjusted < self.level


@dataclass(frozen=True)
class Comparison:
    """What changed between two recordings of an arm. `figures` are those of the standards that both support.

    `unexplained` are the RMS of what the common model leaves in each (m). `notes` are sentences.
    """

    first: Diagnosis
    second: Diagnosis
    changes: tuple[Change, ...]
    unexplained: tuple[float, float]
    shared: SharedPoses | None
    regions: tuple[Region, ...]
    figures: tuple[tuple[Covered, Covered], ...]
    notes: tuple[str, ...]


def compare(arm: Arm, first: Diagnosis, second: Diagnosis, *, rules: Rules = RULES) -> Comparison:
    """Compare two diagnoses of one arm by the same `rules` as they were made with."""
    terms, notes = common_model(first, second)
    fitted = [fit_common(arm, item.recording, terms, rules=rules) for item in (first, second)]
    changes = _changes(arm, terms, fitted, rules.compare.level)
    sides = _pairs(first.figures, second.figures)
    return Comparison(
        first=first,
        second=second,
        changes=changes,
        unexplained=(fitted[0].rms, fitted[1].rms),
        shared=shared_poses(arm, first, second, rules=rules),
        regions=regions(arm, first, second),
        figures=sides,
        notes=(*notes, *_unequal(first.recording, second.recording)),
    )


def common_model(first: Diagnosis, second: Diagnosis) -> tuple[tuple[Candidate, ...], list[str]]:
    """The union of what was found, as candidates; one name for what neither recording can tell from another."""
    findings = list(first.findings)
    notes: list[str] = []
    for finding in second.findings:
        same = next((item for item in findings if _alike(item, finding)), None)
        if same is None:
            findings.append(finding)
        elif (same.effect, same.at) != (finding.effect, finding.at):
            notes.append(f"{_name(finding)} in the second is taken for {_name(same)}: the data do not tell them apart.")
    return tuple(candidate_of(finding) for finding in findings if finding.effect in EFFECTS), notes


def _alike(one: Finding, other: Finding) -> bool:
    names = {(one.effect, one.at), *((alternative.effect, alternative.at) for alternative in one.alternatives)}
    others = {(other.effect, other.at), *((alternative.effect, alternative.at) for alternative in other.alternatives)}
    return (one.effect, one.at) in others or (other.effect, other.at) in names


def _name(finding: Finding) -> str:
    return f"{finding.effect} at {', '.join(map(str, finding.at))}" if finding.at else finding.effect


def candidate_of(finding: Finding) -> Candidate:
    """A finding as columns to fit: its sizes, at the shapes that were found."""
    effect = EFFECTS[finding.effect]
    role = {parameter.name: parameter.role for parameter in effect.parameters}
    at = tuple(number - 1 for number in finding.at)
    if any(fitted.parameter == "share" and "share" not in role for fitted in finding.parameters):
        return Candidate(finding.effect, at, ("share",), MappingProxyType({}), share=True)
    # A threshold or a lag that one recording found counts in both, or sizes could not be compared.
    shapes = {
        parameter.parameter: parameter.value
        for parameter in finding.parameters
        if role.get(parameter.parameter) == "shape"
    }
    sizes = tuple(parameter.name for parameter in effect.parameters if parameter.role == "size")
    return Candidate(finding.effect, at, sizes, MappingProxyType(shapes), shared=len(at) > 1)


@dataclass(frozen=True)
class CommonFit:
    """Sizes of the common model in one recording with their standard errors (infinite where the recording does not
    show them), the degrees of freedom, the RMS of what is left (m) and what is left itself (N, D), m."""

    sizes: tuple[Array, ...]
    errors: tuple[Array, ...]
    freedom: int
    rms: float
    left: Array


def fit_common(arm: Arm, recording: Recording, terms: Sequence[Candidate], *, rules: Rules = RULES) -> CommonFit:
    """Fit the common model to the tip's readings of a recording, beside its nuisances; about what it found, again and
    again, until the sizes stay (an arm that gives by millimetres moves beyond first order).

    Standard errors are the larger of the plain ones and of those that let each visit have a separate error (K.-Y.
    Liang & S. L. Zeger, Biometrika 73 (1986) 13-22, doi:10.1093/biomet/73.1.13; visits are the clusters).
    """
    best = fitted = _fitted_about(arm, recording, terms, (), rules)
    for _ in range(ROUNDS):
        before = fitted
        fitted = _fitted_about(arm, recording, terms, _motions(terms, before), rules)
        if fitted.rms < best.rms:
            best = fitted
        if _stays(before, fitted, rules.search.motion_matters):
            break
    return best


def _fitted_about(
    arm: Arm, recording: Recording, terms: Sequence[Candidate], about: Sequence[EffectEntry], rules: Rules
) -> CommonFit:
    observed = observe(arm, recording, about=about, rules=rules)
    return fit_columns(observed, [_columns(observed, term) for term in terms], observed.residual)


def _motions(terms: Sequence[Candidate], fitted: CommonFit) -> tuple[EffectEntry, ...]:
    """What was fitted as entries of an arm file; what the recording does not show, and shares of loads, stay out."""
    pairs = zip(terms, fitted.sizes, fitted.errors, strict=True)
    return tuple(
        as_entry(term, term.from_slopes(sizes.tolist()))
        for term, sizes, errors in pairs
        if not term.share and np.isfinite(errors).all() and len(sizes) == len(term.sizes)
    )


def _stays(before: CommonFit, fitted: CommonFit, share: float) -> bool:
    """Whether no size that is shown moved by more than a share of its standard error."""
    threes = zip(before.sizes, fitted.sizes, fitted.errors, strict=True)
    return all(bool(np.all((np.abs(other - one) <= share * error)[np.isfinite(error)])) for one, other, error in threes)


def fit_columns(observed: Observed, columns: Sequence[Array], target: Array) -> CommonFit:
    """Fit the columns of each term (N, C, d) to a target (N, C), m and rad, in the tip's readings, beside nuisances;
    errors are those of `fit_common`."""
    width = observed.components
    beside = nuisances(observed)[0][:, :width]
    design = np.concatenate([beside, *(column[:, :width] for column in columns)], axis=2)
    flat = target[:, :width].reshape(-1)
    full = design.reshape(len(flat), design.shape[2])
    size = np.linalg.norm(full, axis=0)
    size = np.where(size > 0.0, size, 1.0)
    _, singular, vt = np.linalg.svd(full / size, full_matrices=False)
    good = singular > 1e-9 * max(float(singular.max(initial=0.0)), 1e-300)
    inverse = (vt[good].T / singular[good] ** 2) @ vt[good]
    scaled = full / size
    values = inverse @ (scaled.T @ flat)
    left = flat - scaled @ values
    freedom = max(len(flat) - int(good.sum()), 1)
    covariance = inverse * float(left @ left) / freedom
    determined = np.diag(vt[good].T @ vt[good]) > 1.0 - 1e-6
    plain, clustered = (np.diag(covariance), _clustered(scaled, left, inverse, observed))
    variance = np.maximum(plain, clustered)
    if np.any(clustered > plain):
        # Errors that visits share are known from as many values as there are visits.
        freedom = max(min(freedom, int(observed.block.max()) + 1 - int(good.sum())), 1)
    errors = np.where(determined & (np.linalg.norm(full, axis=0) > 0.0), np.sqrt(variance) / size, np.inf)
    edges = np.cumsum([beside.shape[2], *(column.shape[2] for column in columns)]).tolist()
    spans = [slice(a, b) for a, b in itertools.pairwise(edges)]
    sizes = values / size
    rest = left.reshape(-1, width)
    return CommonFit(tuple(sizes[s] for s in spans), tuple(errors[s] for s in spans), freedom, rms_length(rest), rest)


def _columns(observed: Observed, term: Candidate) -> Array:
    columns = columns_of(observed, term)
    return np.zeros((*observed.residual.shape, len(term.sizes))) if columns is None else columns


def _clustered(design: Array, left: Array, inverse: Array, observed: Observed) -> Array:
    """Variances of the sizes where the readings of a visit share an error; zeros where visits are too few to tell."""
    visits = blocks_of(observed.block)
    if len(visits) < observed.rules.fitting.least_parts or design.shape[1] == 0:
        return np.zeros(design.shape[1])
    scores = (design * left[:, None]).reshape(-1, observed.components, design.shape[1]).sum(axis=1)
    sums = np.stack([scores[rows].sum(axis=0) for rows in visits])
    count = len(visits)
    return np.diag(inverse @ (sums.T @ sums) @ inverse) * count / max(count - 1, 1)


def _changes(arm: Arm, terms: Sequence[Candidate], fitted: Sequence[CommonFit], level: float) -> tuple[Change, ...]:
    sizes, errors = list[tuple[str, FittedParameter, FittedParameter]](), list[float]()
    for index, term in enumerate(terms):
        for column, name in enumerate(term.sizes):
            kind, errors_here = kind_of(arm, term, name), [float(item.errors[index][column]) for item in fitted]
            first, second = (
                _parameter(name, term.numbers, kind, float(item.sizes[index][column]), error, item.freedom)
                for item, error in zip(fitted, errors_here, strict=True)
            )
            sizes.append((term.effect, first, second))
            errors.append(float(np.hypot(errors_here[0], errors_here[1])))
    return changes_of(sizes, errors, min(item.freedom for item in fitted), level)


def changes_of(
    sizes: Sequence[tuple[str, FittedParameter, FittedParameter]], errors: Sequence[float], freedom: int, level: float
) -> tuple[Change, ...]:
    """Effects' sizes in two recordings set against each other by the standard errors of their differences (Student's t)
    and adjusted for their number."""
    changes: list[Change] = []
    for (effect, first, second), error in zip(sizes, errors, strict=True):
        difference, reach = second.value - first.value, t_quantile(freedom) * error
        p = float(2.0 * stats.t.sf(abs(difference) / error, freedom)) if 0.0 < error < np.inf else 1.0
        changes.append(
            Change(effect, first, second, difference, (difference - reach, difference + reach), p, 1.0, level)
        )
    adjusted = holm([change.p_value for change in changes])
    return tuple(replace(change, adjusted=value) for change, value in zip(changes, adjusted, strict=True))


def _parameter(name: str, at: tuple[int, ...], kind: str, value: float, error: float, freedom: int) -> FittedParameter:
    reach = t_quantile(freedom) * error
    label = f"{name}_{at[0]}" if len(at) == 1 else name
    return FittedParameter(label, name, at, kind, value, (value - reach, value + reach))


def holm(p_values: Sequence[float]) -> list[float]:
    """P values adjusted for their number by Holm's method."""
    p = np.array(p_values, dtype=float)
    order = np.argsort(p, kind="stable")
    p[order] = np.maximum.accumulate(np.minimum(1.0, np.arange(len(p), 0, -1) * p[order]))
    return p.tolist()


def _pairs(first: Sequence[Covered], second: Sequence[Covered]) -> tuple[tuple[Covered, Covered], ...]:
    other = {item.symbol: item for item in second}
    return tuple((item, other[item.symbol]) for item in first if item.symbol in other)


def _unequal(first: Recording, second: Recording) -> list[str]:
    """What makes a comparison lame: columns that only one of them has."""
    names = (
        ("payload_mass", "the payload"),
        ("temperature", "the temperature"),
        ("sides", "the side of approach"),
        ("force", "the force at the tip"),
    )
    unequal: list[str] = []
    for name, words in names:
        there = [getattr(item, name) is not None for item in (first, second)]
        if there[0] != there[1]:
            which = "first" if there[0] else "second"
            unequal.append(f"Only the {which} recording holds {words}.")
    if first.frame != second.frame or first.tool != second.tool:
        unequal.append(
            "Frame or tool are free in one recording and known in the other: what they hide is not compared."
        )
    return unequal
