"""Losses by the direction of power, and what they may as well be: friction under load beside masses or constants."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from linkwright.core.arm.effects.drives.torque_constant import TORQUE_CONSTANT
from linkwright.core.arm.effects.friction.friction_load import FRICTION_LOAD
from linkwright.core.arm.effects.friction.gear_efficiency import GEAR_EFFICIENCY
from linkwright.core.arm.effects.loads.link_inertial import LINK_INERTIAL
from linkwright.core.diagnose.motion.model.evidence import Member
from linkwright.core.diagnose.motion.model.groups import Group
from linkwright.core.diagnose.motion.model.identify import Identified
from linkwright.core.diagnose.motion.result import Alternative
from linkwright.core.diagnose.rules.rules import Rules


def instead_of_losses(identified: Identified, number: int, rules: Rules) -> tuple[Alternative, ...]:
    """Sets that stand as well for all losses by the direction of power, where a member (its number) is one of them.

    A load tau with losses f forwards and b backwards is (f + b)/2 |tau| of friction beside (f - b)/2 tau, which masses
    that are as much heavier take, or constants that are as much larger.
    """
    groups = identified.pool.groups
    losses = [m for m in identified.members if groups[m.group].effect is GEAR_EFFICIENCY]
    if identified.members[number] not in losses:
        return ()
    rest = [m for m in identified.fitted if m not in losses]
    system, made = identified.system, list[Alternative]()
    evidence = system.evidence([*rest, *losses])
    for chosen in _in_place(groups, [groups[m.group].at for m in losses], {groups[m.group].family for m in rest}):
        other = list(rest)
        for k in chosen:
            other.append(Member(k, float(system.offers(other).scale[k])))
        worse = evidence - system.evidence(other)
        if worse <= rules.search.refuted_odds and system.within(other).all():
            made.append(Alternative(tuple(groups[k].family for k in chosen), max(worse, 0.0)))
    return tuple(made)


def _in_place(
    groups: Sequence[Group], places: Sequence[tuple[int, ...]], taken: Collection[tuple[str, tuple[int, ...]]]
) -> Iterator[list[int]]:
    """Groups, by number, that may stand for losses at all places (from 1), none of a family that is taken."""
    rubs = [_number(groups, FRICTION_LOAD.id, at) for at in places]
    masses = [k for k, g in enumerate(groups) if g.effect is LINK_INERTIAL and g.tied]
    constants = [_number(groups, TORQUE_CONSTANT.id, at) for at in places]
    for more in (masses[:1], constants):
        chosen = [k for k in (*rubs, *more) if k is not None]
        complete = bool(more) and len(chosen) == len(rubs) + len(more)
        if complete and not any(groups[k].family in taken for k in chosen):
            yield chosen


def _number(groups: Sequence[Group], effect: str, at: tuple[int, ...]) -> int | None:
    """The number of the group of an effect at a place (from 1) alone; None where there is none."""
    same = (k for k, g in enumerate(groups) if g.effect.id == effect and g.at == at and not (g.tied or g.nuisance))
    return next(same, None)
