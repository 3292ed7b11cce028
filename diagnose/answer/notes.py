"""What is said beside the plain answer: of the noise, of what was set aside, of what remains."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.special import chdtri

from linkwright.core.diagnose.residual.observe import beyond_first_order
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.diagnose.residual.wander_seen import seen_to_wander
from linkwright.core.diagnose.result import SetAside

from .confirmation import Confirmed
from .remainder import Remainder
from .sentences import mm, nothing_singly, of_small_causes, refutation


def notes(names: Confirmed, rest: Remainder) -> tuple[str, ...]:
    """The sentences."""
    return (*_of_noise(names, rest), *_of_names(names, rest), *_of_what_remains(names, rest))


def _of_noise(names: Confirmed, rest: Remainder) -> Iterator[str]:
    """What is said of orientations that are not fitted, and of noise with a memory."""
    observed = names.observed
    if observed.recording.orientation is not None and observed.recording.seat == "unused":
        yield "Orientations are not fitted. `orientation: free` in recording.yaml has them fitted too."
    if observed.wander > 0.0:
        yield _of_wander(names)
    if names.prepared.together > 1:
        yield (
            f"The remainder changes with time and with the arm's path, {names.prepared.together} visits at a time. "
            "Poses lie near the ones before, and too few are visited again. A wandering instrument cannot be told "
            "apart from the arm. No p-value of a finding holds then, and none is given. Visit some poses again during "
            "the recording."
        )
    if observed.correlation > 0.0:
        by = "are off alike, by noise or by what is not explained" if rest.unexplained else "share noise"
        yield f"Neighbouring readings {by} (correlation {observed.correlation:.2f}), which was allowed for."


def _of_wander(names: Confirmed) -> str:
    """What is said of a walk that was allowed for."""
    observed, timed = names.observed, names.observed.recording.time is not None
    scale = rms_length(observed.scale[None, : observed.components])
    speed = mm(scale * float(np.sqrt(observed.wander * (60.0 if timed else 1.0))))
    walk = f"a random walk of {speed} {'a minute' if timed else 'a reading'}"
    walk += f", {mm(names.wandered())} RMS over the recording"
    if shown := seen_to_wander(observed, names.after()):
        return f"The instrument wanders, as {shown} shows. Allowed for: {walk}. This is no physics of the arm."
    return (
        f"The instrument may wander. Allowed for: {walk}. The remainder changes with time rather than with the pose. "
        "Changes of the arm with time look the same. To separate the two, visit some poses again during the "
        "recording, or read a fixed target as well."
    )


def _of_names(names: Confirmed, rest: Remainder) -> Iterator[str]:
    """What is said of names that are refuted, set aside, or nothing singly."""
    if rest.left_over and names.members and rest.lack_of_fit is not None and rest.does_not_fit():
        yield refutation(rest.lack_of_fit)
    if rest.small is not None and rest.lack_of_fit is not None:
        yield of_small_causes(rest.small, rest.lack_of_fit)
    held_out = "Held-out readings fit as well without this finding."
    yield from (f"Set aside: {item}, beyond chance on the readings fitted. {held_out}" for item in names.unconfirmed)
    yield from (f"Set aside, as impossible under its name: {item}." for item in names.impossible)
    yield from (f"Set aside, as it moves the tip by next to nothing: {item}." for item in names.too_little)
    if names.together:
        yield nothing_singly([names.place(k) for k in names.together], names.moved(list(names.together)))
    if further := beyond_first_order_of(names):
        yield (
            f"The offsets are large: linearised they would be {1e3 * further:.2g} mm RMS off. The fit is exact. "
            "Designs and worst cases (optimize, evaluate) are linearised, and evaluate gives the error of that. Put "
            "such a zero, length or tool into the arm file itself."
        )


def _of_what_remains(names: Confirmed, rest: Remainder) -> Iterator[str]:
    """What is said of scatter, of rows set aside, and of what is beyond chance."""
    if rest.may_scatter:
        yield (
            f"{'No pose was' if names.noise.drift_m is None else 'Too few poses were'} visited again. The remainder "
            "may also be the arm's repeatability."
        )
    if rest.scatter() is not None:
        yield (
            "The remainder is more than readings of one visit differ by. This remainder does not recur when a pose is "
            "visited again, or nothing recorded predicts it from pose to pose. The arm does not return more exactly, "
            "or the cause changes faster than these readings can follow. Visit some poses three times or more, with "
            "others between."
        )
    if (aside := set_aside(names)) is not None:
        yield _of_aside(names, aside)
    yield from _stray(names)
    if names.named is None or names.named.left is None or names.outside:
        return
    p = min(test.p_value for test in names.named.left)
    if p <= names.rules.search.false_alarm:
        left, floor = rms_length(names.after()), names.noise.rms_m
        small = floor is not None and left <= floor
        within = ", though within the noise floor: something too small to be named may be in it" if small else ""
        yield f"What remains, {mm(left)} RMS, is more than chance (p = {p:.2g}){within}."


def set_aside(names: Confirmed) -> SetAside | None:
    """What the rows are worth that were set aside beside a model; None where none were."""
    off = np.array([item.off for item in names.prepared.rejected])
    if not len(off):
        return None
    alike = names.alike_aside
    if alike is not None and alike.p_value > names.rules.residual.level:
        alike = None
    return SetAside(len(off), rms_length(np.concatenate([names.after(), off])), alike)


def _of_aside(names: Confirmed, aside: SetAside) -> str:
    """What is said of them."""
    recording = names.observed.recording
    rows = recording.rows_of([item.row for item in names.prepared.rejected])
    left = mm(rms_length(names.after()))
    said = f"All figures are without readings that lie far off ({rows}). {left} RMS remain without these readings, "
    said += f"{mm(aside.rms_with)} with them."
    if aside.alike is None:
        return said
    alike = f"These rows are no chance blunders (p = {aside.alike.p_value:.1g}): {aside.alike.how}"
    return f"{said} {alike}, by something that is not named."


def beyond_first_order_of(names: Confirmed) -> float:
    """The RMS length (m) of what was found moves the tip by beyond first order; zero where it does not matter."""
    further = rms_length(beyond_first_order(names.observed, names.observed.about)) if names.observed.about else 0.0
    scatter = rms_length(names.observed.scale[None, : names.observed.components])
    return further if further > names.rules.search.motion_matters * scatter else 0.0


def _stray(names: Confirmed) -> list[str]:
    """What is said of readings that lie far off what is left by the middle ones, where they are too many to be set
    aside and no repeats bear the others out."""
    rules, width = names.rules.fitting, names.observed.components
    far_off = np.linalg.norm(names.after(), axis=1)
    scatter = float(np.median(far_off)) / np.sqrt(chdtri(width, 0.5))
    limit = rules.outlier_margin * np.sqrt(chdtri(width, rules.far_tail / len(far_off))) * scatter
    far = far_off > limit
    if names.named is None or scatter <= 0.0 or not rules.most_outliers < far.mean() < rules.most_alone:
        return []
    further, middle = mm(rms_length(names.after()[far])), mm(float(np.median(far_off)))
    recording = names.observed.recording
    rows = recording.rows_of(recording.row[far].tolist())
    return [
        f"{int(far.sum())} of {len(far)} readings lie further off than scatter explains, {further} RMS ({rows}). The "
        f"median reading is {middle} off. They are too many to be set aside without repeats. Read every pose three "
        "times, and bad readings show."
    ]
