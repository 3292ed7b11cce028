"""Which parameters of an arm are watched, and what each recording says that they are."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.compare.compare import CommonFit, candidate_of, fit_columns
from linkwright.core.diagnose.fitting.corrected_arm import as_entry
from linkwright.core.diagnose.fitting.prepare import nuisances
from linkwright.core.diagnose.fitting.terms import Term, term_at
from linkwright.core.diagnose.options import Progress, silent
from linkwright.core.diagnose.patterns.library import Candidate, candidates, columns_of, kind_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed, kept
from linkwright.core.diagnose.result import Finding
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.diagnose.steps.diagnosis import cleaned_of
from linkwright.core.sections.numeric import Array

_RIDGE = 1e-12
"""What keeps columns that are multiples of each other apart, of their squares."""


@dataclass(frozen=True)
class Unwatched:
    """An effect at joints or links (from 1) that is not watched, and why, as a clause."""

    effect: str
    at: tuple[int, ...]
    why: str


@dataclass(frozen=True)
class Begun:
    """A candidate with the sizes (d,) about which it is fitted; `identified`: it was, and is not merely asked for."""

    candidate: Candidate
    sizes: Array
    identified: bool


@dataclass(frozen=True)
class Chosen:
    """What is fitted in each recording, what is held as it was found, and what is not watched.

    `about` is all that was found, as entries of the arm's effects: first order is taken about it."""

    watched: tuple[Begun, ...]
    held: tuple[Begun, ...]
    left_out: tuple[Unwatched, ...]
    about: tuple[EffectEntry, ...]


@dataclass(frozen=True)
class Parameter:
    """One watched size: the effect, where it acts (from 1), its name and the kind of quantity that it is."""

    effect: str
    at: tuple[int, ...]
    name: str
    kind: str
    identified: bool

    @property
    def label(self) -> str:
        """`compliance_2`."""
        return f"{self.name}_{self.at[0]}" if len(self.at) == 1 else self.name


@dataclass(frozen=True)
class Estimates:
    """Of N recordings the sizes (N, P) of P parameters and their standard errors (infinite where a recording does not
    show one), degrees of freedom (N,), the RMS length (m) of what is left (N,), and how many readings were used (N,)
    and `left_out` (N,) because they lie far off."""

    values: Array
    errors: Array
    freedom: Array
    rms: Array
    rows: tuple[int, ...]
    left_out: tuple[int, ...]


def begun(findings: Sequence[Finding], most: int) -> tuple[list[Begun], list[Begun]]:
    """What a diagnosis of the recordings together found, as it is to be fitted in each; and what of it is held:
    curves of more coefficients than `most`."""
    made: dict[tuple[str, tuple[int, ...]], Begun] = {}
    for finding in findings:
        if finding.effect not in EFFECTS:
            continue
        candidate = candidate_of(finding)
        values = {parameter.parameter: parameter.value for parameter in finding.parameters}
        place = (candidate.effect, candidate.at)
        if finding.recording:
            # What one recording has more than the others: all have the same pattern, most of them none of it.
            made.setdefault(place, Begun(candidate, np.zeros(len(candidate.sizes)), identified=True))
            continue
        known = tuple(name for name in candidate.sizes if name in values)
        if known:
            candidate = replace(candidate, sizes=known)
            made[place] = Begun(candidate, np.array([values[name] for name in known]), identified=True)
    every = list(made.values())
    few = [item for item in every if len(item.sizes) <= most]
    return few, [item for item in every if len(item.sizes) > most]


def choose(
    arm: Arm,
    recordings: Sequence[Recording],
    findings: Sequence[Finding],
    asked: Collection[str],
    *,
    rules: Rules = RULES,
) -> Chosen:
    """What is watched: what was found, and of the effects `asked` for those that each recording shows beside it."""
    few, held = begun(findings, rules.plan.widest_rival)
    about = tuple(
        as_entry(item.candidate, item.sizes.tolist())
        for item in (*few, *held)
        if not item.candidate.share and item.sizes.any()
    )
    seen = [observe(arm, recording, about=about, rules=rules) for recording in recordings]
    left_out = [
        Unwatched(item.candidate.effect, item.candidate.numbers, "its curve is held as it was found") for item in held
    ]
    basics = [basic for basic in _basics(seen, asked) if not any(_same(basic, other) for other in (*few, *held))]
    watched: list[Begun] = []
    shares = np.zeros(0)
    for each in (*few, *basics):
        now = _shown(seen, [*watched, each])
        kept_clear = np.array([one.identified for one in watched], dtype=bool)
        clear = bool(np.all((now[:-1] >= rules.watch.hides * shares)[kept_clear]))
        if clear and bool(np.all(now >= rules.watch.shown)):
            watched.append(each)
            shares = now if each.identified else np.concatenate([shares, now[-1:]])
        elif each.identified:
            held.append(each)
            left_out.append(_hidden(each, "single recordings do not show it: it is held as it was found"))
        else:
            left_out.append(_hidden(each, "the recordings do not tell it from what is watched, frame and tool"))
    return Chosen(tuple(watched), tuple(held), tuple(left_out), about)


def _hidden(each: Begun, why: str) -> Unwatched:
    return Unwatched(each.candidate.effect, each.candidate.numbers, why)


