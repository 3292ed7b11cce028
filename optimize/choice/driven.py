"""A joint with another actuator, and what of the joint stays as it is."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

from linkwright.core.arm.actuators import Actuator
from linkwright.core.arm.chain.chain import Joint

_OF_STIFFNESS = frozenset({"stiffness", "zones"})


def with_actuator(joint: Joint, actuator: Actuator) -> Joint:
    """The joint with an actuator, as if the arm file named that one: figures that stand beside the name stay."""
    kept = kept_figures(joint)
    figures = {name: value for name, value in _figures(actuator).items() if name not in kept}
    return replace(joint, actuator=actuator, **figures)


def kept_figures(joint: Joint) -> frozenset[str]:
    """Which figures of a joint stay whichever actuator is chosen: what stands beside the name of its actuator in the
    arm file. The drive of a joint that names none gives way with all its figures, but the bearing is the joint's."""
    drive = joint.actuator
    if drive is None:
        return frozenset({"tilting_stiffness"} if joint.tilting_stiffness is not None else ())
    lacking = drive.lacks("stiffness", "backlash", "mass")  # an arm file has to give them
    kept = {*lacking, *(name for name, value in _figures(drive).items() if getattr(joint, name) != value)}
    if not kept.isdisjoint(_OF_STIFFNESS):
        kept |= _OF_STIFFNESS
    return frozenset(kept)


def _figures(actuator: Actuator) -> dict[str, Any]:
    """What a joint has of its actuator's catalogue, by the names of its fields."""
    return {
        "stiffness": actuator.stiffness,
        "zones": actuator.zones,
        "backlash": actuator.backlash or 0.0,
        "mass": actuator.mass or 0.0,
        "tilting_stiffness": actuator.tilting_stiffness,
        "cost": None,
        "cost_date": "",
        "rated_torque": None,
        "peak_torque": None,
    }


def stays_beside(joints: Sequence[Joint], chosen: Collection[int]) -> str | None:
    """What of the arm file's joints stays at those (from 0) whose actuators are chosen, as a sentence; None: nothing,
    for it all is the catalogue's."""
    kept = {number: sorted(kept_figures(joints[number]) - {"zones", "cost_date"}) for number in sorted(chosen)}
    by_joint = [
        f"{', '.join(names).replace('_', ' ')} of joint {number + 1}" for number, names in kept.items() if names
    ]
    if not by_joint:
        return None
    return (
        f"whichever actuator is chosen, the arm file's {'; '.join(by_joint)} count; leave them out for the catalogue's"
    )
