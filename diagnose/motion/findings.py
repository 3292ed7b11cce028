"""What was identified as findings: sizes with intervals, what each explains, and what else it could be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS, parameter_title
from linkwright.core.arm.effects.effect import Effect, kind_at
from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import format_quantity

from .causes.directions import instead_of_losses
from .judged import Judged
from .model.chance import DRAWS
from .model.evidence import Member
from .model.feasible import feasible
from .model.groups import Group
from .model.identify import Identified
from .model.intervals import Estimates
from .model.products import Products
from .model.ripple import DRAWS as OF_RIPPLE
from .model.ripple import Ripple
from .result import Alternative, MotionFinding

_NOTHING = 1e-3
"""Share of a joint's noise below which what a name explains in the file is nothing."""


def findings(
    identified: Identified, sizes: Estimates, judge: Judged, arm: Arm, *, rules: Rules
) -> tuple[MotionFinding, ...]:
    """The findings, the one that motion held out needs most first, small ones last.

    Args:
        identified: What was identified.
        sizes: Of its members, in their order.
        judge: What held-out motion says of the arm with them.
        arm: The arm.
        rules: Which names are distinguished.
    """
    made: list[MotionFinding] = []
    needed_ = judge.needed([member.group for member in identified.members], identified.pool, rules=rules)
    beside = identified.system.offers(identified.fitted).evidence
    start = 0
    for number, member in enumerate(identified.members):
        group = identified.pool.groups[member.group]
        part = slice(start, start + group.rank)
        start += group.rank
        others = [m for k, m in enumerate(identified.fitted) if k != number]
        plain = [*others, *identified.system.plain_beside(member.group, others)]
        offered = identified.system.offers(plain).evidence
        evidence = float(offered[member.group])
        variants = [identified.pool.groups[k] for k in identified.system.as_likely(member.group, offered)]
        made.append(
            finding_of_group(
                group,
                (sizes.gain * sizes.numbers)[part],
                identified.products,
                parameters_of(group, arm, sizes.numbers[part], sizes.half[:, part], sizes.shown[part], variants),
                (
                    *alternatives(identified, number, identified.system.offers(others).evidence, beside, rules),
                    *instead_of_losses(identified, number, rules),
                ),
                needed_.without[number],
                evidence,
                identified.chance.p_value(
                    identified.system, plain, evidence, identified.system.beside_joints_of(member.group)
                ),
            )
        )
    least = _NOTHING * identified.noise.sigma
    return tuple(
        replace(made[place], small=place in needed_.small)
        for place in needed_.order
        if np.greater(made[place].rms_explained, least).any()  # at its bound the file holds none of it
    )


def finding_of(effect: Effect, ripple: Ripple, held: Array) -> MotionFinding:
    """The finding of an order that stands out beyond the low-pass; `held` (n,) is what held-out motion leaves without
    it, as with it."""
    at = (ripple.joint + 1,)
    parameters = [
        FittedParameter(
            f"{size.name}_{at[0]}", size.name, at, size.kind, value, (value - ripple.half, value + ripple.half)
        )
        for size, value in zip(effect.torque_sizes, (ripple.sine, ripple.cosine), strict=True)
    ]
    shape = effect.torque_shapes[0]
    order = FittedParameter(
        f"{shape.name}_{at[0]}", shape.name, at, shape.kind, ripple.order, (ripple.order, ripple.order)
    )
    size = float(np.hypot(ripple.sine, ripple.cosine))
    explained = np.zeros(len(held))
    explained[ripple.joint] = ripple.rms
    sentence = (
        f"{name_of(effect.title, effect.place, at)}: {size:.3g} N*m, {ripple.order:g} periods in a turn, "
        "on slow motion beyond the low-pass."
    )
    return MotionFinding(
        effect.id,
        at,
        (order, *parameters),
        (),
        tuple(explained.tolist()),
        tuple(held.tolist()),
        ripple.evidence,
        ripple.p_value,
        sentence,
        draws=OF_RIPPLE,
    )


