"""Where each joint's motor stands: at its joint, on a link or on the base, with what the transmission to it brings.

Masses, stiffness and backlash are constants of an error model, so every combination of places is a problem of its own;
one that cannot beat the best so far is given up.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from linkwright.core.arm.chain.balance import PointMass
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.model import error_model
from linkwright.core.arm.worst.coverage import unreached
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.executors import Executor
from linkwright.core.optimize.choice.actuators import Driven, choose_driven
from linkwright.core.optimize.choice.combinations import Progress
from linkwright.core.optimize.exchange.design import numeric_beams
from linkwright.core.optimize.journal import Journal
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import Iteration, PlaceCandidate
from linkwright.core.units.quantities import InputError

from .motor_places import MotorPlace
from .parallelogram import with_parallelogram


def with_places(arm: Arm, places: tuple[tuple[int, MotorPlace], ...]) -> Arm:
    """The arm with the motors of some joints (from 0) at these places; what the arm has of those motors goes."""
    moved = {joint + 1 for joint, _ in places}
    joints = list(arm.joints)
    links = [
        replace(link, masses=tuple(each for each in link.masses if each.motor_of not in moved)) for link in arm.links
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


@dataclass(frozen=True)
class Placed:
    """The best places of motors: the drives and links chosen for them, and what became of each combination of
    places, best first."""

    driven: Driven
    candidates: tuple[PlaceCandidate, ...]


def choose_placed(
    problem: Problem,
    *,
    progress: Progress | None = None,
    log: Callable[[Iteration], None] | None = None,
    executor: Executor | None = None,
    journal: Journal | None = None,
) -> Placed:
    """The best places of motors with the best drives and links for them; arguments as for `choose_driven`."""
    settings: Any = {"progress": progress, "log": log, "executor": executor, "journal": journal}
    if not problem.motors:
        return Placed(choose_driven(problem, **settings), ())
    best: Driven | None = None
    first: Driven | None = None
    found: list[tuple[float, PlaceCandidate]] = []
    picks = list(itertools.product(*(choice.places for choice in problem.motors)))
    for done, pick in enumerate(picks):
        words = tuple(place.words for place in pick)
        if progress is not None:
            progress(done, len(picks), f"motors {', '.join(words)}")
        known = math.inf if best is None or best.choice is None else best.choice.objective
        places = tuple((choice.joint, place) for choice, place in zip(problem.motors, pick, strict=True))
        own = replace(problem, arm=with_places(problem.arm, places), motors=())
        if any(place.rods is not None for place in pick) and reaches_less(own, problem):
            found.append((math.inf, PlaceCandidate(words, None, "reaches less")))
            continue
        driven = choose_driven(own, **settings, known=known, ties=False)
        first = first or driven
        if driven.choice is None:
            outcome = "infeasible" if math.isinf(known) else "bounded out"
            found.append((math.inf, PlaceCandidate(words, None, outcome)))
            continue
        value = driven.choice.objective
        found.append((value, PlaceCandidate(words, value, "solved")))
        if value < known:
            best = driven
        if driven.choice.interrupted:
            break
    found.sort(key=lambda each: each[0])
    candidates = [each for _, each in found]
    if best is not None:
        candidates[0] = replace(candidates[0], outcome="best")
    if first is None:
        message = "leaves more of the workspace unreached with rods at any of these places than the arm as given does"
        raise InputError(problem.file, "choose.motor", f"{message}; give the joint a wider range")
    chosen = best or first
    return Placed(chosen, tuple(candidates))


def reaches_less(problem: Problem, given: Problem) -> bool:
    """Whether an arm of other coordinates leaves more of a box or path unreached than the arm as given does; with
    lengths to choose, and for joint ranges, nothing is left out for that."""
    if problem.workspace.kind == "joints" or problem.link_length is not None:
        return False
    shares: list[float] = []
    for each in (problem, given):
        search = WorstSearch(error_model(each.arm, each.load_cases), each.workspace)
        tip = partial(search.tip, p=numeric_beams(each.arm, each.load_cases))
        missed = unreached(each.workspace, tip, search.lower, search.upper)
        shares.append(0.0 if missed is None else missed.share)
    return shares[0] > shares[1]
