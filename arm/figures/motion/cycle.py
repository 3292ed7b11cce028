"""What cycles of motion take of the drives: root mean square and peak, against what the drives give.

A drive is warm by the root mean square of its torque over the cycle, and is asked for the peak at once (the makers'
selection procedure). Torques are those of inverse dynamics, linear in the links' masses: the square of each is a
quadratic form of them, which a cut holds.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.bodies.beams import beam_of
from linkwright.core.arm.bodies.bodies import link_axes, rod
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.figures.design import DesignExpressions, DesignValues
from linkwright.core.arm.figures.figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst
from linkwright.core.arm.motion.cycle import Cycle, cycles_of
from linkwright.core.arm.motion.dynamics import OfDrive, drive_torques, loads_of, most_of
from linkwright.core.arm.motion.rigid import parameters_of, rigid_torque, without_tip_load
from linkwright.core.sections.numeric import Array

_ROUNDING = 1e-9
"""(N*m)^2 under a root, so that it has a slope where a drive holds nothing."""


@dataclass(frozen=True)
class CycleLoads:
    """The greatest of a figure over drives and cycles: root mean square and peak torque (N*m, of joints that turn), and
    the share of what drives give that they take (None where nobody knows that); the most that is asked of each
    drive."""

    rms: float | None
    peak: float | None
    use: float | None
    by_joint: tuple[OfDrive, ...]


class Cycles(PoseFamily[CycleLoads]):
    """Root mean square and peak of each drive's torque over each cycle; a group is of a cycle, a drive and either."""

    name: str = "cycle"
    needs: frozenset[str] = frozenset({"masses"})
    called: str = "rms_torque"
    bounds_many: ClassVar[bool] = False

    def prepare(self, problem: Asked) -> Arm:
        """The arm, whose drives and fixed masses hold."""
        return problem.arm

    def groups(self, problem: Asked) -> int:
        """Two for each drive and cycle."""
        return 2 * problem.arm.size * len(cycles_of(problem.load_cases))

    def more(self, prepared: Arm) -> int:
        """The quadratic form of (1, masses of the links)."""
        return (prepared.size + 1) ** 2

    def rows(
        self, prepared: Arm, group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterator[tuple[int, Any]]:
        """The torque over what is allowed of it."""
        joint, peak = prepared.joints[group // 2 % prepared.size], bool(group % 2)
        masses = ca.vertcat(1.0, *[ca.SX(beam.mass) for beam in design.beams])
        form = ca.reshape(pose[1], prepared.size + 1, prepared.size + 1)
        torque = ca.sqrt(ca.fmax(ca.bilin(form, masses, masses), 0.0) + _ROUNDING)
        name = PEAK_TORQUE.name if peak else RMS_TORQUE.name
        for key, allowed in ((name, 1.0 if joint.revolute else math.inf), (MOTION_USE.name, joint.rating[int(peak)])):
            if allowed is not None and math.isfinite(allowed):
                for number, limit, slack in held.on(key):
                    yield number, torque / (allowed * limit) - ca.exp(slack)

    def evaluate(self, design: DesignValues) -> CycleLoads | None:
        """The greatest over drives and cycles; None where nothing moves."""
        cycles = cycles_of(design.load_cases)
        if not cycles:
            return None
        joints = design.arm.joints
        drives = most_of([loads_of(cycle.motion(design.arm)) for cycle in cycles])
        turning = [drive for joint, drive in zip(joints, drives, strict=True) if joint.revolute]
        uses = [use for joint, drive in zip(joints, drives, strict=True) for use in drive.uses(joint)]
        return CycleLoads(
            max((drive.rms_torque for drive in turning), default=None),
            max((drive.torque for drive in turning), default=None),
            max((use for use in uses if use is not None), default=None),
            drives,
        )

    def values(self, result: CycleLoads) -> Mapping[str, float | None]:
        """The three figures."""
        return {RMS_TORQUE.name: result.rms, PEAK_TORQUE.name: result.peak, MOTION_USE.name: result.use}

    def warnings(self, arm: Arm, result: CycleLoads) -> list[str]:
        """One line for each drive that a cycle asks too much of."""
        lines: list[str] = []
        for number, (joint, drive) in enumerate(zip(arm.joints, result.by_joint, strict=True), start=1):
            unit, pair = "N*m" if joint.revolute else "N", (drive.rms_torque, drive.torque)
            for word, value, rating in zip(("rms", "peak"), pair, joint.rating, strict=True):
                if rating is not None and value > rating:
                    given = "rated" if word == "rms" else "peak"
                    lines.append(
                        f"joint {number} needs {value:.4g} {unit} {word}, more than its {given} {rating:.4g} {unit}"
                    )
        return lines

    def worst(self, prepared: Arm, problem: Asked, design: DesignValues) -> list[Worst]:
        """Each drive's root mean square and peak over each cycle, as the problem limits them."""
        del prepared
        names = {limit.name for limit in problem.limits}
        shown: list[Worst] = []
        for number, cycle in enumerate(cycles_of(problem.load_cases)):
            torque, by_mass = _by_masses(design.arm, cycle)
            drives = loads_of(cycle.motion(design.arm))
            for index, joint in enumerate(design.arm.joints):
                pair = drives[index].rms_torque, drives[index].torque
                top = int(np.argmax(np.abs(torque[:, index])))
                terms = by_mass[:, :, index]
                forms = (np.einsum("na,nb,n->ab", terms, terms, _shares(cycle)), np.outer(terms[top], terms[top]))
                for peak, (value, form) in enumerate(zip(pair, forms, strict=True)):
                    group = 2 * (number * design.arm.size + index) + peak
                    cut = Cut(tuple(cycle.q[top].tolist()), group, tuple(form.ravel(order="F").tolist()))
                    if joint.revolute:
                        shown.append(Worst((RMS_TORQUE, PEAK_TORQUE)[peak].name, value, cut))
                    rating = joint.rating[peak]
                    if rating is not None:
                        shown.append(Worst(MOTION_USE.name, value / rating, cut))
        return [item for item in shown if item.name in names]


def _shares(cycle: Cycle) -> Array:
    """The weight (N,) of each instant in a mean over time, by trapezoids."""
    steps = np.diff(cycle.time)
    weights = np.zeros(len(cycle.time))
    weights[:-1] += 0.5 * steps
    weights[1:] += 0.5 * steps
    return weights / float(steps.sum())


def _by_masses(arm: Arm, cycle: Cycle) -> tuple[Array, Array]:
    """A cycle's torques (N, n), and their terms (N, 1 + n, n): what no link's mass changes, then by kg of each link."""
    motion = cycle.motion(arm)
    torque, bare = drive_torques(motion), without_tip_load(motion.arm)
    terms = np.zeros((len(cycle.time), arm.size + 1, arm.size))
    terms[:, 0] = torque
    for index, link in enumerate(arm.links):
        if not link.elastic or link.material is None:
            continue
        beam = beam_of(arm, index)
        body = rod(link, beam, link_axes(arm.joints[index], link), link.material.at(arm.temperature))
        parameters = np.zeros((arm.size, 10))
        parameters[index] = parameters_of(body) / body.mass
        by_mass = rigid_torque(bare, parameters, cycle.q, cycle.velocity, cycle.acceleration)
        terms[:, index + 1] = by_mass
        terms[:, 0] -= body.mass * by_mass
    return torque, terms


def least_use(arm: Arm, cycle: Cycle) -> float:
    """The least that a cycle takes of what the drives give, whatever the links weigh: rms over rated or peak over peak
    torque, the greatest of any drive. A link's mass is spread as in the arm's sections."""
    from scipy.optimize import linprog, nnls  # here, as few problems have a cycle

    _, terms = _by_masses(arm, cycle)
    root = np.sqrt(_shares(cycle))
    uses = [0.0]
    for index, joint in enumerate(arm.joints):
        fixed, by_mass = terms[:, 0, index], terms[:, 1:, index]
        rated, peak = joint.rating
        if rated is not None:
            uses.append(nnls(root[:, None] * by_mass, -root * fixed)[1] / rated)
        if peak is not None:
            rows = np.vstack([by_mass, -by_mass])
            rows = np.hstack([rows, -np.ones((len(rows), 1))])
            least = linprog([0.0] * arm.size + [1.0], A_ub=rows, b_ub=np.concatenate([-fixed, fixed]))
            uses.append(least.fun / peak)
    return max(uses)


CYCLES = Cycles()
"""The loads of cycles on the drives."""


def _torque(name: str, title: str, synonyms: tuple[str, ...]) -> Figure:
    return Figure(
        name=name,
        synonyms=synonyms,
        title=title,
        senses=("<=",),
        key=f"{name}_Nm",
        follows=ThroughPoses(CYCLES),
        kind="torque",
        unit="N*m",
        note="greatest, of any joint that turns",
        everywhere=False,
    )


def _assumed(problem: Asked) -> float | None:
    """Drives give what cycles take, whether or not anybody asks for it."""
    driven = any(rating is not None for joint in problem.arm.joints for rating in joint.rating)
    return 1.0 if cycles_of(problem.load_cases) and (driven or problem.actuators is not None) else None


RMS_TORQUE = _torque("rms_torque", "rms torque over a cycle", ("root_mean_square_torque", "effective_torque"))
PEAK_TORQUE = _torque("peak_torque", "peak torque over a cycle", ("greatest_torque", "maximum_torque"))
MOTION_USE = Figure(
    name="motion_use",
    synonyms=("drive_use", "cycle_use"),
    title="use of drives over a cycle",
    senses=("<=",),
    key="motion_use",
    follows=ThroughPoses(CYCLES),
    note="rms over rated torque, or peak over peak torque",
    traded=False,
    assumed=_assumed,
    everywhere=False,
)
