"""How the tool is turned, where a recording says so: set against the model, as a further channel.

How the target sits on the tool nobody knows, and the measuring frame may stand anywhere; so a constant turn on either
side is free. What is left is a small turn about the base's axes at each reading. Only where the settings ask for it:
targets of few markers turn by more than the tool does, and nothing tells that from the arm.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.arrays import matrices
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

_HALF_TURN = 2.5
"""rad; near half a turn its sign is chance."""


def turn_left(recording: Recording, state: PoseState, modelled: Array, rotation: Array) -> Array:
    """How the tool is turned beyond the model, (N, 3), rad, about the base's axes; zero where a row has none.

    `modelled` (N, 3), rad, is what the model's effects turn it by, `rotation` (D, D) that from the measuring frame to
    the base's.
    """
    frame = np.eye(3)
    frame[: len(rotation), : len(rotation)] = rotation
    measured, sound = _measured(recording), has_orientation(recording)
    model = Rotation.from_rotvec(modelled) * Rotation.from_matrix(matrices(state.frames.orientation, recording.size))
    placed = Rotation.from_matrix(frame) * measured
    sits = Rotation.from_matrix((model.inv() * placed).as_matrix()[sound]).mean()
    left = (placed * (model * sits).inv()).as_rotvec()
    left[~sound] = 0.0
    return left


def tool_turns(recording: Recording, state: PoseState, width: int) -> Array:
    """How a small turn of the target on the tool shows, (N, 3, k): about the last link's axes, or the one of the
    plane."""
    return matrices(state.frames.orientation, recording.size)[:, :, 2 if width == 2 else 0 :]


def has_orientation(recording: Recording) -> NDArray[np.bool_]:
    """Which readings say how the tool is turned, (N,); none where that is not to be used."""
    if recording.orientation is None or recording.seat == "unused":
        return np.zeros(recording.size, dtype=bool)
    return np.asarray(np.isfinite(recording.orientation).all(axis=(1, 2)), dtype=np.bool_)


def with_sound_orientation(arm: Arm, recording: Recording, *, rules: ResidualRules = RULES.residual) -> Recording:
    """The recording without orientations that are written in another way than the model's, and a warning of it.

    Seen from the tool, its turns from one reading to the next are the same in any frame, and but for one constant turn
    the same however the target sits on it.
    """
    sound = has_orientation(recording)
    if sound.sum() < 2:
        return recording
    q = recording.q[sound]
    # What links weigh turns nothing to speak of.
    weightless = arm.with_links(tuple(replace(link, mass=0.0) if link.mass is None else link for link in arm.links))
    state = solve(weightless, [q[:, index] for index in range(arm.size)], beams_of(weightless))
    model = Rotation.from_matrix(matrices(state.frames.orientation, len(q)))
    measured = Rotation.from_matrix(_measured(recording).as_matrix()[sound])
    turns, seen = ((item[:-1].inv() * item[1:]).as_rotvec() for item in (model, measured))
    size = np.linalg.norm(turns, axis=1)
    telling = (size > rules.turned) & (size < _HALF_TURN)
    if not telling.any():
        return recording
    if recording.tip.shape[1] == 3:
        turns = Rotation.align_vectors(seen[telling], turns[telling])[0].apply(turns)
    off = float(np.median(np.linalg.norm(seen - turns, axis=1)[telling]))
    if off <= rules.turned:
        return recording
    warning = (
        f"How the tool is turned from reading to reading differs from the model by {np.degrees(off):.0f} deg (median). "
        "The orientations are set aside. Check the order of the angles or of the quaternion (qw first or last)."
    )
    return replace(recording, seat="unused", warnings=(*recording.warnings, warning))


def _measured(recording: Recording) -> Rotation:
    """The measured orientations; none at all where a row lacks it."""
    sound = has_orientation(recording)
    matrices = np.broadcast_to(np.eye(3), (recording.size, 3, 3)).copy()
    if recording.orientation is not None:
        matrices[sound] = recording.orientation[sound]
    rotations = Rotation.from_matrix(matrices)
    # A camera on the tool reads how a fixed target is turned before it, which is how it is turned the other way round.
    return rotations.inv() if recording.instrument.camera == "on_tool" else rotations
