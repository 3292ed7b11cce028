"""The one use of the tool as a library: what an arm file's model leaves of a recording."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from benchmarks.blind.generator.vectors import Array


def left(arm: Path, recording: Path) -> Array:
    """Measured less modelled (rows, axes), m, in the frame as it is.

    Raises ValueError where the reader sets rows aside: a recording free of noise has none that are wrong.
    """
    from linkwright.core.arm.files.read import read_arm
    from linkwright.core.diagnose.reading.read import read_recording
    from linkwright.core.diagnose.residual.observe import observe
    from linkwright.core.materials.catalogue import load_catalogue

    given = read_arm(arm, load_catalogue())
    observed = observe(given, replace(read_recording(recording, given), frame="known"))
    if observed.recording.rejected:
        raise ValueError(f"{recording}: {observed.recording.rejected[0].reason}")
    return observed.tip_residual()
