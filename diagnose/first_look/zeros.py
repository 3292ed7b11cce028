"""Joints that count from another zero where a free frame or tool swallows it: positions then show nothing of that.

What hangs on the joint pulls another way than the model says, and causes would be named for it. Readings beyond the
range that the arm file declares, which a quarter or half turn puts within it, tell of such a zero; it is believed
where the arm as declared fits the tip better with it by far.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.fitting.fit import fit, remaining
from linkwright.core.diagnose.fitting.prepare import Prepared, prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import rms_length
from linkwright.core.units.quantities import InputError

from .library import Library
from .recording import shown_length


def refuse_another_zero(
    arm: Arm, recording: Recording, prepared: Prepared, asked: Options, floor: float | None
) -> None:
    """Raise `InputError` where readings of a joint are beyond its range, another zero puts them all within it, and the
    arm as declared leaves far less of the tip then. `prepared` is the recording (noise `floor`, m) as it is."""
    rules = asked.rules.mistakes
    for index, joint in enumerate(arm.joints):
        low, high = joint.range
        values, slack = recording.q[:, index], 1e-6
        beyond = int(np.sum((values < low - slack) | (values > high + slack)))
        if not joint.revolute or high - low >= 2.0 * math.pi or beyond < rules.few_rows * recording.size:
            continue
        for angle in (math.pi / 2.0, -math.pi / 2.0, math.pi, -math.pi):
            if (values + angle).min() < low - slack or (values + angle).max() > high + slack:
                continue
            other = prepare(observe(arm, _counted_from(recording, index, angle), rules=asked.rules), asked, floor)
            before, after = _left(prepared), _left(other)
            numbers = min(prepared.observed.rows, other.observed.rows) * prepared.observed.components
            if 2.0 * numbers * math.log(before / max(after, 1e-300)) > rules.zero_fits:
                zero = Library(arm, {}, recording.tip.shape[1]).zero(index, angle)
                whole = math.degrees(math.remainder(joint.zero + angle, 2.0 * math.pi))
                message = (
                    f"{zero.said[0]}, it seems: {beyond} of its readings are beyond the range that the arm file "
                    f"declares, and none with this zero; the error beyond frame and tool falls from "
                    f"{shown_length(before)} to {shown_length(after)}; write `zero: {whole:.4g} deg` (with dh: theta) "
                    f"at joint {index + 1} in the arm file"
                )
                raise InputError(recording.file, "", message)


def _counted_from(recording: Recording, index: int, angle: float) -> Recording:
    """The recording with a joint (from 0) that reads so much more (rad)."""
    more = np.zeros(recording.q.shape[1])
    more[index] = angle
    commanded = None if recording.commanded is None else recording.commanded + more
    beside = None if recording.joint_side is None else recording.joint_side + more
    return replace(recording, q=recording.q + more, commanded=commanded, joint_side=beside)


def _left(prepared: Prepared) -> float:
    """What the arm as declared leaves of the tip, beside what is free (RMS length, m)."""
    return rms_length(remaining(prepared, fit(prepared, ()))[:, : prepared.observed.components])
