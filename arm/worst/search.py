"""The worst pose: the largest position error over a workspace and all load cases, with a bound where one can be had.

Where the error is a trigonometric polynomial of few joints, its local maxima are climbed to and branch and bound
certifies the largest; its maximiser is fed back. Otherwise a scan over spread poses is refined from many starts.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.errors.lost_motion import PlayedError, played
from linkwright.core.arm.errors.model import BEAM_FIELDS, ErrorModel
from linkwright.core.arm.errors.varied import as_it_is
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import NoAnswer

from .certificate import Certified, climb, maximise
from .loose_bound import CONFINED, QUICK, THOROUGH, loose_bound
from .polynomial import Coordinates, NotPolynomial, fit
from .polynomial_error import MOST_JOINTS, ErrorPolynomials, error_polynomials
from .refine import uphill, uphill_in_region, wander_in_region
from .workspace import RegionCells, Workspace, climbing_bounds, joint_box, region_cells, sample, spread, wrapped

DEFAULT_GAP = 1e-4
"""Relative gap of the certificate."""
_DISTINCT, _MOST_POSES = 0.05, 12
"""Poses of one load case nearer to each other than this (rad or m) count once, and so many are shown."""
_LOOKED_AT = 64
_FARTHEST = 1e6
"""An error of so many reaches says that a figure is wrong, not that an arm is bad."""
_SAMPLED = 4
"""Samples of poses that are cached: designs of the same lengths have the same ones."""
_SAME_TURN = 1e-9
"""Errors that differ by less than this share are the same a turn further."""
_MOST_CELLS = 2_000_000
_FEW_JOINTS, _FEW_CELLS = 3, 20_000
"""Cells of so few joints are looked at before another kind of bound is tried: some hundredths of a second."""
_MOST_CONFINED = 6
"""Joints that move, up to which poses of a box or path have a bound: all of them count there."""
_MOST_REGION_CELLS = 500_000
"""A path is a thin set: its cells are dropped slowly, and beyond this many the bound stands as it is."""


@dataclass(frozen=True)
class WorstPose:
    """A pose with its error (m): joint coordinates q, load case (from 0), error vector, and where the play stands."""

    q: tuple[float, ...]
    load_case: int
    error: float
    vector: tuple[float, float, float]
    signs: tuple[float, ...]
    shifts: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class WorstCase:
    """The worst position error (m) over a workspace, its local maxima (worst first), and a bound that no pose exceeds.

    `upper_bound` is None where none is known; `certified` says whether it lies within the gap asked for.
    """

    error: float
    upper_bound: float | None
    certified: bool
    poses: tuple[WorstPose, ...]


class WorstSearch:
    """Searches a workspace for the worst pose of a design, again and again as the design changes.

    What does not change with the design is kept from search to search.
    """

    def __init__(self, model: ErrorModel, workspace: Workspace, *, gap: float = DEFAULT_GAP, scan: int = 4096) -> None:
        """`gap`: relative, of the certificate; `scan`: poses looked at where no polynomial serves."""
        self.model, self.workspace, self.gap, self.scan = model, workspace, gap, scan
        self.arm = model.arm
        self.lower, self.upper = joint_box(self.arm, workspace)
        self._climbing = climbing_bounds(self.arm, self.lower, self.upper)
        self._widen_where_turns_differ()
        self._coordinates = Coordinates(
            tuple(joint.revolute for joint in self.arm.joints),
            tuple(zip(self.lower.tolist(), self.upper.tolist(), strict=True)),
        )
        self._matter: dict[int, tuple[int, ...]] = {}
        self._sampled: dict[tuple[bytes, int, int], Array] = {}

    def _widen_where_turns_differ(self) -> None:
        """Keep the whole range of a joint that turns once or more, where the error is not the same a turn further."""
        self._turned = np.zeros(self.arm.size, dtype=bool)
        ranges = self.workspace.ranges or tuple(joint.range for joint in self.arm.joints)
        for index, (joint, (low, high)) in enumerate(zip(self.arm.joints, ranges, strict=True)):
            if joint.revolute and high - low >= 2.0 * math.pi * (1.0 - 1e-12) and self._differs_by_turns(index):
                self.lower[index], self.upper[index] = low, high
                self._climbing[0][index], self._climbing[1][index] = low, high
                self._turned[index] = True

    def _differs_by_turns(self, index: int) -> bool:
        """Whether a turn more of a joint changes the error; links that hardly bend, for that cannot depend on it."""
        p = np.tile([1e9 if "rigidity" in name else 1.0 for name in BEAM_FIELDS], self.arm.size)
        p = np.concatenate([p, as_it_is(self.arm.size)]) if self.model.drives else p
        q = spread(self.lower, self.upper, 16)
        further = q.copy()
        further[:, index] += 2.0 * math.pi
        for case in self.model.cases:
            here, there = case.arrays(q, p), case.arrays(further, p)
            for one, other in ((here.vector, there.vector), (here.intervals, there.intervals)):
                if one.size and np.abs(one - other).max() > _SAME_TURN * max(float(np.abs(one).max()), 1e-12):
                    return True
        return False

    def _in_range(self, q: Array) -> Array:
        """Poses whose full-circle joints are brought back into their range by whole turns."""
        back = wrapped(self.arm, q, self.lower, self.upper)
        back[..., self._turned] = q[..., self._turned]
        return back

    def worst(
        self, p: Array, *, certify: bool = True, extra: Array | None = None, certify_up_to: float = math.inf
    ) -> WorstCase:
        """The worst case of a design p (see `arm.errors.model.beam_values`); `extra` (N, n) are poses worth starting
        from. An error above `certify_up_to` (m) is not worth a certificate.

        Raises `Unreachable` where the workspace holds points that the arm cannot reach.
        """
        if self.workspace.kind == "poses":
            return self._listed(p)
        polynomials = self._polynomials(p)
        starts = self.poses(p, 64 * 2**self.arm.size if polynomials is not None else self.scan)
        if extra is not None and len(extra) and self.workspace.kind == "joints":
            starts = np.vstack([starts, np.clip(extra, self.lower, self.upper)])
        self._refuse_what_is_not_finite(p, starts[:_LOOKED_AT])
        if polynomials is None:
            worst = self._scanned(p, starts)
            return self._bounded(p, worst) if certify and worst.error <= certify_up_to else worst
        return self._climbed_and_certified(p, polynomials, starts, certify_up_to if certify else -math.inf)

    def _listed(self, p: Array) -> WorstCase:
        """The worst of the poses that the workspace lists, each of which is looked at."""
        q = self.poses(p, len(self.workspace.poses))
        self._refuse_what_is_not_finite(p, q)
        poses = [pose for case in range(len(self.model.cases)) for pose in self.worst_poses_at(q, p, case)]
        distinct_poses = distinct(poses)
        # Discs askew to each other are climbed over, and a quantile of random play is that of its draws.
        climbed = (
            not self.model.planar and self.arm.play == "worst" and any(len(case.radii) for case in self.model.cases)
        )
        sure = not climbed and self.arm.play != "statistical"
        return WorstCase(distinct_poses[0].error, distinct_poses[0].error if sure else None, sure, distinct_poses)

    def scanned(self, p: Array) -> float:
        """The worst error (m) of a design p at poses spread over the workspace, none climbed from: somewhat less than
        `worst` finds. Raises as that does."""
        q = self.poses(p, self.scan)
        self._refuse_what_is_not_finite(p, q[:_LOOKED_AT])
        return max(float(self.errors(q, p, case).error.max()) for case in range(len(self.model.cases)))

    def _refuse_what_is_not_finite(self, p: Array, q: Array) -> None:
        """Raise `NoAnswer` for a design that gives by no number at all, or by a million times its length."""
        longest = _FARTHEST * max(sum(self.arm.lengths), 1e-3)
        for case in self.model.cases:
            if not float(np.abs(case.arrays(q, p).vector).max(initial=0.0)) <= longest:
                message = f"the tip of {self.arm.name!r} would be further off than {_FARTHEST:.0e} times its reach"
                raise NoAnswer(f"{message}; look at the sections, the stiffnesses and the loads")

    def poses(self, p: Array, count: int, seed: int = 1) -> Array:
        """About `count` poses (N, n) spread over the workspace of a design p."""
        lengths = p[: len(BEAM_FIELDS) * self.arm.size : len(BEAM_FIELDS)]
        key = (lengths.tobytes(), min(count, self.scan), seed)
        if key not in self._sampled:
            if len(self._sampled) >= _SAMPLED:
                del self._sampled[next(iter(self._sampled))]
            self._sampled[key] = sample(
                self.workspace, lambda q: self.motion(q, p), self.lower, self.upper, key[1], seed
            )
            self._sampled[key].flags.writeable = False
        return self._sampled[key]

    def tip(self, q: Array, p: Array) -> Array:
        """Nominal tips (N, 3) at poses q for a design p, m."""
        return np.ascontiguousarray(self.model.tip(np.atleast_2d(q), p)[0])

    def motion(self, q: Array, p: Array) -> tuple[Array, Array]:
        """Nominal tips (N, 3) at poses q (N, n) for a design p, m, and their slopes (N, 3, n)."""
        tips, slopes = self.model.motion(q, p)
        return tips, slopes.reshape(len(q), self.arm.size, 3).transpose(0, 2, 1)

    def case_at(self, q: Array, p: Array, load_case: int) -> int:
        """Which of the model's cases tells of a pose q (n,) under a load case."""
        del q, p
        return load_case

    def load_case(self, case: int) -> int:
        """The load case of one of the model's cases."""
        return case

    def of_loads(self, worst_case: WorstCase) -> WorstCase:
        """A worst case with the load cases by their numbers."""
        return worst_case

    def errors(self, q: Array, p: Array, case: int) -> PlayedError:
        """The error at poses q (N, n) in a load case, with the play where the arm's mode puts it."""
        model = self.model.cases[case]
        arrays = model.arrays(np.atleast_2d(q), p)
        planar = self.model.planar
        return played(arrays, model.radii, self.arm.play, planar=planar, statistics=self.arm.statistics)

    def worst_poses_at(self, q: Array, p: Array, case: int) -> list[WorstPose]:
        """The poses q (N, n) with their errors in a load case."""
        result, shown = self.errors(q, p, case), completed(self.arm, q)
        moving = self.model.cases[case].load.moving
        if moving is not None:  # it is of its own pose, whatever is asked for
            shown = np.tile(np.array(moving.q, dtype=float), (len(q), 1))
        return [
            WorstPose(
                tuple(shown[k].tolist()),
                case,
                float(result.error[k]),
                _triple(result.vector[k]),
                tuple(result.signs[k].tolist()),
                tuple(_triple(shift) for shift in result.shifts[k]),
            )
            for k in range(len(q))
        ]

    # ---- polynomials

    def _polynomials(self, p: Array) -> list[ErrorPolynomials] | None:
        confined = self.workspace.kind != "joints"
        if confined and len(self._coordinates.moving) > MOST_JOINTS:
            return None
        try:
            polynomials = [
                error_polynomials(
                    case,
                    number,
                    p,
                    self._coordinates,
                    self.arm.play,
                    planar=self.model.planar,
                    confined=confined,
                    matter=self._matter.get(number),
                )
                for number, case in enumerate(self.model.cases)
            ]
        except NotPolynomial:
            return None
        self._matter = {polynomial.case: polynomial.joints for polynomial in polynomials}
        return polynomials

    def _climbed_and_certified(
        self, p: Array, polynomials: list[ErrorPolynomials], starts: Array, certify_up_to: float
    ) -> WorstCase:
        cells = self._cells(p)
        matter = sorted({joint for polynomial in polynomials for joint in polynomial.joints})
        poses = [pose for polynomial in polynomials for pose in self._climbed(p, polynomial, starts)]
        worst = max(poses, key=lambda pose: pose.error)
        if worst.error > certify_up_to:
            return WorstCase(worst.error, None, False, distinct(poses, matter))
        bound = max(self._bound(p, polynomial, poses, cells) for polynomial in polynomials)
        worst = max(poses, key=lambda pose: pose.error)
        bound = max(bound, worst.error)
        return WorstCase(worst.error, bound, self._closed(worst.error, bound), distinct(poses, matter))

    def _bound(self, p: Array, of: ErrorPolynomials, poses: list[WorstPose], cells: RegionCells | None) -> float:
        """What no pose of a load case exceeds, m; a worse pose than those known is added to them."""
        worst = max(pose.error for pose in poses)
        plain = cells is None and of.seatings is None
        few = plain and of.exact and len(of.joints) <= _FEW_JOINTS
        certified = self._certify(of, worst, cells, _FEW_CELLS) if few else None
        if certified is None or not certified.complete:
            quick = self._loose_bound(p, of.case, worst, QUICK if of.exact else THOROUGH) if plain else None
            if quick is not None and (self._closed(worst, quick) or not of.exact):
                return quick
            certified = self._certify(of, worst, cells, _MOST_CELLS if cells is None else _MOST_REGION_CELLS)
        if certified.function >= 0:
            # The certificate knows a worse pose than the climbs found: it counts.
            poses += self.worst_poses_at(self._whole(of, certified.point)[None], p, of.case)
            worst = max(pose.error for pose in poses)
        bound = math.sqrt(max(certified.bound, 0.0)) + of.radius
        if cells is None and not self._closed(worst, bound):
            closer = self._loose_bound(p, of.case, worst, THOROUGH)
            bound = bound if closer is None else min(bound, closer)
        return bound

    def _cells(self, p: Array) -> RegionCells | None:
        """What tells which cells of all moving joints reach a box or path; None for joint ranges."""
        if self.workspace.kind == "joints":
            return None
        moving = self._coordinates.moving
        tips = fit(lambda q: self.tip(self._coordinates.placed(moving, q), p), self._coordinates.of(moving), degree=1)
        return region_cells(self.workspace, tips)

    def _closed(self, error: float, bound: float) -> bool:
        return bound <= error * (1.0 + self.gap) * (1.0 + 1e-9) + 1e-15

    def _bounded(self, p: Array, worst: WorstCase) -> WorstCase:
        """A worst case from a scan with a bound, where one can be had."""
        confined = self.workspace.kind != "joints"
        if self.arm.play == "statistical" or (confined and len(self._coordinates.moving) > _MOST_CONFINED):
            return worst
        if confined and self.gap < DEFAULT_GAP:
            return worst  # who asks for that has no use for a bound that is loose by tens of per cent
        cells, count = self._cells(p), len(self.model.cases)
        effort = CONFINED // count if confined else THOROUGH
        bounds = [self._loose_bound(p, case, worst.error, effort, cells) for case in range(count)]
        bound = None if None in bounds else max([worst.error, *(item for item in bounds if item is not None)])
        return replace(worst, upper_bound=bound, certified=bound is not None and self._closed(worst.error, bound))

    def _loose_bound(
        self, p: Array, case: int, known: float, effort: int, cells: RegionCells | None = None
    ) -> float | None:
        model, planar = self.model.cases[case], self.model.planar
        return loose_bound(model, p, self._coordinates, known, planar=planar, gap=self.gap, effort=effort, cells=cells)

    def _climbed(self, p: Array, polynomials: ErrorPolynomials, starts: Array) -> list[WorstPose]:
        functions = len(polynomials.weights)
        values = polynomials.values(starts)
        per_function = 12 if functions <= 8 else 4
        order = np.argsort(-values, axis=0, kind="stable")[:per_function]
        which = np.tile(np.arange(functions, dtype=np.intp), len(order))
        counts = np.isfinite(values[order.ravel(), which])
        order, which = order.ravel()[counts], which[counts]
        q = starts[order].copy()
        joints = list(polynomials.joints)
        scaled = self._coordinates.scaled
        if self.workspace.kind == "joints":
            lower, upper = scaled(self._climbing[0])[joints], scaled(self._climbing[1])[joints]
            x = scaled(self._coordinates.placed(joints, q[:, joints]))
            x[:, joints], _ = climb(lambda at, rows: polynomials.terms.at(at, which[rows]), x[:, joints], lower, upper)
            q = self._in_range(self._coordinates.unscaled(x))
            error = self.errors(q, p, polynomials.case).error
            apart = _worst_apart(q[:, joints], error, np.zeros(len(q), dtype=np.intp))
            poses = self.worst_poses_at(q[apart], p, polynomials.case)
        else:
            best = np.argsort(-values[order, which], kind="stable")[:16]
            q = np.array([self._climb_in_region(p, polynomials, int(which[k]), q[k]) for k in best])
            poses = self.worst_poses_at(q, p, polynomials.case)
        if not polynomials.exact or polynomials.seatings is not None:
            near = np.array([pose.q for pose in distinct(poses)][:6])
            if not polynomials.exact:
                # Discs across different normals may favour poses that the polynomials alone do not.
                near = np.vstack([near, starts[_apart(starts, self.errors(starts, p, polynomials.case).error, 6)]])
            poses += self._refined(p, polynomials.case, near)
        return poses

    def _climb_in_region(self, p: Array, polynomials: ErrorPolynomials, which: int, start: Array) -> Array:
        index, joints = np.array([which], dtype=np.intp), list(polynomials.joints)
        slope = np.array(
            [
                1.0 if joint.revolute else 2.0 / max(float(high - low), 1e-12)
                for joint, low, high in zip(self.arm.joints, self.lower, self.upper, strict=True)
            ]
        )

        def value_and_gradient(q: Array) -> tuple[float, Array]:
            x = self._coordinates.scaled(q[None])[:, joints]
            value, derivatives, _ = polynomials.terms.at(x, index, order=1)
            gradient = np.zeros(self.arm.size)
            gradient[joints] = derivatives[0]
            return float(value[0]), gradient * slope

        return uphill_in_region(
            value_and_gradient, start, self.workspace, lambda q: self.motion(q, p), (self.lower, self.upper)
        )

    def _certify(
        self, polynomials: ErrorPolynomials, known: float, cells: RegionCells | None, most_cells: int
    ) -> Certified:
        joints = list(polynomials.joints)
        lower = self._coordinates.scaled(self.lower)[joints]
        upper = self._coordinates.scaled(self.upper)[joints]
        filtered = polynomials.seatings is not None or cells is not None

        def keep(centers: Array, half: Array, which: NDArray[np.intp]) -> NDArray[np.bool_]:
            inside = polynomials.may_be_seated(centers, half, which)
            return inside & cells.keep(centers, half) if cells is not None else inside

        def admissible(centers: Array, half: Array, which: NDArray[np.intp]) -> NDArray[np.bool_]:
            inside = polynomials.may_be_seated(centers, np.zeros_like(half), which)
            return inside & cells.holds(centers) if cells is not None else inside

        return maximise(
            polynomials.terms,
            lower,
            upper,
            gap=2.0 * self.gap,
            incumbent=max(known - polynomials.radius, 0.0) ** 2,
            most_cells=most_cells,
            keep=keep if filtered else None,
            admissible=admissible if filtered else None,
        )

    def _whole(self, polynomials: ErrorPolynomials, point: Array) -> Array:
        """A certificate's point as joint coordinates; joints that do not matter stand mid-range."""
        joints = self._coordinates.of(polynomials.joints)
        return self._coordinates.placed(polynomials.joints, joints.unscaled(point[None]))[0]

    # ---- scans

    def _scanned(self, p: Array, starts: Array) -> WorstCase:
        poses: list[WorstPose] = []
        for case in range(len(self.model.cases)):
            errors = self.errors(starts, p, case).error
            chosen = starts[_apart(starts, errors, 16)]
            poses += self.worst_poses_at(chosen, p, case)
            poses += self._refined(p, case, chosen)
        distinct_poses = distinct(poses)
        return WorstCase(distinct_poses[0].error, None, False, distinct_poses)

    def _refined(self, p: Array, case: int, starts: Array) -> list[WorstPose]:
        def error(q: Array) -> Array:
            return self.errors(q, p, case).error

        if self.workspace.kind == "joints":
            reached = self._in_range(uphill(error, starts, self._climbing))
        else:
            bounds = (self.lower, self.upper)
            reached = wander_in_region(error, starts, self.workspace, lambda q: self.motion(q, p), bounds)
        return self.worst_poses_at(reached, p, case)


