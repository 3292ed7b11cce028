"""A number of a counterweight or a counterbalance that the optimiser chooses, and arms with such numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

from linkwright.core.arm.chain.chain import Arm, Joint, Link

Field = Literal["balancer", "counterweight", "counterweight_at"]
"""In which of a beam's fields a model finds the number (see `arm.chain.beam.Beam`)."""
FIELDS: tuple[Field, ...] = ("balancer", "counterweight", "counterweight_at")
_NOTHING = 1e-9


@dataclass(frozen=True)
class Balance:
    """A number to choose (SI) between `lower` and `upper`, of the joint or link `place` (from 0); `given` is what the
    arm has, or the nearest that is allowed. `kind` is the kind of quantity, `words` say what it is."""

    place: int
    field: Field
    lower: float
    upper: float
    given: float
    kind: str
    words: str


def balance_values(arm: Arm, balances: Sequence[Balance]) -> list[float]:
    """The numbers (SI) that an arm has."""
    return [_value(arm, each) for each in balances]


def _value(arm: Arm, balance: Balance) -> float:
    if balance.field == "balancer":
        joint = arm.joints[balance.place]
        return 0.0 if joint.counterbalance is None else float(getattr(joint.counterbalance, joint.balancer_chosen))
    for each in arm.links[balance.place].masses:
        if each.chosen:
            return each.mass if balance.field == "counterweight" else each.at[0]
    return 0.0


def balanced(arm: Arm, values: Mapping[tuple[int, str], Any]) -> Arm:
    """The arm with these numbers (SI) at these places and fields; what is not named stays."""
    joints = [_joint(joint, values.get((index, "balancer"))) for index, joint in enumerate(arm.joints)]
    links = [
        _link(link, values.get((index, "counterweight")), values.get((index, "counterweight_at")))
        for index, link in enumerate(arm.links)
    ]
    return replace(arm, joints=tuple(joints), links=tuple(links))


def _joint(joint: Joint, value: float | None) -> Joint:
    if value is None or joint.counterbalance is None:
        return joint
    chosen: dict[str, Any] = {joint.balancer_chosen: float(value)}
    return replace(joint, counterbalance=replace(joint.counterbalance, **chosen))


def _link(link: Link, mass: float | None, at: float | None) -> Link:
    masses = tuple(
        replace(
            each,
            mass=each.mass if mass is None else float(mass),
            at=each.at if at is None else (float(at), *each.at[1:]),
        )
        if each.chosen
        else each
        for each in link.masses
    )
    return link if masses == link.masses else replace(link, masses=masses)


def with_counterweights(arm: Arm, balances: Sequence[Balance], *, least: bool) -> Arm:
    """The arm with the counterweights that are chosen as light and as near to their joints as they may be, or as heavy
    as they may be."""
    values: dict[tuple[int, str], float] = {}
    for each in balances:
        if each.field == "counterweight":
            values[each.place, each.field] = each.lower if least else each.upper
        elif each.field == "counterweight_at" and least:
            values[each.place, each.field] = max(each.lower, min(each.upper, 0.0))
    return balanced(arm, values) if values else arm


def settled(arm: Arm) -> Arm:
    """An arm with nothing left to choose: what came to nothing is left out."""
    if not any(joint.balancer_chosen for joint in arm.joints) and not any(
        each.chosen for link in arm.links for each in link.masses
    ):
        return arm
    joints = [
        replace(
            joint,
            counterbalance=None if _idle(joint) else joint.counterbalance,
            balancer_chosen="",
        )
        if joint.balancer_chosen
        else joint
        for joint in arm.joints
    ]
    links = [
        replace(
            link,
            masses=tuple(
                replace(each, chosen=False) for each in link.masses if not (each.chosen and each.mass < _NOTHING)
            ),
        )
        for link in arm.links
    ]
    return replace(arm, joints=tuple(joints), links=tuple(links))


def _idle(joint: Joint) -> bool:
    """Whether a joint's counterbalance came to nothing."""
    found = joint.counterbalance
    figures = () if found is None else (getattr(found, name, 0.0) for name in ("torque", "stiffness", "preload"))
    return all(abs(float(figure)) < _NOTHING for figure in figures)
