"""When a name that is given is that of a true cause, and when it is one that a log cannot tell from it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

Truth = Mapping[str, Any]
Place = tuple[str, frozenset[int]]

OF_THE_ARM = frozenset({"payload", "base_tilt"})
"""Effects whose place is free."""
BODIES = frozenset({"payload", "link_inertial", "base_tilt"})
"""What acts at several joints, wherever it is said to be."""
ALIKE: tuple[frozenset[str], ...] = (
    frozenset({"friction_coulomb", "friction_asymmetry", "torque_offset", "friction_warmup"}),
    frozenset({"friction_stribeck", "friction_reversal", "friction_coulomb", "friction_viscous", "friction_quadratic"}),
    frozenset({"friction_load", "friction_place", "friction_coulomb", "gear_efficiency"}),
    frozenset({"torque_offset", "spring", "base_tilt", "link_inertial", "payload", "encoder_offset"}),
    frozenset({"torque_delay", "joint_compliance", "armature", "friction_viscous"}),
    frozenset({"torque_constant", "link_inertial", "payload", "armature", "friction_load", "gear_efficiency"}),
    frozenset({"joint_coupling", "friction_viscous"}),
)
"""Effects that take much the same of a drive on many motions, at one joint or where one of the two is of bodies."""


def members(entry: Mapping[str, Any]) -> list[Place]:
    """An entry's class: its name and its alternatives, each an effect and place or several of them."""
    results = [_place(entry["effect"], entry.get("at"))]
    for alternative in entry.get("alternatives") or []:
        several = [alternative] if isinstance(alternative[0], str) else alternative
        results += [_place(effect, at) for effect, at in several]
    return results


def _place(effect: str, at: Iterable[int] | None) -> Place:
    return effect, frozenset(int(i) for i in at or ())


def is_it(one: Place, true: Mapping[str, Any], truth: Truth) -> bool:
    """Whether a name and place are a true cause's; a weight at the flange is one of the last link."""
    (effect, at), (own, place) = one, _place(true["effect"], true["at"])
    if {effect, own} == {"payload", "link_inertial"}:
        return at | place == {truth["joints"]}
    if effect != own:
        return False
    if own in OF_THE_ARM or at == place:
        return True
    return len(place) > 1 and (not at or bool(at & place))


def in_class(entry: Mapping[str, Any], true: Mapping[str, Any], truth: Truth) -> bool:
    """Whether a true cause is named or among the alternatives."""
    return any(is_it(member, true, truth) for member in members(entry))


def is_alike(entry: Mapping[str, Any], truth: Truth) -> bool:
    """Whether a name, or an alternative, is what a true cause is hardly told from."""
    return any(
        _alike(member, _place(true["effect"], true["at"])) for member in members(entry) for true in truth["effects"]
    )


def _alike(one: Place, two: Place) -> bool:
    if not any(one[0] in group and two[0] in group for group in ALIKE):
        return False
    return bool({one[0], two[0]} & BODIES) or bool(one[1] & two[1]) or not one[1] or not two[1]
