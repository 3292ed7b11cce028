"""How stiff an arm is at its tip: the least force over the displacement that it brings, whatever its direction.

The compliance matrix C (m/N) holds the tip's displacements under unit forces through the arm's model; the stiffness
at a pose is one over its largest singular value. Of a planar arm C is that of its plane. What it gives out of its
plane, which a planar model does not count, is told beside it (`Sideways`): links bend about their other axis and, where
the arm is bent, twist; joints give in their motion and, where they have a `tilting_stiffness`, in their bearings. To
first order, by unit forces across the plane through the arm's model in space.

A limit holds through cuts, each a pose with a direction u of the force: |C u| is at most the largest singular value
of the compliance C, whatever u, and equals it where u is its direction. So every cut is valid for every design,
smooth, and exact where it was made.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.compiled.vectorise import Expressions
from linkwright.core.arm.errors.model import beam_symbols, beam_values, beams_of, error_model, needs_shear_modulus
from linkwright.core.arm.errors.structure import by_structure
from linkwright.core.arm.figures.design import DesignExpressions, Designs, DesignValues
from linkwright.core.arm.figures.figure import Asked, Cut, Figure, Held, PoseFamily, ThroughPoses, Worst
from linkwright.core.arm.figures.limit import Limit
from linkwright.core.arm.limits.weakest_poses import climbed, plainest
from linkwright.core.sections.numeric import Array, column_of_symbols
from linkwright.core.units.quantities import InputError

if TYPE_CHECKING:
    from linkwright.core.arm.evaluation import Evaluation
    from linkwright.core.arm.worst.search import WorstSearch

_CLIMBS = 4


@dataclass(frozen=True)
class TipCompliance(Expressions):
    """An arm's compliance at its tip as a function of poses and designs: the columns of C one below the other, for
    symbols (q, p); `size` is 2 in the plane, 3 in space, and 1 out of the plane."""

    size: int

    def matrices(self, q: Array, p: Array) -> Array:
        """C (N, d, d) in m/N at poses q (N, n) of a design p, or of N designs: rows are displacements."""
        columns = np.reshape(self.vectorised(q, p)[0], (len(q), self.size, self.size))
        return columns.transpose(0, 2, 1)


@dataclass(frozen=True)
class TipStiffness:
    """The least stiffness (N/m), the pose that has it, and the direction of the force (unit vector)."""

    value: float
    q: tuple[float, ...]
    direction: tuple[float, ...]


def tip_compliance(arm: Arm, *, planar: bool, tips: Sequence[str] = ()) -> TipCompliance:
    """An arm's compliance at its tip; with `planar` in the x-y plane alone. `tips` are as for `compliance_along`."""
    return compliance_along(arm, (0, 1) if planar else (0, 1, 2), tuple(tips))


def tips_of(cases: Sequence[LoadCase]) -> tuple[str, ...]:
    """The tips that load cases name, each once."""
    return tuple(dict.fromkeys(case.tip for case in cases))


@by_structure
def compliance_along(arm: Arm, axes: tuple[int, ...], tips: tuple[str, ...] = ()) -> TipCompliance:
    """What the tip gives along some axes of the base frame (0, 1, 2) under unit forces along them.

    Of several `tips` each gives for itself, one after the other along the diagonal: the largest singular value is then
    that of the softest, and the direction of its force is zero at the others.
    """
    if len(tips) > 1:
        by_tip = [compliance_along(arm.on(tip), axes) for tip in tips]
        q, p = by_tip[0].inputs
        blocks = [ca.reshape(one.function(q, p), one.size, one.size) for one in by_tip]
        return TipCompliance((q, p), (ca.densify(ca.vec(ca.diagcat(*blocks))),), sum(one.size for one in by_tip))
    arm = arm.on(tips[0]) if tips else arm
    drives = tuple(replace(joint, zones=()) for joint in arm.joints)  # each with the stiffness of its softest zone
    still = replace(arm, gravity=(0.0, 0.0, 0.0), joints=drives)
    forces = [(0.0, 0.0, 0.0), *((float(k == 0), float(k == 1), float(k == 2)) for k in axes)]
    q, p = column_of_symbols("q", arm.size), beam_symbols(arm)
    cases = error_model(still, [LoadCase(force=force) for force in forces]).cases
    rest, *moved = [case.function(q, p)[0] for case in cases]
    columns = [(item - rest)[list(axes)] for item in moved]
    return TipCompliance((q, p), (ca.vertcat(*columns),), len(axes))


def stiffnesses(matrices: Array) -> Array:
    """The least stiffness (N,) in N/m of compliance matrices (N, d, d); infinite where nothing gives."""
    with np.errstate(divide="ignore"):
        return 1.0 / np.linalg.norm(matrices, ord=2, axis=(1, 2))


