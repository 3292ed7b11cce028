"""What two encoders at each drive show, as findings and in words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.effect import kind_at
from linkwright.core.diagnose.motion.findings import name_of, sized
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.diagnose.motion.result import Apart, MotionFinding
from linkwright.core.diagnose.result import FittedParameter

from .between import Between, Cause
from .sides import Sides


def encoder_findings(arm: Arm, shown: Sequence[Between], held_out: Sequence[float]) -> tuple[MotionFinding, ...]:
    """The causes between two encoders as findings; `held_out` (n,) N*m is left of torques, in which they add nothing:
    what the motor and the link take follows from where each is."""
    return tuple(_finding(arm, item, cause, held_out) for item in shown for cause in item.causes)


def _finding(arm: Arm, item: Between, cause: Cause, held_out: Sequence[float]) -> MotionFinding:
    effect, at, slides = cause.effect, (item.joint,), not arm.joints[item.joint - 1].revolute
    parameters: list[FittedParameter] = []
    for name, value in cause.sizes.items():
        parameter = next(each for each in effect.parameters if each.name == name)
        interval = (value - cause.half[name], value + cause.half[name])
        kind = kind_at(parameter, slides=slides)
        parameters.append(FittedParameter(f"{name}_{item.joint}", name, at, kind, value, interval))
    apart = Apart(item.before, item.after, cause.without, item.held_out, "m" if slides else "rad")
    text = (
        f"{name_of(effect.title, effect.place, at)}: {sized(effect.id, parameters)}. Without it the arm leaves "
        f"{apart.words(apart.without)} RMS between the two encoders of the joint, with it {apart.words(apart.left)}."
    )
    return MotionFinding(
        effect.id,
        at,
        tuple(parameters),
        (),
        tuple(np.zeros(len(held_out)).tolist()),
        tuple(held_out),
        cause.evidence,
        cause.p_value,
        text,
        apart=apart,
        draws=0,
    )


def _length(value: float, slides: bool) -> str:
    return f"{1e3 * value:.3g} {'mm' if slides else 'mrad'}"


def encoder_notes(arm: Arm, prepared: Sequence[PreparedLog], shown: Sequence[Between]) -> tuple[str, ...]:
    """Of what second encoders are taken to be, how far their zeros are apart, and what the arm leaves of them."""
    made = [_of_log(arm, Path(log.log.file).name, log.encoders) for log in prepared if log.encoders is not None]
    made += [
        f"{Path(log.log.file).name}: j columns are not used, because samples are too far apart to tell loads."
        for log in prepared
        if log.encoders is None and log.log.joint_side is not None
    ]
    return tuple(dict.fromkeys((*made, *(_remains(arm, shown) if shown else ()))))


def _remains(arm: Arm, shown: Sequence[Between]) -> tuple[str, str]:
    """What the arm as it is written leaves between encoders, and what of that no file can hold."""

    def each(value: Callable[[Between], float]) -> list[str]:
        return [_length(value(item), not arm.joints[item.joint - 1].revolute) for item in shown]

    pairs = zip(each(lambda item: item.held_out), each(lambda item: item.before), shown, strict=True)
    left = ", ".join(f"{after} RMS of {before} at joint {item.joint}" for after, before, item in pairs)
    around, way = ", ".join(each(lambda item: item.around)), ", ".join(each(lambda item: item.direction))
    late = ", ".join(f"{1e3 * item.late:.2f} ms" for item in shown)
    return (
        f"Between both encoders the written arm leaves {left}, on held-out motion. An offset and a delay that remain "
        f"between them are taken out ({late}, joint by joint).",
        f"No entry holds what of this goes round with a joint ({around}) and with the direction of its motion ({way}).",
    )


def _of_log(arm: Arm, name: str, encoders: Sides) -> str:
    if encoders.unlike:
        joints = f"joint{'s' * (len(encoders.unlike) > 1)} {', '.join(map(str, encoders.unlike))}"
        return (
            f"{name}: j columns are not used. At {joints} they tell of another motion than the q columns (units, "
            "signs, the order of joints?)."
        )
    side, other = ("the link's", "the motor's") if encoders.beyond_drive else ("the motor's", "the link's")
    by = "loads show that q is" if encoders.shown else "q is taken to be"
    zeros = zip(encoders.offset.tolist(), arm.joints, strict=True)
    each = ", ".join(_length(value, not joint.revolute) for value, joint in zeros)
    return (
        f"{name}: {by} of {side} side and j of {other}. Zeros of j stand {each} beyond those of q, joint by joint, and "
        f"j is read {1e3 * encoders.late:.2g} ms later. Both are allowed for and are not findings."
    )


def with_like_encoders(logs: Sequence[MotionLog]) -> tuple[Sequence[MotionLog], tuple[str, ...]]:
    """The logs as they are where all have second encoders, or none; else without them, and a sentence."""
    have = [log.joint_side is not None for log in logs]
    if all(have) or not any(have):
        return logs, ()
    return [replace(log, joint_side=None) for log in logs], (
        "j columns are not used, because some logs have none. Give logs with second encoders alone.",
    )
