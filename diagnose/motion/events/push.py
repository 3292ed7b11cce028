"""A push on a link: what a body that an arm touches takes of its drives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import turns_by_drives
from linkwright.core.arm.effects.effect import Effect, Settings, torque
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.moving import MovingArm, cross, dot, moving
from linkwright.core.diagnose.motion.model.candidates import Candidates
from linkwright.core.diagnose.motion.model.groups import Group, Source
from linkwright.core.sections.numeric import Array

_FORCE = 280.0
"""N, that is common: ISO/TS 15066:2016, annex A, allows 65 to 280 N where people are touched, at once twice that."""


def _torques(motion: Motion, settings: Settings) -> Mapping[int, Array]:
    """The torques by joint: no joint beyond the pushed link is loaded."""
    (link,) = settings.at
    here = motion.once("standing", lambda: _standing(motion))
    start = here.links[link].origin
    end = start + here.tip if link == motion.arm.size - 1 else here.links[link + 1].origin
    about = np.zeros((motion.arm.size, motion.size))
    for place, name in ((end, "end"), (start, "start")):
        force = np.array([settings.values.get(f"{name}_{axis}", 0.0) for axis in "xyz"])[:, None]
        for index, joint in enumerate(here.links[: link + 1]):
            pulls = cross(place - joint.origin, force) if motion.arm.joints[index].revolute else force
            about[index] -= dot(joint.axis, pulls)
    whole = about.T @ turns_by_drives(motion.arm)
    return {index: whole[:, index] for index in range(motion.arm.size) if whole[:, index].any()}


def _standing(motion: Motion) -> MovingArm:
    """Where the links stand; nothing of how they move counts."""
    still = np.zeros_like(motion.q)
    return moving(motion.arm, motion.q, still, still)


PUSH = Effect(
    id="push",
    title="a push",
    formula="tau = -J^T f of the link that is pushed, by a steady force at a place from its start to its end",
    place="link",
    cause="loads",
    needs="",
    aliases=("payload",),
    source="S. Haddadin, A. De Luca & A. Albu-Schaeffer, Robot collisions: a survey on detection, isolation, and "
    "identification, IEEE Trans. Robotics 33 (2017) 1292-1312, doi:10.1109/TRO.2017.2723903",
    parameters=(
        *(torque(f"end_{axis}", "force", -1e5, 1e5, (1.0, _FORCE)) for axis in "xyz"),
        *(torque(f"start_{axis}", "force", -1e5, 1e5, (1.0, _FORCE)) for axis in "xyz"),
    ),
    torques=_torques,
    linear=True,
)
"""It acts for a while, and is no cause that a file holds: a force on the arm in the base frame, the part of it at the
link's end and that at its start, which together are one at any place between."""


def with_pushes(pool: Candidates, arm: Arm) -> tuple[Candidates, list[Group]]:
    """The candidates with columns of a push on each link, and the groups that may be taken of them: at its end, or
    anywhere on it."""
    sources, groups, width = list(pool.sources), list[Group](), pool.width
    sizes = PUSH.torque_sizes
    usual = np.array([size.typical[1] for size in sizes])
    for link in range(arm.size):
        source = Source(PUSH, (link,), {}, sizes, width, False, tuple(range(link + 1)), usual)
        sources.append(source)
        width += len(sizes)
        for count in (3, 6):
            free, at = np.full((2, count), np.inf) * [[-1.0], [1.0]], (link + 1,)
            labels = tuple((at, size.name) for size in sizes[:count])
            chosen = source.columns[:count], np.eye(count), usual[:count], free, sizes[:count], labels
            groups.append(Group(PUSH, at, {}, *chosen, (PUSH.id, at), 2))
    return replace(pool, sources=tuple(sources), width=width), groups