def stiffness_at(compliance: TipCompliance, poses: Array, p: Array) -> list[TipStiffness]:
    """The stiffness at each of the poses (N, n) for a design p."""
    matrices = compliance.matrices(poses, p)
    _, _, forces = np.linalg.svd(matrices)
    return [
        TipStiffness(float(value), tuple(q), tuple(force))
        for value, q, force in zip(stiffnesses(matrices), poses.tolist(), forces[:, 0].tolist(), strict=True)
    ]


def least_stiffness(
    compliance: TipCompliance, poses: Sequence[Sequence[float]] | Array, p: Array, search: WorstSearch | None = None
) -> TipStiffness | None:
    """The least stiffness over poses (N, n) for a design p; with `search` over its workspace, the poses being where
    climbs start. None where nothing gives."""
    q = np.asarray(poses, dtype=float)

    def softness(q: Array) -> Array:
        return np.linalg.norm(compliance.matrices(q, p), ord=2, axis=(1, 2))[:, None]

    if search is not None:
        q = np.vstack([q, climbed(search, softness, q, p, _CLIMBS)])
    softest = q[int(np.argmin(stiffnesses(compliance.matrices(q, p))))]
    if search is not None and search.workspace.kind == "joints" and np.isfinite(softness(softest[None])[0, 0]):
        softest = plainest(lambda q: softness(q)[:, 0], softest, (search.lower, search.upper))
    stiffness = stiffness_at(compliance, softest[None], p)[0]
    return stiffness if np.isfinite(stiffness.value) else None


_LEAST = 1e-24
"""Keeps the logarithm of a compliance of nothing finite."""


@dataclass(frozen=True)
class PreparedStiffness:
    """The compliance, and the numbers of the problem's limits on it: each has a group of poses of its own."""

    compliance: TipCompliance
    limits: tuple[int, ...]


class Stiffness(PoseFamily[TipStiffness]):
    """The compliance under a force of some direction: a cut holds the direction beside the pose."""

    name: str = "stiffness"
    needs: frozenset[str] = frozenset({"compliances"})
    called: str = "tip_stiffness"
    stiffer_is_better: ClassVar[bool] = True

    forces: tuple[LoadCase, ...] = ()
    """The forces beside the load cases under which the beams' values are needed."""

    def of_arm(self, arm: Arm, cases: Sequence[LoadCase]) -> TipCompliance:
        """The compliance at the tips that load cases name; where all is planar, in its plane."""
        planar = all(arm.on(load.tip).planar(load) for load in cases)
        return tip_compliance(arm, planar=planar, tips=tips_of(cases))

    def compliance(self, problem: Asked) -> TipCompliance:
        """The compliance of the problem's arm; raises `InputError` where there is none to limit."""
        return self.of_arm(problem.arm, problem.load_cases)

    def prepare(self, problem: Asked) -> PreparedStiffness:
        """The compliance, and the numbers of the limits on it."""
        numbers = tuple(k for k, limit in enumerate(problem.limits) if limit.name == self.called)
        return PreparedStiffness(self.compliance(problem), numbers)

    def groups(self, problem: Asked) -> int:
        """One for each limit, as each may have poses of its own."""
        return sum(limit.name == self.called for limit in problem.limits)

    def more(self, prepared: PreparedStiffness) -> int:
        """The direction of the force."""
        return prepared.compliance.size

    def load_case(self, cut: Cut) -> int:
        """Any: what the arm carries does not change what gives."""
        del cut
        return 0

    def rows(
        self, prepared: PreparedStiffness, group: int, pose: tuple[Any, Any], design: DesignExpressions, held: Held
    ) -> Iterator[tuple[int, Any]]:
        """The compliance over what is allowed, in its logarithm."""
        q, force = pose
        size, number = prepared.compliance.size, prepared.limits[group]
        columns = ca.reshape(prepared.compliance.function(q, design.beam_column), size, size)
        moved = ca.mtimes(columns, force) * held.limits[number].value
        yield number, 0.5 * ca.log(ca.dot(moved, moved) + _LEAST) - held.slack[number]

    def evaluate(self, design: DesignValues) -> TipStiffness | None:
        """The softest pose of the workspace; None where nothing gives."""
        p = beam_values(beams_of(design.arm, [*design.load_cases, *self.forces])) if self.forces else design.p
        return least_stiffness(self.of_arm(design.arm, design.load_cases), design.poses, p, design.search)

    def at_poses(self, evaluation: Evaluation, poses: Sequence[tuple[float, ...]]) -> float | None:
        """The least (N/m) at the poses that a limit names."""
        cases = evaluation.load_cases
        p = beam_values(beams_of(evaluation.arm, [*cases, *self.forces]))
        stiffness = least_stiffness(self.of_arm(evaluation.arm, cases), poses, p)
        return None if stiffness is None else stiffness.value

    def values(self, result: TipStiffness) -> Mapping[str, float | None]:
        """The least stiffness."""
        return {self.called: result.value}

    def worst(self, prepared: PreparedStiffness, problem: Asked, design: DesignValues) -> list[Worst]:
        """The softest pose of the workspace, or each of the poses that a limit names."""
        worst: list[Worst] = []
        for group, number in enumerate(prepared.limits):
            poses = problem.limits[number].poses
            if poses is None:
                softest = least_stiffness(prepared.compliance, design.poses, design.p, design.search)
                poses_here = [] if softest is None else [softest]
            else:
                poses_here = stiffness_at(prepared.compliance, np.array(poses), design.p)
            cuts = [(pose.value, Cut(pose.q, group, pose.direction)) for pose in poses_here]
            worst += [Worst(self.called, value, cut, number) for value, cut in cuts]
        return worst

    def at_pose(self, prepared: PreparedStiffness, group: int, q: Array, designs: Designs) -> Mapping[str, Array]:
        """The stiffness of each design at its pose."""
        del group
        return {self.called: stiffnesses(prepared.compliance.matrices(q, designs.p))}

    def exactly(self, prepared: PreparedStiffness, limit: Limit, designs: Designs) -> Array | None:
        """The least stiffness of each design at the poses that the limit names."""
        if limit.poses is None:
            return None
        places = [np.tile(np.array(q), (len(designs.p), 1)) for q in limit.poses]
        return np.min([stiffnesses(prepared.compliance.matrices(q, designs.p)) for q in places], axis=0)


