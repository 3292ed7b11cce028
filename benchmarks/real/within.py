"""Cross-validation with the diagnosis inside: what to look for is chosen anew without each fold."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.real.model import Array, Part, fitted, found, loose, moved
from benchmarks.real.splits import Folds
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.steps.diagnosis import diagnose


def selected_within(
    arm: Arm,
    recording: Recording,
    observed: Observed,
    folds: Folds,
    options: Options,
    tell: Callable[[str], None] = print,
) -> Array:
    """What is left (N, 3), m, of each reading by a model that was both chosen and fitted without its fold."""
    residual = observed.residual[:, :3]
    result = np.full(residual.shape, np.nan)
    for fold in np.unique(folds).tolist():
        seen = folds != fold
        said = diagnose(arm, recording.kept(seen), options)
        parts: list[Part] = [loose(observed), *found(observed, said)]
        result[~seen] = (residual - moved(parts, fitted(residual, parts, seen)))[~seen]
        tell(f"  fold {fold + 1}: {', '.join(part.name for part in parts[1:]) or 'nothing'}")
    return result
