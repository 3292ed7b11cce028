"""Several arms on one torso as what they are to each of their tips: a serial arm."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .chain import Arm, Branch


@dataclass(frozen=True)
class Way:
    """The way from the base to one tip: `arm` is the serial arm that it makes, `joints` are its joints' numbers (from
    0) in the whole arm, the first `shared` of them those of the torso."""

    arm: Arm
    joints: tuple[int, ...]
    shared: int


def ways(arm: Arm) -> tuple[Way, ...]:
    """The ways to an arm's tips, each without the weights of the other branches and without `effects`; of an arm
    without branches the arm itself."""
    if not arm.branches:
        return (Way(arm, tuple(range(arm.size)), arm.size),)
    shared = arm.branches[0].first
    return tuple(
        Way(_serial(arm, branch), (*range(shared), *range(branch.first, branch.end)), shared) for branch in arm.branches
    )


def way_to(arm: Arm, tip: str) -> Way:
    """The way to one tip, by its name; of an arm without branches the arm itself."""
    names = [branch.name for branch in arm.branches]
    return ways(arm)[names.index(tip) if names else 0]


def alone(arm: Arm, branch: Branch) -> Arm:
    """A branch as a separate arm, on a torso that stands still."""
    return _of(arm, tuple(range(branch.first, branch.end)), branch)


def _serial(arm: Arm, branch: Branch) -> Arm:
    return _of(arm, (*range(arm.branches[0].first), *range(branch.first, branch.end)), branch)


def _of(arm: Arm, numbers: tuple[int, ...], branch: Branch) -> Arm:
    """The arm that these joints make, in their order; what they follow is among them."""
    places = {number: place for place, number in enumerate(numbers)}
    joints = tuple(
        joint if joint.follows is None else replace(joint, follows=joint.follows.moved(places))
        for joint in (arm.joints[number] for number in numbers)
    )
    links = tuple(arm.links[number] for number in numbers)
    serial = replace(arm, joints=joints, links=links, effects=(), branches=(), every_tip=False)
    return replace(serial, tool=branch.tool, payload=branch.payload)