def parameters_of(
    group: Group, arm: Arm, numbers: Array, half: Array, shown: NDArray[np.bool_], variants: Sequence[Group] = ()
) -> tuple[FittedParameter, ...]:
    """A group's parameters that the logs show, with intervals that reach `half` (2, k) below and above; shapes from
    the least to the greatest of its `variants`."""
    slides = bool(group.at) and group.effect.place == "joint" and not arm.joints[group.at[0] - 1].revolute
    suffix = "" if group.tied or not group.at else f"_{group.at[0]}"
    parameters: list[FittedParameter] = []
    for size, value, (below, above), seen in zip(group.sizes, numbers.tolist(), half.T.tolist(), shown, strict=True):
        if seen or group.rank == 1:
            kind = kind_at(size, slides=slides)
            interval = (value - below, value + above)
            parameters.append(FittedParameter(size.name + suffix, size.name, group.at, kind, value, interval))
    if group.effect.recording.last_resort:
        parameters.sort(key=lambda item: -abs(item.value))
    for shape in group.effect.torque_shapes:
        value = group.shapes[shape.name]
        others = [value, *(variant.shapes[shape.name] for variant in variants)]
        interval = (min(others), max(others))
        kind = kind_at(shape, slides=slides)
        parameters.append(FittedParameter(shape.name + suffix, shape.name, group.at, kind, value, interval))
    return tuple(parameters)


def alternatives(
    identified: Identified, number: int, offered: Array, beside: Array, rules: Rules
) -> tuple[Alternative, ...]:
    """Other names for a member (its number) that the logs do not tell from it, the likeliest first.

    `offered` (G,) is the evidence of each group beside the other members, `beside` (G,) beside all of them: what is as
    evident there is something of its own, no other name. What is as likely must be a body's or within its bounds, and
    foretell other motion nearly as well.
    """
    member = identified.members[number]
    taken = {identified.pool.groups[m.group].family for m in identified.members}
    best: dict[tuple[str, tuple[int, ...]], float] = {}
    evidence = float(offered[member.group])
    rest = [m for m in identified.fitted if m is not member]
    least = min(evidence - rules.search.refuted_odds, rules.search.alike**2 * evidence)
    for one in np.flatnonzero((offered >= least) & (offered <= evidence + rules.search.refuted_odds)).tolist():
        family = identified.pool.groups[one].family
        if family in taken or offered[one] - max(float(beside[one]), 0.0) < 0.5 * evidence:
            continue
        worse = _worse(identified, rest, [member], one, evidence, float(offered[one]), rules)
        if np.isfinite(worse):
            best[family] = min(best.get(family, np.inf), worse)
    for family, worse in _for_two(identified, member, number, rules).items():
        best[family] = min(best.get(family, np.inf), worse)
    made = [Alternative((family,), max(worse, 0.0)) for family, worse in best.items()]
    return tuple(sorted(made, key=lambda item: item.worse))


def _for_two(
    identified: Identified, member: Member, number: int, rules: Rules
) -> dict[tuple[str, tuple[int, ...]], float]:
    """One other name for a member and another together, where that is as likely: how much worse, by its family."""
    made: dict[tuple[str, tuple[int, ...]], float] = {}
    families = {identified.pool.groups[m.group].family for m in identified.members}
    apart = identified.system.offers(identified.fitted).evidence
    for second, other in enumerate(identified.members):
        if second == number:
            continue
        rest = [m for k, m in enumerate(identified.fitted) if k not in (number, second)]
        offer = identified.system.offers(rest)
        first = float(offer.evidence[member.group])
        both = first + float(identified.system.offers([*rest, member]).evidence[other.group])
        allowed = np.array([group.family not in families for group in identified.pool.groups])
        allowed &= offer.evidence - np.maximum(apart, 0.0) > 0.5 * both
        value = np.where(allowed, offer.evidence, -np.inf)
        one = int(np.argmax(value))
        worse = both - float(value[one])
        if abs(worse) <= rules.search.log_odds:
            worse = _worse(identified, rest, [member, other], one, both, float(value[one]), rules)
        if abs(worse) <= rules.search.log_odds:  # more may be all that one of the two explains
            family = identified.pool.groups[one].family
            made[family] = min(made.get(family, np.inf), worse)
    return made


