"""An arm watched over dated motion logs: the sizes of what was found in each, and what moved when."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.uses.by_log import by_log
from linkwright.core.diagnose.options import Options, Progress

from .estimates import Estimates, Parameter
from .watch import Watch, watched


def watch_motion(arm: Arm, logs: Sequence[MotionLog], options: Options, progress: Progress) -> Watch:
    """Watch an arm over at least three motion logs, each with a separate date; what is left in each is an RMS torque
    (N*m). Raises what `diagnose_motion` raises."""
    ordered = sorted(logs, key=lambda log: log.date)
    made = by_log(arm, ordered, options, progress)
    parameters = [
        Parameter(effect, size.at, size.parameter, size.kind, identified=True)
        for effect, size in zip(made.effects, made.sizes[0], strict=True)
    ]
    shape = (len(ordered), len(parameters))
    values = np.array([[size.value for size in sizes] for sizes in made.sizes]).reshape(shape)
    errors = np.array([made.errors(log) for log in range(len(ordered))]).reshape(shape)
    rows, aside = tuple(log.size for log in ordered), tuple(len(log.rejected) for log in ordered)
    estimates = Estimates(values, errors, np.array(made.freedom), np.array(made.left), rows, aside)
    searched = tuple(range(len(ordered)))
    return watched(arm, ordered, parameters, estimates, made.together, searched, rules=options.rules.watch)
