"""What the arm file holds: the rival that predicts held-out readings best. Verdict and file are two questions.

A form of unknown physics may be the better answer than names, and stands in no file. What names predict of readings
that they were not fitted to they predict all the same; so may what everybody fits, where no name is sure. All rivals
are fitted jointly about the arm as they make it, sizes at their bounds refitted beside, and held out by the same folds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.elastic.base_compliance import BASE_COMPLIANCE
from linkwright.core.arm.effects.elastic.joint_compliance import JOINT_COMPLIANCE
from linkwright.core.arm.effects.elastic.link_modulus import LINK_MODULUS
from linkwright.core.arm.effects.thermal.thermal_expansion import THERMAL_EXPANSION
from linkwright.core.diagnose.answer.confirmation import Confirmed
from linkwright.core.diagnose.answer.sentences import label_of, mm
from linkwright.core.diagnose.fitting.fit import fit, remaining
from linkwright.core.diagnose.fitting.held_out import HeldOut, folds_of_rivals
from linkwright.core.diagnose.fitting.joint.sizes import tether
from linkwright.core.diagnose.fitting.prepare import Prepared, packed_up, set_up
from linkwright.core.diagnose.fitting.refit import Refit, shared_of
from linkwright.core.diagnose.fitting.relinearize import relinearized
from linkwright.core.diagnose.patterns.library import Candidate, columns_of, of_single_numbers
from linkwright.core.diagnose.residual.observe import observed_about
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.residual.visits import poses
from linkwright.core.sections.numeric import Array

from .rivals import Name, Rival, Rivals, chosen

_GIVES = (JOINT_COMPLIANCE.id, BASE_COMPLIANCE.id, THERMAL_EXPANSION.id)
"""What everybody fits beside zeros and lengths: how far drives and base give, and links expand (B. W. Mooring, Z. S.
Roth & M. R. Driels, Fundamentals of Manipulator Calibration, Wiley 1991, ch. 6)."""
_PLAIN = (*_GIVES, LINK_MODULUS.id)
"""What two plain sizes may be beside zeros and lengths."""
_USUAL = 1.0
"""Of the largest usual size: one standard deviation of a number that nobody has named."""


@dataclass(frozen=True)
class Filed:
    """A rival as its file holds it: the joint fit of its causes, on which readings, beside which forms (groups of
    `prepared`, which stand in no file). `left` and `held_out` are the tip's residuals (N, D), m, of all readings, and
    of each by a fit without its fold."""

    name: Name
    prepared: Prepared
    refit: Refit
    outside: tuple[int, ...]
    left: Array
    held_out: Array


@dataclass(frozen=True)
class ForFile:
    """What the arm file is written from (`written`), the `rivals`, the names that a file can hold (`holds`), and
    whether these are those of the answer (`as_said`)."""

    written: Filed
    rivals: Rivals
    holds: tuple[str, ...]
    as_said: bool

    def note(self) -> str | None:
        """What is said where the file holds something else than the answer; None where it holds the same."""
        given, best = self.rivals.of("nominal"), self.rivals.of(self.written.name)
        if given is None or best is None or not (self.holds or best.name == "textbook"):
            return None
        if best.name == "nominal" or (best.name in ("pair", "ridge") and self.as_said):
            return self.rivals.why
        if best.name == "named" and self.as_said:
            return None
        held = ["the textbook calibration"] if best.name == "textbook" else list(self.holds)
        held += ["a small share of the rest"] if best.name == "ridge" else []
        listed = held[0] if len(held) == 1 else f"{', '.join(held[:-1])} and {held[-1]}"
        return (
            f"The written arm file holds {listed}. This is a fit, not the causes. It leaves {mm(best.held_out)} of "
            f"readings not fitted, the arm as given {mm(given.held_out)}."
        )


def for_file(names: Confirmed) -> ForFile:
    """What the arm file is written from, by what rivals predict of readings not fitted."""
    folds = folds_of_rivals(names.observed, names.folds)
    parts = _parts(names, folds)
    best = _without_forms(names, folds)
    filed = [_nominal(best, folds), *([_named(best, folds)] if best.members else [])]
    filed += _pair(names, filed[-1], folds)
    if _may_have_rivals(names):
        named = [term.candidate for term in best.refit.terms]
        textbook, families = _textbook(names), {candidate.family for candidate in named}
        rest = [candidate for candidate in textbook if candidate.family not in families]
        filed += _fitted(best, "textbook", textbook, folds)
        filed += _fitted(best, "ridge", [*named, *rest], folds) if named and rest else []
    rivals = chosen([_rival(item, parts, names.observed.recording.tips) for item in filed], rules=names.rules)
    written = next(item for item in filed if item.name == rivals.written)
    labels = tuple(best.label(member) for member in best.members)
    if rivals.written == "pair":
        labels = tuple(label_of(term.candidate, names.observed.recording) for term in written.refit.terms)
    as_said = set(labels) == {names.label(member) for member in names.members}
    return ForFile(written, rivals, labels, as_said)


def _without_forms(names: Confirmed, folds: NDArray[np.int64]) -> Confirmed:
    """The names that a file can hold: those beside a form, or those that fit best where none stands beside them."""
    if names.named is None or not names.forms or not names.named.without_forms:
        return names
    alone = names.of_the_library(names.named.without_forms)
    better = not names.members or rms_length(_named(alone, folds).held_out) < rms_length(_named(names, folds).held_out)
    return alone if alone.members and better else names


def _may_have_rivals(names: Confirmed) -> bool:
    """Whether more than names and nothing is tried: not of recordings of several arms, nor beside transforms that the
    file leaves free, nor where nothing was searched or is there to be explained. Nor where a joint hardly moved: what
    everybody fits there is not told, and no reading held out tells what it does elsewhere."""
    recording = names.observed.recording
    free = recording.units or names.observed.arm_given.unknown_origins
    least, travel = names.rules.fitting.rival_travel, np.ptp(recording.q, axis=0)
    moved = all(
        span > least for span, joint in zip(travel, names.observed.arm_given.joints, strict=True) if joint.revolute
    )
    return not free and moved and names.named is not None and bool(names.members or names.outside)


def _pair(names: Confirmed, other: Filed, folds: NDArray[np.int64]) -> list[Filed]:
    """The two plain sizes that fit best, as if neighbouring readings shared nothing: what they share may be what no
    size explains. None where they predict readings held out no better than the `other`."""
    recording, free = names.observed.recording, names.observed.arm_given.unknown_origins
    if names.named is None or recording.units or free or not (names.members or names.outside):
        return []
    plain = np.array([_is_plain(group.candidate, _PLAIN) for group in names.search.pool.groups], dtype=bool)
    best = names.namer.best(plain, 2).get(2)
    if best is None:
        return []
    candidates = [names.search.pool.groups[member].candidate for member in best.members]
    pair = _fitted(names, "pair", candidates, folds, memory=0.0)
    return [item for item in pair if _held_out(item) < _held_out(other)]


def _textbook(names: Confirmed) -> list[Candidate]:
    """What everybody fits, as far as these readings show it: of each number the variant with most sizes and without
    delay."""
    shown: dict[object, Candidate] = {}
    for group in names.search.pool.groups:
        candidate = group.candidate
        if not _is_plain(candidate, _GIVES):
            continue
        known = shown.get(candidate.family)
        if known is None or len(candidate.sizes) > len(known.sizes):
            shown[candidate.family] = candidate
    return list(shown.values())


def _is_plain(candidate: Candidate, gives: Sequence[str]) -> bool:
    """Whether a candidate is a zero or a length, or of the effects that give, at one place and without delay."""
    if candidate.outside or candidate.share or candidate.only is not None or len(candidate.at) > 1:
        return False
    plain = candidate.effect in gives and not any(candidate.shapes.values())
    return plain or of_single_numbers(EFFECTS[candidate.effect])


def _nominal(names: Confirmed, folds: NDArray[np.int64]) -> Filed:
    """The arm as given; transforms that it leaves free stand where they fit best without a cause."""
    if names.named is not None and names.observed.arm_given.unknown_origins and names.members:
        names = names.of_the_library(())
    prepared, width = names.prepared, names.observed.components
    left = remaining(prepared, fit(prepared, ()))[:, :width]
    held_out = HeldOut(names.observed, [prepared.beside], folds, nuisances=1).residual()
    return Filed("nominal", prepared, Refit((), (), names.observed.residual, 0.0, 0), (), left, held_out)


def _named(names: Confirmed, folds: NDArray[np.int64]) -> Filed:
    """Names as they were confirmed; what forms beside them predict stands in no file."""
    shown = range(1 + len(names.members))
    held_out = names.held_out_of(folds, as_filed=True).residual(range(len(shown) + len(names.outside)), shown=shown)
    return Filed("named", names.prepared, names.refit, names.outside, names.after(), held_out)


def _fitted(
    names: Confirmed,
    name: Name,
    candidates: Sequence[Candidate],
    folds: NDArray[np.int64],
    memory: float | None = None,
) -> list[Filed]:
    """Causes fitted together, each held to what is usual, neighbouring readings sharing as much noise as was found, or
    so much (`memory`, a correlation); none where nothing of them shows."""
    observed = observed_about(names.observed, (), names.observed.softening)
    observed = observed if memory is None else replace(observed, correlation=memory)
    patterns = [(candidate, columns_of(observed, candidate)) for candidate in candidates]
    packed = packed_up((candidate, columns) for candidate, columns in patterns if columns is not None)
    prepared = set_up(observed, packed, names.prepared.rejected)
    prepared = replace(prepared, together=names.prepared.together, width=_USUAL)
    if not prepared.pool.groups:
        return []
    about = relinearized(prepared, range(len(prepared.pool.groups)), (), bounded=True)
    prepared, joint = about.prepared, about.refit
    tethers = [tether(term, about.fitted.unit, _USUAL, rules=names.rules.fitting) for term in joint.terms]
    columns = [prepared.beside, *(term.columns for term in joint.terms)]
    shared = shared_of(prepared, joint)
    held = HeldOut(prepared.observed, columns, folds, [None, *tethers], nuisances=1, shared=shared)
    return [Filed(name, prepared, joint, (), joint.residual[:, : prepared.observed.components], held.residual())]


def _parts(names: Confirmed, folds: NDArray[np.int64]) -> NDArray[np.int64]:
    """Groups of readings (N,) that say each for itself how much better a rival is: poses, where there are more of them
    than folds, neighbours together where these tell as much as one."""
    pose = poses(names.observed)
    return pose if names.prepared.together == 1 and pose.max() > folds.max() else folds


def _held_out(item: Filed) -> float:
    """RMS (m) of readings held out: those that were fitted are predicted no worse, or another fit was judged."""
    return max(rms_length(item.held_out), rms_length(item.left))


def _rival(item: Filed, parts: NDArray[np.int64], tips: NDArray[np.int64]) -> Rival:
    """A rival by sums of squares of each part, for each tip of the arm."""
    losses, rows = (np.zeros((int(parts.max()) + 1, int(tips.max()) + 1)) for _ in range(2))
    judged = item.held_out if rms_length(item.held_out) == _held_out(item) else item.left
    np.add.at(losses, (parts, tips), np.sum(judged**2, axis=1))
    np.add.at(rows, (parts, tips), 1.0)
    terms, weights = item.refit.terms, len(item.refit.weights)
    count = weights + sum(1 if term.shared else term.columns.shape[2] for term in terms)
    return Rival(item.name, count, rms_length(item.left), _held_out(item), losses, rows)