def softest_pose(result: TipStiffness) -> tuple[float, ...]:
    """The pose that has the least stiffness."""
    return result.q


def stiffness_figure(name: str, family: Stiffness, key: str, **more: Any) -> Figure:
    """The figure of a family of stiffnesses, in N/mm."""
    return Figure(
        name=name,
        kind="linear_stiffness",
        unit="N/mm",
        factor=1e-3,
        senses=(">=",),
        key=f"{key}_N_per_mm",
        follows=ThroughPoses(family),
        more_is_better=True,
        **more,
    )


STIFFNESS = Stiffness()
"""What the tip gives in all directions that count."""

TIP_STIFFNESS = stiffness_figure(
    "tip_stiffness",
    STIFFNESS,
    "tip_stiffness",
    synonyms=("stiffness", "compliance"),
    title="tip stiffness",
    note="least",
    where=softest_pose,
    at_poses=STIFFNESS.at_poses,
)


SIDEWAYS = LoadCase(force=(0.0, 0.0, 1.0))
"""One newton across the plane."""


def sideways_compliance(arm: Arm, tips: Sequence[str] = ()) -> TipCompliance:
    """A planar arm's compliance at its tip across its plane, as a function of poses and designs; `tips` are as for
    `compliance_along`."""
    return compliance_along(arm, (2,), tuple(tips))


def sideways_rigidities(arm: Arm) -> tuple[float | None, ...]:
    """Each link's flexural rigidity about its other axis (N*m^2), E I_z; None where it is rigid."""
    beams = beams_of(arm)
    rigidities = (beam.flexural_rigidity_width for beam in beams)
    return tuple(None if value is None else float(value) for value in rigidities)


class Sideways(Stiffness):
    """The compliance under a force across the plane: the same rows as in the plane, with one direction alone."""

    name: str = "sideways"
    needs: frozenset[str] = frozenset()
    called: str = "sideways_stiffness"

    forces: tuple[LoadCase, ...] = (SIDEWAYS,)

    def of_arm(self, arm: Arm, cases: Sequence[LoadCase]) -> TipCompliance:
        """The compliance across the plane."""
        return sideways_compliance(arm, tips_of(cases))

    def evaluate(self, design: DesignValues) -> TipStiffness | None:
        """The softest pose of the workspace; None in space, or where nothing gives.

        Raises `MissingProperty` for what a planar model does without: a shear modulus, say, for links that twist.
        """
        return super().evaluate(design) if design.search.model.planar else None

    def compliance(self, problem: Asked) -> TipCompliance:
        """The compliance across the plane; raises `InputError` where there is none to limit."""
        arm, cases = problem.arm, problem.load_cases
        if not all(arm.planar(load) for load in cases):
            message = "is for arms that stay in the x-y plane; this one moves in space: use tip_stiffness"
            raise InputError("", f"subject_to.{self.called}", message)
        if needs_shear_modulus(arm, [SIDEWAYS]) and not needs_shear_modulus(arm, cases):
            message = "needs links that shear: leave out torsion too, or do not leave out shear_deformation"
            raise InputError("", f"subject_to.{self.called}", message)
        return self.of_arm(arm, cases)


ACROSS = Sideways()
"""What the tip of a planar arm gives across its plane."""

SIDEWAYS_STIFFNESS = stiffness_figure(
    "sideways_stiffness",
    ACROSS,
    "sideways_stiffness",
    synonyms=("lateral_stiffness", "out_of_plane_stiffness"),
    title="sideways stiffness",
    note="least, across the arm's plane",
    where=softest_pose,
    everywhere=False,
)
