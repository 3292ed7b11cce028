"""A subset of candidates fitted to a recording: sizes, their scatter, and whether they are physically possible."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh, get_lapack_funcs
from scipy.special import stdtrit

from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.elastic.joint_compliance import file_compliance
from linkwright.core.arm.effects.loads.link_mass import LINK_MASS, mass_declared
from linkwright.core.diagnose.patterns.library import Candidate, Family, of_single_numbers, parameter_of
from linkwright.core.diagnose.patterns.pool import inverse_root
from linkwright.core.diagnose.patterns.unknown_weights import only_products
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.diagnose.rules.fitting_rules import FittingRules
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array

from .prepare import Prepared


@dataclass(frozen=True)
class Fit:
    """Groups fitted together: for each its sizes (SI), their standard errors (infinite where the data do not tell one
    size from another), the residual sum of squares in whitened units, and the degrees of freedom left."""

    members: tuple[int, ...]
    sizes: tuple[Array, ...]
    errors: tuple[Array, ...]
    rss: float
    freedom: int

    @property
    def unit(self) -> float:
        """The scatter of whitened residuals."""
        return float(np.sqrt(self.rss / max(self.freedom, 1)))


def fit(prepared: Prepared, members: Sequence[int]) -> Fit:
    """Least squares of some groups beside the nuisances."""
    pool, vector = prepared.pool, prepared.vector
    columns = pool.columns(members)
    against = prepared.products.against[columns]
    root = inverse_root(pool.among(columns))
    coefficients = root @ (root.T @ against)
    rss = max(prepared.products.rss - float(against @ coefficients), 0.0)
    freedom = len(vector) - pool.nuisance.shape[1] - len(columns)
    variance = rss / max(freedom, 1)
    sizes: list[Array] = []
    errors: list[Array] = []
    at = 0
    for member in members:
        group = pool.groups[member]
        part = slice(at, at + group.rank)
        at += group.rank
        sizes.append(group.back @ coefficients[part])
        error = np.sqrt(np.sum((group.back @ root[part]) ** 2, axis=1) * variance)
        # A size that the columns do not tell from another has no error of its own.
        errors.append(np.where(group.determined, error, np.inf))
    return Fit(tuple(members), tuple(sizes), tuple(errors), rss, freedom)


def displacement(prepared: Prepared, fitted: Fit, members: Sequence[int] | None = None) -> Array:
    """What some groups of a fit (all by default) add to the model, (N, C) in m and rad."""
    total = np.zeros(prepared.observed.residual.shape)
    for member, sizes in zip(fitted.members, fitted.sizes, strict=True):
        if members is None or member in members:
            total += prepared.columns[member] @ sizes
    return total


def remaining(prepared: Prepared, fitted: Fit) -> Array:
    """The residual (N, C), m and rad, after a fit, nuisances fitted too."""
    return beyond_nuisances(prepared, prepared.observed.residual - displacement(prepared, fitted))


def beyond_nuisances(prepared: Prepared, columns: Array) -> Array:
    """What the nuisances leave of displacements (N, C), m and rad."""
    if prepared.beside.shape[2] == 0:
        return columns
    design = prepared.observed.whitened(prepared.beside)
    return columns - prepared.beside @ solved(design, prepared.observed.whitened(columns))


def impossible(prepared: Prepared, fitted: Fit) -> str | None:
    """Why a fit cannot be physics: the first size that lies beyond its bounds, as a clause; None where all can be."""
    common = {prepared.pool.groups[m].candidate.family: s for m, s in zip(fitted.members, fitted.sizes, strict=True)}
    for member, sizes, errors in zip(fitted.members, fitted.sizes, fitted.errors, strict=True):
        group = prepared.pool.groups[member]
        if group.candidate.only is not None:
            whole = sizes + _of_all(common, group.candidate, sizes)
            reason = why_impossible(prepared, replace(group.candidate, only=None), whole, errors, 0.0)
            if reason is not None:
                return reason
        moved = group.forward @ sizes
        slopes, turned = sizes.tolist(), group.candidate.from_slopes
        spread = zip(turned((sizes - errors).tolist()), turned((sizes + errors).tolist()), strict=True)
        about = np.array([0.5 * abs(high - low) for low, high in spread])
        reason = why_impossible(prepared, group.candidate, np.array(turned(slopes)), about, float(moved @ moved))
        if reason is not None:
            return reason
    return None


def left_of_a_drive(candidate: Candidate, name: str) -> bool:
    """Whether a size is what a drive of the arm file gives more or less under high load."""
    if candidate.share or candidate.outside:
        return False
    effect = EFFECTS[candidate.effect]
    parameter = parameter_of(effect, name)
    return effect.place == "joint" and parameter.kind == "compliance" and parameter.lower < 0.0


def _of_all(common: Mapping[Family, Array], candidate: Candidate, sizes: Array) -> Array:
    """The sizes that a candidate of one recording has in all of them, zero where none was found."""
    common_term = common.get(replace(candidate, only=None).family)
    return common_term if common_term is not None and common_term.shape == sizes.shape else np.zeros(sizes.shape)


def why_impossible(prepared: Prepared, candidate: Candidate, sizes: Array, errors: Array, moved: float) -> str | None:
    """Why sizes (SI) with these standard errors cannot be physics, as a clause; None where they can. `moved` is the sum
    of squares of what they move beyond the nuisances, in whitened units."""
    rules = prepared.observed.rules
    if moved > rules.fitting.cancelling * float(prepared.vector @ prepared.vector):
        return "only a displacement far larger than the mismatch would fit, balanced against others"
    if len(sizes) != len(candidate.sizes):
        return None
    for name, value, error in zip(candidate.sizes, sizes.tolist(), errors.tolist(), strict=False):
        low, high = bounds(candidate, name, prepared)
        width = high - low
        if value < low - rules.residual.beyond_chance * error or value < low - width:
            return f"only a {'negative size' if low == 0.0 else 'size below what is possible'} would fit"
        if value > high + rules.residual.beyond_chance * error or value > high + width:
            return "only a size beyond what is possible would fit"
        if value > _most_on_a_link(candidate, name, prepared):
            return "only more than hangs on a link of that mass would fit"
    return None


def unlikely(prepared: Prepared, fitted: Fit) -> float:
    """By how much sizes beyond the usual make a fit less likely, in units of the criterion: minus twice the log of a
    density that is even up to the largest usual sizes and has a Cauchy's tail beyond, over that of usual ones. Forms,
    shares and products with unknown weights have no usual size; nor have zeros and lengths, frames and tools, which a
    file may have wrong by any amount."""
    total = 0.0
    for member, sizes in zip(fitted.members, fitted.sizes, strict=True):
        group = prepared.pool.groups[member]
        candidate = group.candidate
        if candidate.outside or candidate.share or len(sizes) != len(candidate.sizes):
            continue
        effect = EFFECTS[candidate.effect]
        if of_single_numbers(effect) or effect.recording.free_with is not None:
            continue
        fitted_sizes = np.array(candidate.from_slopes(sizes.tolist()))
        times = float(np.sum((fitted_sizes / group.usual) ** 2))
        total += (1.0 + len(sizes)) * math.log(max(1.0, times))
    return total


def bounds(candidate: Candidate, name: str, prepared: Prepared) -> tuple[float, float]:
    """The physical bounds of a candidate's size, SI."""
    if candidate.share:
        return 0.0, 3.0
    parameter = parameter_of(EFFECTS[candidate.effect], name)
    if candidate.only is not None:
        # What a recording has more than the others may be less than nothing; the sum is looked at in `impossible`.
        most = max(abs(parameter.lower), abs(parameter.upper))
        return -most, most
    if only_products(prepared.observed, EFFECTS[candidate.effect], candidate.at):
        return -np.inf, np.inf
    if candidate.of_drives or left_of_a_drive(candidate, name):
        # Added to what the arm file gives the drive, the whole may not become negative: none turns against its load.
        return -file_compliance(prepared.observed.arm, candidate.at[0]), parameter.upper
    upper = min(parameter.upper, _most_expansion(candidate, name, prepared.observed))
    of_a_link = parameter.kind == "mass" and EFFECTS[candidate.effect].place == "link"
    kept = prepared.observed.rules.fitting.lightest if of_a_link else 0.0
    return max(parameter.lower, -(1.0 - kept) * _in_the_file(candidate, name, prepared.observed)), upper


