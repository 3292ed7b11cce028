"""How stiff an arm is at its tip: the least force over the displacement that it brings, whatever its direction.

The compliance matrix C (m/N) holds the tip's displacements under unit forces through the arm's own model; the stiffness
at a pose is one over its largest singular value. Of a planar arm C is that of its plane; what it gives out of it, which
a planar model does not count, is told by `arm.limits.sideways`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.compiled.expressions import Expressions
from linkwright.core.arm.errors.model import beam_symbols, error_model
from linkwright.core.arm.errors.structure import by_structure
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.symbols import column_of_symbols

from .weakest_poses import climbed, plainest

if TYPE_CHECKING:
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
        each = [compliance_along(arm.on(tip), axes) for tip in tips]
        q, p = each[0].inputs
        blocks = [ca.reshape(one.function(q, p), one.size, one.size) for one in each]
        return TipCompliance((q, p), (ca.densify(ca.vec(ca.diagcat(*blocks))),), sum(one.size for one in each))
    arm = arm.on(tips[0]) if tips else arm
    drives = tuple(replace(joint, zones=()) for joint in arm.joints)  # each with the stiffness of its softest zone
    still = replace(arm, gravity=(0.0, 0.0, 0.0), joints=drives)
    forces = [(0.0, 0.0, 0.0), *((float(k == 0), float(k == 1), float(k == 2)) for k in axes)]
    q, p = column_of_symbols("q", arm.size), beam_symbols(arm)
    cases = error_model(still, [LoadCase(force=force) for force in forces]).cases
    rest, *moved = [case.function(q, p)[0] for case in cases]
    columns = [(each - rest)[list(axes)] for each in moved]
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
    found = stiffness_at(compliance, softest[None], p)[0]
    return found if np.isfinite(found.value) else None
