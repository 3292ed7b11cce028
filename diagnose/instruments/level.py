"""Where a level stands: on the base or on a link, which the joints turn against the plumb line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

from .registry import INSTRUMENTS, marked

if TYPE_CHECKING:
    from linkwright.core.diagnose.recording import Recording


@dataclass(frozen=True)
class Stand:
    """What a level stands on: its axes at each reading, the columns of `axes` (N, 3, 3), and `up` (3,), in the base
    frame. `seat` (3, 3) is how a level that is read level at zero angles is turned on it, its columns in those axes;
    `known` says that it stands so but for small turns, as it does on the base."""

    axes: Array
    up: Array
    seat: Array
    known: bool

    def turned(self, turn: Array) -> Stand:
        """The same once it has turned by (N, 3), rad, about the base's axes."""
        axes = Rotation.from_rotvec(turn).as_matrix() @ self.axes
        return Stand(axes, self.up, self.seat, self.known)


def tilts(recording: Recording) -> NDArray[np.bool_]:
    """Which of a recording's numbers (N, W) are of what turns with a link."""
    assert recording.slots is not None
    return marked(recording.slots, [kind for kind in INSTRUMENTS.values() if kind.turns_with == "link"])


def link_of_levels(recording: Recording) -> NDArray[np.int64] | None:
    """The link, from 1, on which a level stands at each reading (N,): 0 on the base, -1 there is none. None where there
    is none anywhere."""
    if recording.slots is None:
        return None
    there = tilts(recording).any(axis=1)
    return np.where(there, recording.instrument.tilt_link, -1) if there.any() else None


def stand_of(recording: Recording, arm: Arm) -> Stand | None:
    """What a recording's level stands on, undeformed; None without a level. Raises `InputError` where the arm has no
    such link, or where nothing is up."""
    if link_of_levels(recording) is None:
        return None
    link = recording.instrument.tilt_link
    if link > arm.size:
        count_text = f"{arm.size} link{'s' if arm.size > 1 else ''}"
        raise InputError(
            recording.file, "tilt_link", f"is {link}, but {arm.name!r} has {count_text}; count from the base"
        )
    gravity = np.array(arm.gravity, dtype=float)
    size = float(np.linalg.norm(gravity))
    if size <= 0.0:
        raise InputError(recording.file, "tilt_x", "needs the arm file's `gravity`, which is zero: nothing is up")
    up = -gravity / size
    level = _level(up, flat=arm.planar())
    if link == 0:
        return Stand(np.broadcast_to(np.eye(3), (recording.size, 3, 3)), up, level, known=True)
    zero = _axes(arm, np.zeros((1, arm.size)), link)[0]
    return Stand(_axes(arm, recording.q, link), up, zero.T @ level, known=False)


def _level(up: Array, *, flat: bool) -> Array:
    """The axes of a level that lies level in the base frame, in columns: x along the base's as far as that is level (an
    arm in the plane: along z, about which it turns), z upwards."""
    along = min(np.eye(3)[[2, 0] if flat else [0, 1]], key=lambda axis: abs(float(axis @ up)))
    x: Array = along - (along @ up) * up
    x = x / float(np.linalg.norm(x))
    y: Array = np.cross(up, x)
    return np.stack([x, y, up], axis=1)


def _axes(arm: Arm, q: Array, link: int) -> Array:
    """A link's axes (from 1) at poses q (N, n), in the columns of (N, 3, 3)."""
    frame = place(arm, [q[:, index] for index in range(arm.size)]).links[link - 1]
    return np.stack([columns(part, len(q)) for part in (frame.along, frame.height, frame.width)], axis=2)
