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
    return [_value(arm, balance) for balance in balances]


def _value(arm: Arm, balance: Balance) -> float:
    if balance.field == "balancer":
        joint = arm.joints[balance.place]
        return 0.0 if joint.counterbalance is None else float(getattr(joint.counterbalance, joint.balancer_chosen))
    for mass in arm.links[balance.place].masses:
        if mass.chosen:
            return mass.mass if balance.field == "counterweight" else mass.at[0]
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
            item,
            mass=item.mass if mass is None else float(mass),
            at=item.at if at is None else (float(at), *item.at[1:]),
        )
        if item.chosen
        else item
        for item in link.masses
    )
    return link if masses == link.masses else replace(link, masses=masses)


def with_least_counterweights(arm: Arm, balances: Sequence[Balance]) -> Arm:
    """The arm with the counterweights that are chosen as light and as near to their joints as they may be."""
    values: dict[tuple[int, str], float] = {}
    for balance in balances:
        if balance.field == "counterweight":
            values[balance.place, balance.field] = balance.lower
        elif balance.field == "counterweight_at":
            values[balance.place, balance.field] = max(balance.lower, min(balance.upper, 0.0))
    return balanced(arm, values) if values else arm


def settled(arm: Arm) -> Arm:
    """An arm with nothing left to choose: what came to nothing is left out."""
    if not any(joint.balancer_chosen for joint in arm.joints) and not any(
        mass.chosen for link in arm.links for mass in link.masses
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
                replace(mass, chosen=False) for mass in link.masses if not (mass.chosen and mass.mass < _NOTHING)
            ),
        )
        for link in arm.links
    ]
    return replace(arm, joints=tuple(joints), links=tuple(links))


def _idle(joint: Joint) -> bool:
    """Whether a joint's counterbalance came to nothing."""
    counterbalance = joint.counterbalance
    figures = (
        ()
        if counterbalance is None
        else (getattr(counterbalance, name, 0.0) for name in ("torque", "stiffness", "preload"))
    )
    return all(abs(float(figure)) < _NOTHING for figure in figures)
