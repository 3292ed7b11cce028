"""Dynamic parameters of an arm's effects as attributes of URDF and MJCF: joints' friction, damping, armature and
springs, and links' masses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS, Settings
from linkwright.core.arm.effects.drives.armature import ARMATURE
from linkwright.core.arm.effects.drives.back_emf import BACK_EMF
from linkwright.core.arm.effects.drives.spring import SPRING
from linkwright.core.arm.effects.friction.friction_coulomb import FRICTION_COULOMB
from linkwright.core.arm.effects.friction.friction_viscous import FRICTION_VISCOUS
from linkwright.core.arm.effects.loads.inertial import OfInertia
from linkwright.core.arm.motion.rigid import body_near, parameters_of, tensor_of
from linkwright.core.sections.numeric import Array

Format = Literal["urdf", "mjcf"]


@dataclass(frozen=True)
class _Word:
    """An attribute of a joint in a format, and the parameter of the effect that it holds."""

    effect: str
    parameter: str
    attribute: str


_WORDS: Mapping[Format, tuple[_Word, ...]] = MappingProxyType(
    {
        "urdf": (
            _Word(FRICTION_COULOMB.id, "torque", "friction"),
            _Word(FRICTION_VISCOUS.id, "coefficient", "damping"),
            _Word(BACK_EMF.id, "coefficient", "damping"),
        ),
        "mjcf": (
            _Word(FRICTION_COULOMB.id, "torque", "frictionloss"),
            _Word(FRICTION_VISCOUS.id, "coefficient", "damping"),
            _Word(BACK_EMF.id, "coefficient", "damping"),
            _Word(ARMATURE.id, "inertia", "armature"),
            _Word(SPRING.id, "stiffness", "stiffness"),
            _Word(SPRING.id, "rest", "springref"),
        ),
    }
)
"""A URDF's `<dynamics>` and an MJCF's `<joint>`: N*m, N*m*s/rad, kg*m^2, N*m/rad and rad; of slides with m for rad."""


def of_joint(arm: Arm, form: Format, index: int) -> dict[str, float]:
    """The attributes of a joint (from 0) by name, in SI: what the arm's effects sum up to; none where they say nothing
    of it."""
    values: dict[str, float] = {}
    for word in _WORDS[form]:
        for entry in arm.effects:
            here = not entry.at or index + 1 in entry.at
            if entry.effect == word.effect and word.parameter in entry.parameters and here:
                values[word.attribute] = values.get(word.attribute, 0.0) + entry.parameters[word.parameter]
    return values


def effects_in_motion(form: Format) -> frozenset[str]:
    """The effects, by id, that a format holds in its joints or its links' weights."""
    weigh = (effect.id for effect in EFFECTS.values() if isinstance(effect.torques, OfInertia))
    return frozenset((*(word.effect for word in _WORDS[form]), *weigh))


def added_parameters(arm: Arm) -> Array:
    """The inertial parameters (n, 10) by which an arm's effects say that its links, and what hangs at the tip, are
    heavier than its file; each in its link's frame."""
    added = np.zeros((arm.size, 10))
    for entry in arm.effects:
        torques = EFFECTS[entry.effect].torques
        if isinstance(torques, OfInertia):
            added += torques.parameters(arm, Settings.of(entry))
    return added


def heavier(mass: Mass | None, added: Array) -> Mass | None:
    """A mass with inertial parameters (10,) added to it, all in one frame; None where no body has what comes of it."""
    whole = body_near(added + (0.0 if mass is None else parameters_of(mass)))
    if whole is None:
        return None
    center = whole[1:4] / whole[0]
    about = whole[0] * (center @ center * np.eye(3) - np.outer(center, center))
    return Mass(float(whole[0]), center, tensor_of(whole) - about)