def _same(one: Begun, other: Begun) -> bool:
    return (one.candidate.effect, one.candidate.at) == (other.candidate.effect, other.candidate.at)


def _basics(seen: Sequence[Observed], wanted_names: Collection[str]) -> list[Begun]:
    """The candidates of the effects asked for, each at one joint or link, that every recording could show."""
    without = frozenset(EFFECTS) - frozenset(wanted_names)
    visible: dict[tuple[str, tuple[int, ...]], Candidate] = {}
    for candidate, columns in candidates(seen[0], without):
        plain = not (candidate.share or candidate.shared) and columns.shape[2] == len(candidate.sizes)
        if plain and all(columns_of(item, candidate) is not None for item in seen[1:]):
            visible.setdefault((candidate.effect, candidate.at), candidate)
    order = {name: place for place, name in enumerate(wanted_names)}
    chosen = sorted(visible.values(), key=lambda item: (order[item.effect], item.at))
    return [Begun(item, np.zeros(len(item.sizes)), identified=False) for item in chosen]


def _shown(seen: Sequence[Observed], terms: Sequence[Begun]) -> Array:
    """How much of each term's pattern is left beside all others and the nuisances: the least of its sizes', in the
    middle one of the recordings."""
    shares: list[list[float]] = []
    for observed in seen:
        width = observed.components
        beside = nuisances(observed)[0][:, :width]
        parts = [term.columns[:, :width] for term in terms_of(observed, terms)]
        edges = np.cumsum([beside.shape[2], *(part.shape[2] for part in parts)]).tolist()
        whole = np.concatenate([beside, *parts], axis=2).reshape(observed.rows * width, -1)
        size = np.linalg.norm(whole, axis=0)
        scaled = whole / np.where(size > 0.0, size, 1.0)
        variances = np.diag(np.linalg.inv(scaled.T @ scaled + _RIDGE * np.eye(scaled.shape[1])))
        apart = np.where(size > 0.0, 1.0 / np.sqrt(variances), 0.0)
        shares.append([float(apart[a:b].min()) for a, b in itertools.pairwise(edges)])
    return np.median(np.array(shares), axis=0)


def terms_of(observed: Observed, terms: Sequence[Begun]) -> list[Term]:
    """Terms with their columns in a recording; what it does not show at all has columns of zeros."""
    made: list[Term] = []
    for term in terms:
        columns = columns_of(observed, term.candidate)
        if columns is None or columns.shape[2] != len(term.sizes):
            columns = np.zeros((*observed.residual.shape, len(term.sizes)))
            made.append(Term(term.candidate, term.sizes, columns, np.zeros(observed.residual.shape)))
        else:
            made.append(term_at(observed, term.candidate, term.sizes, columns))
    return made


def parameters_of(arm: Arm, chosen: Chosen) -> tuple[Parameter, ...]:
    """The sizes that are watched, in the order of the estimates' columns."""
    return tuple(
        Parameter(
            item.candidate.effect, item.candidate.numbers, name, kind_of(arm, item.candidate, name), item.identified
        )
        for item in chosen.watched
        for name in item.candidate.sizes
    )


def estimate(
    arm: Arm, recordings: Sequence[Recording], chosen: Chosen, tell: Progress = silent, *, rules: Rules = RULES
) -> Estimates:
    """What each recording by itself says, with frame and tool of its own where they are free; `tell` hears which
    recording is at work, and what share of them is behind."""
    values: list[Array] = []
    errors: list[Array] = []
    fits: list[CommonFit] = []
    rows: list[int] = []
    left_out: list[int] = []
    for number, recording in enumerate(recordings):
        tell(f"fitting recording {number + 1} of {len(recordings)}", number / len(recordings))
        used, fitted = _fitted(arm, recording, chosen, rules)
        values.append(np.concatenate([np.zeros(0), *fitted.sizes]))
        errors.append(np.concatenate([np.zeros(0), *fitted.errors]))
        fits.append(fitted)
        rows.append(used)
        left_out.append(recording.size - used)
    return Estimates(
        np.array(values),
        np.array(errors),
        np.array([item.freedom for item in fits]),
        np.array([item.rms for item in fits]),
        tuple(rows),
        tuple(left_out),
    )


def _fitted(arm: Arm, recording: Recording, chosen: Chosen, rules: Rules) -> tuple[int, CommonFit]:
    _, _, recording_clean, _ = cleaned_of(arm, recording, rules)
    observed = observe(arm, recording_clean, about=chosen.about, rules=rules)
    fitted = _least_squares(observed, chosen)
    length = np.linalg.norm(fitted.left, axis=1)
    middle = float(np.median(length))
    far = length > rules.watch.far_off * middle
    if middle > 0.0 and far.any() and not far.all():
        recording_clean = kept(recording_clean, ~far)
        fitted = _least_squares(observe(arm, recording_clean, about=chosen.about, rules=rules), chosen)
    return recording_clean.size, fitted


def _least_squares(observed: Observed, chosen: Chosen) -> CommonFit:
    held, watched = terms_of(observed, chosen.held), terms_of(observed, chosen.watched)
    gone = sum((item.moved for item in held), np.zeros(1))
    bent = sum((item.moved - item.columns @ item.sizes for item in watched), np.zeros(1))
    return fit_columns(observed, [item.columns for item in watched], observed.residual - gone - bent)
