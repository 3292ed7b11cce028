"""Motion logs made by a model, for trying things out."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwright.core.arm.avoid.poses import NoRoom
from linkwright.core.diagnose.motion.reading.read import read_log as read_file
from linkwright.core.diagnose.motion.simulate import simulate_motion
from linkwright.core.diagnose.motion.uses.trajectory import read_motion
from linkwright.core.diagnose.motion.written import log_text, settings_text
from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.motion.log import unlike_arrays
from linkwright.face.plain_input import File, Quantity, in_si
from linkwright.face.recording import saved, torque_noise
from linkwright.json.fields import fields
from linkwright.json.motion import OBSERVES
from linkwright.output.files import json_text
from linkwright.results.document import Description
from linkwright.results.figures_in_words import with_unit
from linkwright.results.motion.words import of_all_joints, torque

from .log import Log

if TYPE_CHECKING:
    from linkwright.core.diagnose.motion.log import MotionLog


@dataclass(frozen=True, repr=False)
class MotionSimulation(Log):
    """A motion log that a model would give."""

    seed: int

    @property
    def _rms(self) -> tuple[float, ...]:
        return tuple(np.sqrt(np.mean(np.square(self.found.torque), axis=0)).tolist())

    @property
    def description(self) -> Description:
        """How long it is, and what the drives give."""
        name, seconds = self.arm.name, with_unit(float(self.found.time[-1]), "s", 3)
        headline = f"{self.found.size} samples in {seconds}; torques of {torque(of_all_joints(self._rms)).text} RMS"
        return Description(name, headline, (), subject=f"{name}: ")

    def save(self, path: File) -> Sequence[Path]:
        """Write the log as CSV and its settings beside it, and read it back; gives which files. Raises `InputError`,
        also where settings of another's stand beside it."""
        return saved(path, log_text(self.found, self.arm.model), settings_text(self.found), self._unlike)

    def _unlike(self, path: Path) -> Iterator[str]:
        """What the log that is read from a file says otherwise."""
        back = read_file(path, self.arm.model, path.with_suffix(".yaml"))
        return unlike_arrays(self.found, back, "time", "q", "torque", "velocity")

    def to_json(self) -> str:
        """What `simulate --json` writes."""
        content: Mapping[str, Any] = {
            "arm": self.arm.name,
            **OBSERVES,
            "samples": self.found.size,
            "seconds": float(self.found.time[-1]),
            "torque_rms": list(self._rms),
            "effects": [fields(effect, "effect", "at") for effect in self.arm.model.effects],
            "seed": self.seed,
        }
        return json_text(content)


def simulated_motion(
    arm: Arm, motion: File, torques: Quantity | Sequence[Quantity] | None, seed: int
) -> MotionSimulation:
    """The log that an arm's model would give: of the motion in a file, or of one drawn at random that lasts so long
    (`20 s`). Raises `InputError`."""
    noise = torque_noise(torques, arm)
    how: dict[str, Any] = {"noise": noise or None, "seed": seed}
    if not Path(motion).exists() and str(motion)[:1].isdigit():
        how["seconds"] = in_si(str(motion), "time", "motion")
        if not 1.0 <= how["seconds"] <= 3600.0:
            raise InputError("", "motion", f"lasts from 1 s to 3600 s, not {motion}")
    else:
        how["motion"] = read_motion(Path(motion), arm.model)
    try:
        made: MotionLog = simulate_motion(arm.model, **how)
    except NoRoom as error:
        raise InputError("", "avoid", str(error)) from None
    return MotionSimulation(arm, made, seed)
