"""Where a measuring frame and a tool that nobody knew stand by the joint fit, with intervals."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.arrays import matrices
from linkwright.core.arm.chain.vectors import to_roll_pitch_yaw
from linkwright.core.diagnose.fitting.identified_origins import NEAR, Beside, angles_by_turns, beside_names
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.fitting.refit import Refit
from linkwright.core.diagnose.fitting.room.unnamed import Unnamed
from linkwright.core.diagnose.residual.alignment import Alignment
from linkwright.core.diagnose.residual.observe import observed_about
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.result import FittedParameter, FittedPlacement
from linkwright.core.sections.numeric import Array

_SHIFT = ("frame_misalignment x", "frame_misalignment y", "frame_misalignment z")
_TURN = ("frame_misalignment about_x", "frame_misalignment about_y", "frame_misalignment about_z")
_TOOL = ("tool_offset along", "tool_offset across", "tool_offset out")


def placements(
    prepared: Prepared, fitted: Refit, outside: Sequence[int], unnamed: Unnamed | None
) -> tuple[FittedPlacement, ...]:
    """The base in each measuring frame, and the tip of each tool on the last link, where they are free and the tip's
    place is what was measured; of arms with one tip."""
    observed, names = prepared.observed, prepared.beside_names
    if observed.view is not None or observed.arm_given.branches:
        return ()
    if not any(name.startswith((_SHIFT[0], _TOOL[0])) for name in names):
        return ()
    fit = beside_names(prepared, fitted, outside, unnamed)
    by = fit.sizes
    result: list[FittedPlacement] = []
    for label, rows, alignment in _each(observed):

        def at(wanted: Sequence[str], label: str = label) -> NDArray[np.int64]:
            said = [f"{name}, {label}" if label else name for name in wanted]
            return np.array([names.index(name) for name in said if name in names], dtype=np.int64)

        shift, turn, tool = at(_SHIFT), at(_TURN), at(_TOOL)
        if len(shift):
            back, off = alignment.rotation.T, by[shift] - alignment.translation
            width = len(back)
            whole = np.eye(3)
            whole[:width, :width] = back
            whole = whole @ Rotation.from_rotvec(by[turn] if width == 3 else [0.0, 0.0, by[turn][0]]).as_matrix()
            angles = to_roll_pitch_yaw(whole.tolist())
            slopes = angles_by_turns(angles[1], angles[2]) @ back if width == 3 else np.array([[0.0], [0.0], [1.0]])
            place = _sized("xyz", "length", back @ off, back, shift, fit)
            rolled = _sized(("roll", "pitch", "yaw"), "angle", np.array(angles), slopes, turn, fit)
            result.append(FittedPlacement("frame", label, (*place, *(rolled if width == 3 else rolled[2:]))))
        if len(tool):
            width = observed.components
            axes = matrices(observed.state.frames.orientation, observed.rows, width)[rows]
            ways = np.einsum("nji,njk->nik", axes, prepared.beside[rows][:, :width][:, :, tool]).mean(axis=0)
            put = np.array(observed.arm_given.tool)[:width] + alignment.tool + ways @ by[tool]
            result.append(FittedPlacement("tool", label, _sized("xyz", "length", put, ways, tool, fit)))
    return tuple(result)


def _each(observed: Observed) -> Iterator[tuple[str, NDArray[np.bool_], Alignment]]:
    """Each recording's label, rows and alignment; of several the alignment as each by itself is set against the arm."""
    recording = observed.recording
    parts = recording.parts()
    for index, (label, part) in enumerate(zip(recording.names, parts, strict=True)):
        alone = observed if len(parts) == 1 else observed_about(observed, observed.about, observed.softening, part)
        yield label, observed.which == index, alone.alignment


def _sized(
    names: Sequence[str],
    kind: str,
    values: Array,
    slopes: Array,
    at: NDArray[np.int64],
    fit: Beside,
) -> tuple[FittedParameter, ...]:
    """Values that grow by `slopes` with the nuisances `at`, with their 95 % intervals, infinite where the readings do
    not tell one of those."""
    parameters: list[FittedParameter] = []
    for name, value, slope in zip(names, values.tolist(), slopes, strict=False):
        sure = bool((fit.determined[at] | (np.abs(slope) < NEAR)).all())
        error = float(np.sqrt(max(slope @ fit.covariance[np.ix_(at, at)] @ slope, 0.0)))
        reach = fit.errors * error if sure else np.inf
        parameters.append(FittedParameter(name, name, (), kind, value, (value - reach, value + reach)))
    return tuple(parameters)
