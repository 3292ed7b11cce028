"""Rotors, which alone show to encoders on the joint's side that a drive gives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.drives.armature import ARMATURE
from linkwright.core.arm.effects.effect import Effect
from linkwright.core.diagnose.motion.model.candidates import Candidates, candidates
from linkwright.core.diagnose.motion.preparation import PreparedLog
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array


def with_rotors(
    arm: Arm,
    effects: Sequence[Effect],
    pool: Candidates,
    prepared: Sequence[PreparedLog],
    masses: Array,
    sizes: Array,
    *,
    rules: Rules,
) -> tuple[Candidates, list[PreparedLog]]:
    """Candidates and logs where encoders on the joint's side show how drives give by their rotors alone: by those that
    the whole library makes of the logs, with sizes (W,), as far as the arm has none.

    Args:
        arm: The arm.
        effects: Effects that the logs may show.
        pool: The candidates so far.
        prepared: The logs.
        masses: (n, 10) the links' inertial parameters as the arm file has them.
        sizes: (W,) of the candidates' columns.
        rules: What is usual.
    """
    rotors = np.zeros(arm.size)
    for source in pool.sources:
        if source.effect is ARMATURE:
            rotors[source.at[0]] = max(float(sizes[source.start]), 0.0)
    logs = [replace(each, motion=replace(each.motion, rotors=rotors)) for each in prepared]
    beyond = next(each.motion for each in logs if each.motion.beyond_drive)
    return candidates(arm, effects, beyond, masses, pool.clock, rules=rules), logs
