"""What a diagnosis of motion logs says in plain words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.diagnose.judge.needed import small_words
from linkwright.core.diagnose.judge.rivals import Rivals

from .findings import less, name_of, or_else, sized
from .result import Change, Event, MotionFinding, MotionUnknown, OfJoint, Verdict

_SAID = 4
"""Effects that the plain answer names; the rest are counted."""


def verdict_of(named: Sequence[MotionFinding], unknown: MotionUnknown | None, events: Sequence[Event] = ()) -> Verdict:
    """The verdict: unknown wherever something stays that nothing explains, named or not what else is. A push is nothing
    that the arm's file lacks, a load is."""
    if unknown is not None:
        return "unknown"
    if not named:
        return "named" if any(not event.links for event in events) else "none"
    return "alias_class" if any(item.alternatives for item in named[:1]) else "named"


def answer(
    verdict: Verdict,
    named: Sequence[MotionFinding],
    unknown: MotionUnknown | None,
    per_joint: Sequence[OfJoint],
    rivals: Rivals | None = None,
    beyond: Sequence[float] = (),
    with_own: float | None = None,
    together: Sequence[float] = (),
) -> str:
    """The plain answer; where the file holds another of the rivals than what was named, which and why. `beyond` (n,)
    N*m is what else may differ between several logs, `with_own` N*m what is left beside what one log alone has,
    `together` (n,) N*m what small names add."""
    if verdict == "insufficient_data":
        return "The logs hold too little motion: no joint moves for three seconds above 0.03 rad/s."
    if not named and unknown is None:
        return "Nothing is missing that these logs show: no cause is beyond chance and foretells other motion."
    sentences = _lacking(named, per_joint, beyond, with_own, together) if named else []
    if unknown is not None:
        joints = f"joint{'s' * (len(unknown.joints) > 1)} {_and([str(joint) for joint in unknown.joints])}"
        names = [name.replace("_", " ") for name in unknown.depends_on]
        at_most = "up to " if len(unknown.joints) > 1 else ""
        on = f", which depends on {_and(names)}" if names else ""
        sentences.append(f"At {joints} {at_most}{unknown.amplitude:.3g} N*m stays unexplained{on}.")
        if unknown.change is not None:
            sentences.append(since_words(unknown.change))
    shared = any(not item.recording and item.apart is None for item in named)
    if shared and rivals is not None and rivals.written != "named":
        sentences.append(rivals.why)
    return " ".join(sentences)


def _first(
    named: Sequence[MotionFinding], together: float
) -> tuple[list[tuple[tuple[str, str], list[MotionFinding]]], str]:
    """The effects that are named, each with its findings, and the rest in words: small ones add so much (N*m)."""
    small = [item for item in named if item.small] if len(named) > _SAID else []
    of_effect: dict[tuple[str, str], list[MotionFinding]] = {}
    for item in named:
        if item not in small:
            of_effect.setdefault((item.effect, item.recording), []).append(item)
    every = list(of_effect.items())
    more = sum(len(each) for _, each in every[_SAID:])
    rest = f", and {more} more" if more else ""
    return every[:_SAID], rest + (f"; {small_words(len(small), f'{together:.2g} N*m')}" if small else "")


def _lacking(
    named: Sequence[MotionFinding],
    per_joint: Sequence[OfJoint],
    beyond: Sequence[float],
    with_own: float | None,
    together: Sequence[float],
) -> list[str]:
    """What the model lacks, what is left beside it, and what it cannot be distinguished from."""
    sentences: list[str] = []
    shown, rest = _first(named, max(together, default=0.0))
    if _mostly_friction(named):
        rubs = [_short(each) for (effect, _), each in shown if _friction(effect)]
        beside = [_short(each) for (effect, _), each in shown if not _friction(effect)]
        with_it = f"; beside it {_and(beside)}" if beside else ""
        sentences.append(f"Friction is what the model lacks most: {_and(rubs)}{with_it}{rest}.")
    else:
        sentences.append(f"The model lacks {_and([_short(each) for _, each in shown])}{rest}.")
    before = float(np.sqrt(np.nanmean([each.before**2 for each in per_joint])))
    held_out = float(np.sqrt(np.nanmean([each.held_out**2 for each in per_joint])))
    left = held_out if with_own is None else with_own
    between = [item for item in named if item.apart is not None]
    if len(between) < len(named):
        sentences.append(f"{left:.3g} of {before:.3g} N*m is left on motion that was not fitted.")
    sentences += dict.fromkeys(_between_words(item) for item in between)
    if any(item.recording for item in named):
        sentences.append(nothing_else(beyond))
    sentences += [_undecided(item) for item in named[:_SAID] if item.alternatives]
    return sentences


