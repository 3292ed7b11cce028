"""Ten inertial parameters by name, as effects hold them: of a link, or of what hangs at the tip."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects.effect import Parameter, Settings, torque
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import (
    PARAMETERS,
    in_frame,
    parameters_of,
    rigid_torque,
    tip_of_last_link,
    without_tip_load,
)
from linkwright.core.sections.numeric import Array


def inertial_sizes(of: str, about: str, *, mass: bool = True) -> tuple[Parameter, ...]:
    """The sizes that say what more something weighs: its `mass` where that is no size already, and its moments."""
    moments = [
        torque(name, "first_moment", -1e3, 1e3, (-0.5, 0.5)).means(
            f"{of}: mass times how far the centre lies along {name[-1]} from {about}", "a few kg, some hundred mm away"
        )
        for name in PARAMETERS[1:4]
    ]
    tensor = [
        torque(name, "inertia", -1e3, 1e3, (-0.05, 0.1)).means(
            f"{of}: {'moment' if name[-1] == name[-2] else 'entry'} {name[-2:]} of the inertia about {about}",
            "a few kg, one to three hundred mm across",
        )
        for name in PARAMETERS[4:]
    ]
    whole = torque("mass", "mass", -100.0, 1000.0, (0.1, 5.0)).means(of, "cables, covers, castings: 0.1 to 5 kg")
    return (*([whole] if mass else []), *moments, *tensor)


def by_name(values: Mapping[str, float]) -> Array:
    """Ten inertial parameters (10,) of values by their names; what is not there is nothing."""
    return np.array([values.get(name, 0.0) for name in PARAMETERS])


def at_tip(arm: Arm, values: Mapping[str, float]) -> Array:
    """The parameters (10,), in the last link's frame, of what hangs at the tip: values by name about the tip, along the
    axes there, `centre_x` and so on how far a mass's centre stands from it (m)."""
    about_tip = by_name(values)
    centre = np.array([values.get(f"centre_{axis}", 0.0) for axis in "xyz"])
    about_tip[1:] += parameters_of(Mass(about_tip[0], centre, np.zeros((3, 3))))[1:]
    return in_frame(about_tip, np.array(arm.links[-1].end_rotation, dtype=float), tip_of_last_link(arm))


def torque_of_more(motion: Motion, parameters: Array) -> Mapping[int, Array]:
    """What links of these parameters (n, 10) take of the drives beside the arm's own."""
    if not parameters.any():
        return MappingProxyType({})
    arm, moves = without_tip_load(motion.arm), motion.of_links
    result = rigid_torque(arm, parameters, moves.q, moves.velocity, moves.acceleration)
    last = int(np.flatnonzero(parameters.any(axis=1))[-1])
    return {index: result[:, index] for index in range(last + 1)}


def of_links(arm: Arm, settings: Settings) -> Array:
    """The parameters (n, 10) of an effect that says them of links."""
    here = np.array([settings.acts_at(index) for index in range(arm.size)], dtype=float)
    return here[:, None] * by_name(settings.values)


def of_tip(arm: Arm, settings: Settings) -> Array:
    """The parameters (n, 10) of an effect that says them of what hangs at the tip."""
    parameters = np.zeros((arm.size, 10))
    parameters[-1] = at_tip(arm, settings.values)
    return parameters


@dataclass(frozen=True)
class OfInertia:
    """The torques of an effect whose settings say inertial `parameters` (n, 10) of an arm's links."""

    parameters: Callable[[Arm, Settings], Array]

    def __call__(self, motion: Motion, settings: Settings) -> Mapping[int, Array]:
        """The torques by joint."""
        return torque_of_more(motion, self.parameters(motion.arm, settings))
