"""The steps in order: noise floor, nuisances, gate, location, names, tests, confirmation, what cannot be told apart."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from arm.chain import Arm, EffectEntry

from .conclusion import Conclusion
from .confirmed import ENOUGH_REPEATS
from .coupling import coupled
from .large import about_large
from .naming import FALSE_ALARM, Named, Namer, name_missing
from .noise import NoiseFloor, noise_floor
from .observed import kept, observe, visits
from .options import Options, Progress
from .orientation import with_sound_orientation
from .prepare import prepare
from .recording import Recording
from .result import Diagnosis
from .whole_search import LEVEL, whole_search_p

_LONG = 3000
"""Readings that are searched at most; the findings are then fitted to all of them."""
_LEAST_VISITS = 8
_LEAST = 12
"""Fewer observations than this beyond the nuisances decide nothing."""


def _silent(what: str, share: float) -> None:
    del what, share


def diagnose(
    arm: Arm, recording: Recording, options: Options | None = None, progress: Progress | None = None
) -> Diagnosis:
    """What an arm's model leaves out, by a recording of the real arm.

    Raises `arm.model.PropertyNeeded` and the materials' errors where the model lacks a figure that it needs.
    """
    began = time.perf_counter()
    asked, tell = options or Options(), progress or _silent
    tell("noise floor", 0.0)
    recording = with_sound_orientation(arm, recording)
    noise = noise_floor(recording, arm)
    cleaned = _without(recording, noise)
    tell("setting the recording against the model", 0.05)
    searched = _thinned(arm, cleaned, asked.seed)
    known = noise.rms_m if noise.source == "repeats" and noise.degrees_of_freedom >= ENOUGH_REPEATS else None
    prepared = prepare(observe(arm, searched), asked, known)
    tell("searching for what is missing", 0.3)
    namer = Namer(prepared, thorough=asked.thorough, seed=asked.seed)

    def about(found: tuple[EffectEntry, ...]) -> tuple[Namer, Named]:
        tell("searching again about what was found", 0.6)
        anew = prepare(observe(arm, searched, about=found), asked, known)
        other = Namer(anew, thorough=asked.thorough, seed=asked.seed)
        return other, name_missing(other, lambda _: None)

    too_few = int(prepared.visits[-1]) + 1 < _LEAST_VISITS or prepared.criterion.count < _LEAST
    if not prepared.pool.groups or too_few:
        named = None
    else:
        named = name_missing(namer, lambda share: tell("searching for what is missing", 0.3 + 0.3 * share))
        if min(test.p_value for test in named.gate) <= FALSE_ALARM:
            namer, named = about_large(namer, named, about)
        if named.members:
            again = coupled(namer, asked.without, lambda share: tell("loads and flexibility", 0.6 + 0.05 * share))
            if again is not namer:
                namer = again
                named = name_missing(namer, lambda share: tell("searching again", 0.65 + 0.05 * share))
        if asked.thorough and named.everything:
            told = "calibrating the whole search"
            p = whole_search_p(namer, named, asked.seed, lambda share: tell(told, 0.7 * share))
            named = replace(named, whole_p=p) if p <= LEVEL else Named((), (), (), named.gate, None, p)
    tell("fitting and confirming", 0.7)
    whole = cleaned if len(searched.q) < len(cleaned.q) else None
    return Conclusion(namer, named, noise, asked, whole=whole, progress=tell).result(arm, recording, began)


def _thinned(arm: Arm, recording: Recording, seed: int) -> Recording:
    """Whole visits of a long recording, picked at random: what to look for is plain from a few thousand readings."""
    if recording.size <= _LONG:
        return recording
    visit = visits(recording, arm)
    share = _LONG / recording.size
    taken = np.random.default_rng(seed).random(int(visit[-1]) + 1) < share
    return kept(recording, taken[visit])


def _without(recording: Recording, noise: NoiseFloor) -> Recording:
    """The recording without the rows that stand out from repeats of their own pose."""
    bad = {each.row for each in noise.outliers}
    return kept(recording, np.array([int(row) not in bad for row in recording.row])) if bad else recording