def _worse(
    identified: Identified,
    rest: Sequence[Member],
    instead_of: Sequence[Member],
    one: int,
    evidence: float,
    offered: float,
    rules: Rules,
) -> float:
    """How many nats a group's name, `offered` evident beside the rest, is worse in place of members of some `evidence`,
    where it must be some body's as they must; infinitely many where the logs tell it from them.

    Samples of a log share their errors: names that explain the same, and differ on motion that was not fitted by no
    more than that scatters between stretches, are one class. There only nats of motion that was not fitted count.
    """
    scale = float(identified.system.offers(rest).scale[one])
    current, other = [*rest, *instead_of], [*rest, Member(one, scale)]
    if not identified.system.within(other)[-1]:
        return np.inf
    loss = identified.held.loss(other, current, identified.noise.weights)
    alike = offered >= rules.search.alike**2 * evidence and loss <= rules.search.refuted_odds
    if not alike and (identified.held.rms(other) > (1.0 + rules.motion.gain) * identified.held.rms(current)).any():
        return np.inf
    worse = min(evidence - offered, max(loss, 0.0)) if alike else evidence - offered
    worse += feasible(identified.system, other).worse - feasible(identified.system, current).worse
    return worse if worse <= (rules.search.refuted_odds if alike else rules.search.log_odds) else np.inf


def finding_of_group(
    group: Group,
    numbers: Array,
    among: Products,
    parameters: tuple[FittedParameter, ...],
    alike: tuple[Alternative, ...],
    without: Array,
    evidence: float,
    p_value: float,
    recording: str = "",
) -> MotionFinding:
    """A group as a finding by its numbers (k,) on some rows, with a plain sentence of what else it could be; `without`
    (n,) N*m is left where it is missing. `recording` names the logs in which alone it acts."""
    alone = np.zeros(among.width)
    alone[group.columns] = group.values(numbers)
    explained = among.explained(alone)
    most = int(np.argmax(explained))
    name = name_of(group.effect.title, group.effect.place, group.at)
    name = f"In {recording} alone, {name[:1].lower()}{name[1:]}" if recording else name
    size = f"{sized(group.effect.id, parameters)}{less(parameters)}"
    text = f"{name}: {size}. RMS {explained[most]:.3g} N*m at joint {most + 1}."
    text += f" The logs cannot tell it from {or_else(alike)}." if alike else ""
    figures = tuple(explained.tolist()), tuple(without.tolist())
    known = group.effect.id, group.at, parameters, alike, *figures
    return MotionFinding(*known, evidence, p_value, text, recording, draws=0 if recording else DRAWS)


def or_else(others: Sequence[Alternative]) -> str:
    """What else a finding could be, in words, at most three of it."""
    names = [
        " and ".join(name_of(EFFECTS[effect].title, EFFECTS[effect].place, at) for effect, at in other.effects)
        for other in others[:3]
    ]
    return " or ".join(names) + (f" or {len(others) - 3} more" if len(others) > 3 else "")


def less(parameters: Sequence[FittedParameter]) -> str:
    """What is said of a mass that the file has and the arm has not."""
    return (
        ", less than the file has"
        if any(parameter.kind == "mass" and parameter.value < 0.0 for parameter in parameters)
        else ""
    )


def name_of(title: str, place: str, at: Sequence[int]) -> str:
    """An effect and where it acts, in words."""
    if not at or place in ("base", "tip"):
        return title
    kind = "link" if place == "link" else "joint"
    numbers = [str(number) for number in at]
    if len(at) > 2 and list(at) == list(range(at[0], at[0] + len(at))):
        return f"{title} at {kind}s {at[0]} to {at[-1]}"
    listed = numbers[0] if len(numbers) == 1 else f"{', '.join(numbers[:-1])} and {numbers[-1]}"
    return f"{title} at {kind}{'s' if len(at) > 1 else ''} {listed}"


def sized(effect: str, parameters: Sequence[FittedParameter], *, named: bool = True) -> str:
    """Sizes of an effect in words, at most three of them, with or without their names."""
    sizes = [format_quantity(parameter.value, parameter.kind, digits=3) for parameter in parameters[:3]]
    names = [parameter_title(effect, parameter.parameter) if named else "" for parameter in parameters[:3]]
    texts = [f"{name} {size}".strip() for name, size in zip(names, sizes, strict=True)]
    return ", ".join(texts) + (", ..." if len(parameters) > 3 else "")