def _most_expansion(candidate: Candidate, name: str, observed: Observed) -> float:
    """The most that links may expand by (1/K) whose material says by how much they do; infinite where one does not, and
    for sizes that are no expansion."""
    effect = EFFECTS[candidate.effect]
    parameter = parameter_of(effect, name)
    if parameter.kind != "thermal_expansion" or effect.place != "link" or not candidate.at:
        return np.inf
    declared = [observed.state.links[index].beam.thermal_expansion for index in candidate.at]
    most = max(np.inf if item is None else float(np.max(item)) for item in declared)
    return max(observed.rules.fitting.usual * most, 2.0 * max(parameter.typical))


def _most_on_a_link(candidate: Candidate, name: str, prepared: Prepared) -> float:
    """The most that may hang on a link or at the tip beyond what the arm file says is there, kg: a usual extra and as
    much again, or at the tip what an arm of that weight lifts at most, and what may hang on the last link; infinite
    where the file leaves the mass open, and for sizes that are no mass."""
    effect = EFFECTS[candidate.effect]
    if candidate.share or effect.link.declared is None:
        return np.inf
    parameter = parameter_of(effect, name)
    if parameter.kind != "mass":
        return np.inf
    most = parameter.typical[1] + _in_the_file(candidate, name, prepared.observed)
    if effect.place == "link":
        return most
    arm, beams = prepared.observed.arm_given, [link.beam for link in prepared.observed.state.links]
    last = LINK_MASS.sizes[0].typical[1] + mass_declared(arm, beams, arm.size - 1)
    # The lightest arms for what they carry lift their weight (A. Albu-Schaeffer et al., Industrial Robot 34 (2007)
    # 376: a load-to-weight ratio of 1:1).
    return max(most, last, _whole_mass(prepared.observed))


