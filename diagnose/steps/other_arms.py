"""Recordings of different arms taken for one: what no time changes differs from one recording to the other."""

from __future__ import annotations

from dataclasses import replace

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.answer.sentences import label_of, mm
from linkwright.core.diagnose.fitting.fit import fit, remaining
from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.result import OtherArms
from linkwright.core.diagnose.search.naming import Namer
from linkwright.core.diagnose.several.recordings import Several


def of_different_arms(
    arm: Arm, recordings: Several, asked: Options, floor: float | None, left: float
) -> OtherArms | None:
    """What tells arms apart, where sizes of each recording's own, of what stays the same as long as an arm does,
    explain what is `left` (RMS, m) otherwise; else None. `floor` (m) is what repeats of a pose differ by."""
    prepared = prepare(observe(arm, replace(recordings, units=True), rules=asked.rules), asked, floor)
    namer = Namer(prepared, thorough=False, seed=asked.seed)
    subsets = namer.best_of_library() if prepared.pool.groups else {}
    if not subsets:
        return None
    best = min(subsets.values(), key=lambda subset: subset.criterion).members
    remains = remaining(prepared, fit(prepared, best))[:, : prepared.observed.components]
    candidates = [namer.pool.groups[member].candidate for member in best]
    lasting = [
        candidate
        for candidate in candidates
        if candidate.only is not None and EFFECTS[candidate.effect].watch.lasts == "the arm"
    ]
    if not lasting or rms_length(remains) > asked.rules.mistakes.label_leaves * left:
        return None
    names = " and ".join(label_of(item, recordings) for item in lasting)
    return OtherArms(names, rms_length(remains))


def of_other_arms(arms: OtherArms) -> str:
    """The same as a sentence."""
    return (
        f"It looks as if the recordings were of different arms. With {arms.names}, {mm(arms.leaves)} would remain, but "
        "such a cause does not change within one arm. Diagnose each by itself. For several arms of one type, use "
        "--units."
    )
