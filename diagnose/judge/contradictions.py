"""Held-out figures that contradict each other, and what that means for the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from linkwright.core.diagnose.rules.rules import Rules

_OTHER_PLACES = "Repeats or close neighbours make single rows easy to predict. Expect the larger figure at other poses."
_OTHER_TIMES = (
    "The arm or the instrument changed during the recording, or a load or temperature occurs at one time alone. "
    "Diagnose each stretch by itself."
)
_OTHER_MOTION = "The fit describes the recorded motion alone. Record more varied motion before using the arm file."
_OTHER_RECORDING = "Each recording shows motion that the others lack. Expect the larger figure in motion of neither."
_PAIRS = (
    ("pose blocks", "random rows", "Held-out blocks of poses", "held-out single rows", _OTHER_PLACES),
    ("time blocks", "pose blocks", "Held-out stretches of time", "held-out blocks of poses", _OTHER_TIMES),
    ("one recording at a time", "pose blocks", "Held-out recordings", "held-out blocks of poses", _OTHER_RECORDING),
    ("time blocks", "", "Held-out stretches of time", "the motion that was fitted", _OTHER_MOTION),
    ("logs", "", "Held-out logs", "the motion that was fitted", _OTHER_MOTION),
)
"""What is held out, what beside (empty: nothing is), both as people read them, and what a large ratio means."""


def contradictions(
    in_sample: float, held_out: Mapping[str, float], shown: Callable[[float], str], *, rules: Rules, noise: float = 0.0
) -> tuple[str, ...]:
    """Sentences on held-out figures that cannot all describe one arm; empty where they agree.

    Args:
        in_sample: RMS of what the fit leaves of the readings that it was fitted to.
        held_out: RMS of what it leaves of readings that it was not fitted to, by what is held out at a time:
            `pose blocks`, `random rows`, `time blocks`, `one recording at a time`, `logs`.
        shown: A figure with its unit.
        rules: From which ratio on figures contradict each other.
        noise: RMS of the noise (0: unknown); figures within it contradict nothing.

    >>> from linkwright.core.diagnose.rules.rules import RULES
    >>> contradictions(0.1, {"random rows": 0.11, "pose blocks": 0.12}, "{:.2g} mm".format, rules=RULES)
    ()
    >>> contradictions(0.145, {"random rows": 0.11}, "{:.3g} mm".format, rules=RULES)[0][:58]
    'Held-out readings leave 0.11 mm and fitted ones 0.145 mm. '
    """
    results: list[str] = []
    best = min(held_out.values(), default=in_sample)
    if best < (1.0 - rules.answer.held_out_easier) * in_sample and in_sample > noise:
        results.append(
            f"Held-out readings leave {shown(best)} and fitted ones {shown(in_sample)}. A fit of the same model cannot "
            f"do that, so the held-out figure is too good. Expect at least {shown(in_sample)}."
        )
    figures = {"": in_sample, **held_out}
    for harder, easier, what, beside, means in _PAIRS:
        # Where rows are held out as well, they and not the fitted readings are what blocks stand beside.
        if harder not in figures or easier not in figures or (not easier and "random rows" in figures):
            continue
        if figures[harder] > noise and figures[harder] >= rules.answer.held_out_apart * figures[easier]:
            results.append(f"{what} leave {shown(figures[harder])}, {beside} {shown(figures[easier])}. {means}")
    return tuple(results)