def _triple(row: Array) -> tuple[float, float, float]:
    return (float(row[0]), float(row[1]), float(row[2]))


def _apart(q: Array, values: Array, count: int) -> NDArray[np.intp]:
    """Indices of the best values whose poses lie apart."""
    chosen: list[int] = []
    for index in np.argsort(-values):
        if all(np.abs(q[index] - q[other]).max() > 0.2 for other in chosen):
            chosen.append(int(index))
        if len(chosen) == count:
            break
    return np.array(chosen, dtype=np.intp)


def distinct(poses: list[WorstPose], joints: Sequence[int] | None = None) -> tuple[WorstPose, ...]:
    """The worst first, near repeats left out; `joints` are those (from 0) that count for that, all by default."""
    if not poses:
        return ()
    q, case = np.array([pose.q for pose in poses]), np.array([pose.load_case for pose in poses])
    coordinates = q if joints is None else q[:, list(joints)]
    return tuple(poses[k] for k in _worst_apart(coordinates, np.array([pose.error for pose in poses]), case))


def _worst_apart(q: Array, errors: Array, case: NDArray[np.intp]) -> list[int]:
    """Indices of the worst of some poses q (N, n) first, at most `_MOST_POSES`, near repeats in one load case left
    out."""
    left = np.argsort(-errors, kind="stable")
    chosen: list[int] = []
    while len(left) and len(chosen) < _MOST_POSES:
        first = left[0]
        chosen.append(int(first))
        apart = np.abs(q[left] - q[first]).max(axis=1, initial=0.0) > _DISTINCT
        left = left[apart | (case[left] != case[first])]
        left = left[left != first]
    return chosen
