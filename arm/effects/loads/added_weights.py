"""The weights that an arm's effects add to its file, and what joints bear with them.

What gives in proportion answers to added weights by itself: their effects move the tip through it. Friction's share
of a load and play that a load seats have one answer to the whole load.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.chain.statics import JointState, PoseState
from linkwright.core.arm.chain.vectors import add, minus, plus, scale, times
from linkwright.core.arm.effects.effect import Settings

from .link_mass import LINK_MASS, link_masses_alone
from .payload import PAYLOAD, payload_alone

_ALONE: Mapping[str, Callable[[PoseState, Settings], PoseState | None]] = MappingProxyType(
    {PAYLOAD.id: payload_alone, LINK_MASS.id: link_masses_alone}
)


def weights_added(effects: Iterable[EffectEntry]) -> tuple[EffectEntry, ...]:
    """Those of an arm's effects that are masses beyond the file's."""
    return tuple(entry for entry in effects if entry.effect in _ALONE)


def under_weight_alone(state: PoseState, entry: EffectEntry) -> PoseState | None:
    """The same pose under the weight of one such entry alone; None where it weighs nothing."""
    return _ALONE[entry.effect](state, Settings.of(entry))


def bearing(state: PoseState) -> PoseState:
    """The same pose with what joints bear of the weights that the arm's effects add too: `drive_load`, `force` and
    `moment` of each, but for those that are the whole already."""
    joints = state.joints
    for entry in weights_added(state.arm.effects):
        alone = under_weight_alone(state, entry)
        if alone is not None:
            joints = tuple(_more(joint, other) for joint, other in zip(joints, alone.joints, strict=True))
    return state if joints is state.joints else replace(state, joints=joints)


def borne_wholly(state: PoseState) -> PoseState:
    """`bearing`, the loads said to be the whole."""
    return replace(state, joints=tuple(replace(joint, whole_load=1.0) for joint in bearing(state).joints))


def _more(joint: JointState, other: JointState) -> JointState:
    share = minus(1.0, joint.whole_load)
    return replace(
        joint,
        drive_load=plus(joint.drive_load, times(share, other.drive_load)),
        force=add(joint.force, scale(share, other.force)),
        moment=add(joint.moment, scale(share, other.moment)),
    )