def _whole_mass(observed: Observed) -> float:
    """What all links of an arm weigh by its file, kg; infinite where one's mass is left open."""
    beams = [link.beam for link in observed.state.links]
    return sum(mass_declared(observed.arm_given, beams, index) for index in range(observed.arm_given.size))


def _in_the_file(candidate: Candidate, name: str, observed: Observed) -> float:
    """What the arm file gives of a size already, the least over the candidate's places; infinite where nobody knows.
    Where payloads were recorded, the least of them is at the tip, and not the file's."""
    effect, arm, carried = EFFECTS[candidate.effect], observed.arm_given, observed.recording.payload_mass
    if effect.link.declared is None or name != effect.sizes[0].name:
        return np.inf
    if carried is not None:
        arm = replace(arm, payload=replace(arm.payload, mass=float(np.min(carried))))
    beams = [link.beam for link in observed.state.links]
    entries = [entry for entry in arm.effects if entry.effect == effect.id]

    def whole(index: int) -> float:
        assert effect.link.declared is not None
        entries_here = (entry for entry in entries if not entry.at or index + 1 in entry.at)
        return effect.link.declared(arm, beams, index) + sum(entry.parameters.get(name, 0.0) for entry in entries_here)

    return min(whole(index) for index in candidate.at or (0,))


def typical(candidate: Candidate, sizes: Array, *, rules: FittingRules = RULES.fitting) -> bool:
    """Whether the largest of the sizes is of a usual magnitude: a third of the least to three times the most."""
    if candidate.outside or candidate.share:
        return True
    effect = EFFECTS[candidate.effect]
    for name, value in zip(candidate.sizes, sizes.tolist(), strict=False):
        low, high = sorted(abs(limit) for limit in parameter_of(effect, name).typical)
        if low / rules.usual <= abs(value) <= rules.usual * high:
            return True
    return False


def solved(design: Array, target: Array) -> Array:
    """Least squares by the normal equations of scaled columns, of one target (n,) or several (n, k); directions below
    1e-6 of the largest stay at zero."""
    gram = design.T @ design  # scaled afterwards: a copy of a long recording's design is a hundred megabytes
    size = np.sqrt(np.diag(gram))
    size = np.where(size > 0.0, size, 1.0)
    scale = np.outer(size, size)
    inverse = np.linalg.pinv(gram / scale, rcond=1e-12, hermitian=True) / scale
    first = inverse @ (design.T @ target)
    return first + inverse @ (design.T @ (target - design @ first))  # refined once


def normal_solution(gram: Array, against: Array) -> Array:
    """The solution of normal equations, whose directions below 1e-12 of the largest stay at zero."""
    factored, condition, by_factor = get_lapack_funcs(("potrf", "pocon", "potrs"), (gram,))
    factor, failed = factored(gram, lower=True)
    # Where no direction is near that, a triangle says the same in a tenth of the time.
    if not failed and condition(factor, np.linalg.norm(gram, 1), uplo="L")[0] > 1e-11:
        return by_factor(factor, against, lower=True)[0]
    # Not numpy's: divide and conquer does not always converge where many eigenvalues are nearly one.
    values, vectors = eigh(gram, driver="evr")
    good = values > 1e-12 * values[-1]
    return (vectors[:, good] / values[good]) @ (vectors[:, good].T @ against)


def t_quantile(freedom: int) -> float:
    """Student's factor for a two-sided 95 % interval."""
    return float(stdtrit(max(freedom, 1), 0.975))
