"""The sizes of one set of causes in each of several logs by itself: what was identified in all of them together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.fitting.fit import t_quantile
from linkwright.core.diagnose.motion.diagnosis import diagnosed
from linkwright.core.diagnose.motion.findings import parameters_of
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.model.evidence import Member, system
from linkwright.core.diagnose.motion.model.identify import Identified
from linkwright.core.diagnose.motion.model.intervals import Estimates, estimates
from linkwright.core.diagnose.motion.model.products import Products
from linkwright.core.diagnose.motion.model.steps import Step
from linkwright.core.diagnose.motion.result import MotionDiagnosis
from linkwright.core.diagnose.options import Options, Progress
from linkwright.core.diagnose.result import FittedParameter
from linkwright.core.sections.numeric import Array


@dataclass(frozen=True)
class ByLog:
    """Logs diagnosed together, and fitted one by one with what was found.

    Args:
        together: The diagnosis of all.
        effects: (P,) the effect of each parameter.
        sizes: For each log its (P,) parameters with their intervals.
        freedom: (L,) degrees of freedom of each log: blocks of time less one.
        left: (L,) N*m, RMS of what each log's sizes leave, of all joints together.
    """

    together: MotionDiagnosis
    effects: tuple[str, ...]
    sizes: tuple[tuple[FittedParameter, ...], ...]
    freedom: tuple[int, ...]
    left: tuple[float, ...]

    def errors(self, log: int) -> list[float]:
        """Standard errors of a log's sizes."""
        factor = t_quantile(self.freedom[log])
        return [0.5 * (size.interval[1] - size.interval[0]) / factor for size in self.sizes[log]]


def by_log(arm: Arm, logs: Sequence[MotionLog], options: Options, progress: Progress) -> ByLog:
    """Diagnose logs together, and fit each with what was found. Raises what `diagnose_motion` raises."""
    result, rests_on = diagnosed(arm, logs, options, progress)
    if rests_on is None:
        return ByLog(result, (), ((),) * len(logs), (1,) * len(logs), tuple(log.rms_before for log in result.of_logs))
    identified, sizes, steps = rests_on.identified, rests_on.sizes, rests_on.different.steps
    members = _with_steps(identified, steps)
    named = _parameters(arm, identified, identified.members, sizes, sizes.shown)
    named += [(item.effect, size) for item in result.findings if item.recording for size in item.parameters]
    # Of the ten numbers of a load those that are something.
    something = ((effect, size) for effect, size in named if size.interval[0] > 0.0 or size.interval[1] < 0.0)
    chosen = list(dict.fromkeys((effect, size.at, size.parameter) for effect, size in something))
    each_log: list[tuple[FittedParameter, ...]] = []
    freedom: list[int] = []
    left: list[float] = []
    for number in range(len(logs)):
        log_products = identified.products.of_log(number).with_more(
            rests_on.different.sizes(number, identified.pool.width)
        )
        system_ = system(identified.pool, log_products, identified.noise.weights, identified.discrepancy)
        alike = np.zeros(identified.pool.width)  # What has no name is the same in all logs, and so are names.
        fitted = estimates(
            system_,
            log_products,
            identified.noise.weights,
            (*members, *identified.system.nuisances),
            alike,
            sure=True,
            rules=options.rules,
        )
        pairs = _parameters(arm, identified, members, fitted, np.ones(len(fitted.numbers), dtype=bool))
        each = {(effect, item.at, item.parameter): item for effect, item in pairs}
        each_log.append(tuple(each[key] for key in chosen))
        freedom.append(max(log_products.blocks - 1, 1))
        left.append(_rms(log_products, fitted.sizes))
    return ByLog(result, tuple(effect for effect, *_ in chosen), tuple(each_log), tuple(freedom), tuple(left))


def _with_steps(identified: Identified, steps: Sequence[Step]) -> tuple[Member, ...]:
    """The members, and what differs between the logs."""
    members, pool = list(identified.members), identified.pool.groups
    for step in steps:
        number = next(index for index, group in enumerate(pool) if group is step.group)
        scale = float(np.max(np.abs(step.numbers) / step.group.usual))
        if all(member.group != number for member in members):
            members.append(Member(number, max(scale, 1.0)))
    return tuple(members)


def _parameters(
    arm: Arm, identified: Identified, members: Sequence[Member], sizes: Estimates, shown: NDArray[np.bool_]
) -> list[tuple[str, FittedParameter]]:
    """The sizes of all members, each with its effect; what shapes a pattern is the same in all logs."""
    made: list[tuple[str, FittedParameter]] = []
    start = 0
    for member in members:
        group = identified.pool.groups[member.group]
        part = slice(start, start + group.rank)
        start += group.rank
        shapes = {shape.name for shape in group.effect.torque_shapes}
        parameters = parameters_of(group, arm, sizes.numbers[part], sizes.half[:, part], shown[part])
        made += [(group.effect.id, parameter) for parameter in parameters if parameter.parameter not in shapes]
    return made


def _rms(products: Products, sizes: Array) -> float:
    rows = np.maximum(products.rows.sum(axis=0), 1)
    return float(np.sqrt(np.mean(products.left(sizes).sum(axis=0) / rows)))
