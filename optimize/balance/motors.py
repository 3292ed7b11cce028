"""Where each joint's motor stands: at its joint, on a link or on the base, with what the transmission to it brings."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from linkwright.core.arm.chain.balance import PointMass
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import error_model
from linkwright.core.arm.worst.coverage import unreached
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.optimize.balance.motor_places import with_parallelogram
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.problem import Problem

from .motor_places import MotorPlace


def with_places(arm: Arm, places: tuple[tuple[int, MotorPlace], ...]) -> Arm:
    """The arm with the motors of some joints (from 0) at these places; what the arm has of those motors goes."""
    moved = {joint + 1 for joint, _ in places}
    joints = list(arm.joints)
    links = [
        replace(link, masses=tuple(mass for mass in link.masses if mass.motor_of not in moved)) for link in arm.links
    ]
    for number, place in places:
        joint = joints[number]
        at_joint = place.mass if place.on is None else 0.0
        joint = replace(joint, mass=joint.mass + at_joint, motor_on_base=place.mass if place.on == 0 else 0.0)
        if place.stiffness is not None:
            joint = replace(joint, stiffness=place.stiffness, zones=())
        if place.backlash is not None:
            joint = replace(joint, backlash=place.backlash)
        if place.cost is not None:
            joint = replace(joint, cost=place.cost + (joint.cost or 0.0))
        joints[number] = joint
        if place.on:
            link = links[place.on - 1]
            links[place.on - 1] = replace(link, masses=(*link.masses, PointMass(place.mass, motor_of=number + 1)))
    arm = replace(arm, joints=tuple(joints), links=tuple(links))
    for number, place in places:
        if place.rods is not None:
            arm = with_parallelogram(arm, number, place.rods)
    return arm


def reaches_less(problem: Problem, given: Problem) -> bool:
    """Whether an arm of other coordinates leaves more of a box or path unreached than the arm as given does; with
    lengths to choose, and for joint ranges, nothing is left out for that."""
    if not problem.workspace.in_space or problem.free_lengths:
        return False
    shares: list[float] = []
    for item in (problem, given):
        search = WorstSearch(error_model(item.arm, item.load_cases), item.workspace)
        motion = partial(search.motion, p=numeric_beams(item.arm, item.load_cases))
        missed = unreached(item.workspace, motion, search.lower, search.upper)
        shares.append(0.0 if missed is None else missed.share)
    return shares[0] > shares[1]