def _between_words(finding: MotionFinding) -> str:
    """How far a joint's two encoders are from each other beside what the arm file holds."""
    apart = finding.apart
    assert apart is not None
    left = f"{apart.words(apart.left)} of {apart.words(apart.nominal)}"
    return f"Between the two encoders of joint {finding.at[0]}, {left} is left on motion that was not fitted."


def nothing_else(beyond: Sequence[float]) -> str:
    """By how much logs may differ beside what was named, joint by joint (n,) N*m."""
    each = [f"{value:.2g} N*m at joint {joint}" for joint, value in enumerate(beyond, start=1)]
    return f"Nothing else differs between the logs by more than {_and(each)}."


def since_words(change: Change) -> str:
    """Since when torques follow another model, and which effect explains it."""
    effect, (low, high), end = EFFECTS[change.effect], change.start.interval, change.end
    name = name_of(effect.title, effect.place, change.at)
    size = sized(change.effect, change.parameters)
    then = "From then on" if end is None else f"Until {end.time:.4g} s"
    return (
        f"Something changed at {change.start.time:.4g} s (95 % interval {low:.4g} to {high:.4g} s). "
        f"{then}, {name} ({size} more) explains {100.0 * change.share:.0f} % of what is left."
    )


def event_words(event: Event) -> str:
    """When an event begins and ends, where, and how much."""
    begin, end = event.change.start.time, event.change.end
    when = f"from {begin:.4g} s on" if end is None else f"from {begin:.4g} to {end.time:.4g} s"
    size = sized(event.change.effect, event.change.parameters[:1])
    if not event.links:
        return f"{event.kind.capitalize()} {when}: {size}."
    most = max(range(len(event.change.torque)), key=lambda joint: event.change.torque[joint])
    links = " or ".join(str(link) for link in event.links)
    return (
        f"{event.kind.capitalize()} at link {links} {when}: {size}, which adds {event.change.torque[most]:.3g} N*m at "
        f"joint {most + 1}. Its rows are set aside."
    )


def _undecided(finding: MotionFinding) -> str:
    effect = EFFECTS[finding.effect]
    label = name_of(effect.title, effect.place, finding.at)
    return f"The data fit equally well: {or_else(finding.alternatives)}, in place of {label}."


def _friction(effect: str) -> bool:
    return EFFECTS[effect].cause.startswith("friction")


def _mostly_friction(named: Sequence[MotionFinding]) -> bool:
    """Whether several names of friction are most of what is missing."""
    size = [float(np.sum(np.square(item.rms_explained))) for item in named]
    rubs = [_friction(item.effect) for item in named]
    most = sum(value for value, friction in zip(size, rubs, strict=True) if friction) > 0.5 * sum(size)
    return most and sum(rubs) > 2


def _short(findings: Sequence[MotionFinding]) -> str:
    """What one effect does at all its places, with the first size at each."""
    ordered = sorted(findings, key=lambda finding: finding.at)
    effect = EFFECTS[ordered[0].effect]
    name = name_of(effect.title, effect.place, sorted({at for item in ordered for at in item.at}))
    name += f" in {ordered[0].recording} alone" if ordered[0].recording else ""
    if not all(item.parameters for item in ordered):
        return name
    if len(ordered) == 1:
        return f"{name} ({sized(effect.id, ordered[0].parameters[:1])}{less(ordered[0].parameters[:1])})"
    same = len({item.parameters[0].parameter for item in ordered}) == 1
    return f"{name} ({_and([sized(effect.id, item.parameters[:1], named=not same) for item in ordered])})"


def _and(items: Sequence[str]) -> str:
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"
