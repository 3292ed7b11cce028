"""What causes too small to be named make of a remainder, and a recording with room for them.

A machine has more causes than are found. Each of those that are not may be far below what can be told, and all of them
together well above the noise: then readings of one pose refute the names as the whole answer, though these are right.
So beside what is named every other candidate of the library is taken to move the tip by a random amount of one
variance, as for intervals (see `unnamed`), with the noise as loud as readings of a visit say. How large that amount is
the likelihood tells, up to what is still small. What is left, seen through the covariance of both (generalised least
squares: A. C. Aitken, Proc. R. Soc. Edinb. 55 (1936) 42, doi:10.1017/S0370164600014346), is noise of one variance if
small causes are all there is; physics that the library lacks is not in their span, or too large for them, and stays.
Their likeliest displacement is the best linear unbiased prediction (G. K. Robinson, Statistical Science 6 (1991) 15,
doi:10.1214/ss/1177011926), which must foretell parts of the workspace held out like any other.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.diagnose.fitting.fit import fit, solved
from linkwright.core.diagnose.fitting.prepare import Prepared
from linkwright.core.diagnose.patterns.pool import orthonormal
from linkwright.core.sections.numeric import Array

from .unnamed import others_of

_SEEN = 1e-3
"""Directions in which small causes move the tip by less than this share of the noise's variance tell nothing."""
_PRODUCTS = 1e-14
"""Of the largest, what of products' eigenvalues is rounding."""
_STEPS = 76
"""Sizes at which the likelihood is looked at."""


@dataclass(frozen=True)
class SmallCauses:
    """Causes beside what is named: `directions` (n, K), orthonormal, in which they move the whitened observations, each
    by `variance` (K,) times the noise's own, `noise`; `moved` (N, C, K) is the displacement of one unit of each
    direction beyond nuisances and names, m and rad, `coordinates` (K,) what the remainder holds of each."""

    directions: Array
    variance: Array
    noise: float
    moved: Array
    coordinates: Array

    @property
    def shrunk(self) -> Array:
        """What a value in each direction (K,) comes to where their spread is that of the noise: by so much less."""
        return 1.0 / np.sqrt(1.0 + self.variance)

    @property
    def beyond_noise(self) -> Array:
        """What to take off the remainder (N, C), m and rad, so that it scatters like noise alone if small causes are
        all there is beside it."""
        return self.moved @ ((1.0 - self.shrunk) * self.coordinates)

    @property
    def likeliest(self) -> Array:
        """How far they move the tip, most likely, (N, C) in m and rad."""
        return self.moved @ ((1.0 - self.shrunk**2) * self.coordinates)

    @property
    def columns(self) -> Array:
        """Displacements (N, C, K) of which each has a size of the noise's deviation, beforehand."""
        return self.moved * np.sqrt(self.variance)

    def drawn(self, rng: np.random.Generator, count: int) -> Array:
        """So many draws (N, C, count), m and rad, of what such causes do."""
        sizes = np.sqrt(self.noise * self.variance)[:, None] * rng.standard_normal((len(self.variance), count))
        return self.moved @ sizes


def small_causes(
    prepared: Prepared, members: Sequence[int], rivals: Collection[int], noise: float
) -> SmallCauses | None:
    """The small causes beside some groups that the remainder of their fit speaks for; `rivals` are other names for
    them. `noise` is the variance of the whitened noise. None where the remainder speaks for none, or is so far above
    the noise that its cause is not small; a long recording tells small causes one by one."""
    at, weight, groups = others_of(prepared, members, rivals)
    most = prepared.observed.rules.fitting.far_above**2 * noise * len(prepared.vector)
    long = prepared.observed.rows > prepared.observed.rules.search.long
    if long or not len(at) or noise <= 0.0 or fit(prepared, members).rss > most:
        return None
    u, s, vt, coordinates = _beside(prepared, members, at, weight)
    size, _ = _likeliest_size(prepared, s, coordinates, noise)
    variance = len(prepared.vector) * (size * s) ** 2
    seen = variance > _SEEN
    if not seen.any():
        return None
    moved = _displacements(prepared, members, groups, (weight[:, None] * vt[seen].T) / s[seen])
    return SmallCauses(u[:, seen], variance[seen], noise, moved, coordinates[seen])


def with_room(prepared: Prepared, members: Sequence[int], *, least: float = 0.0) -> Prepared:
    """The same recording to be judged with room for small causes, where the remainder beside some groups speaks for
    them or each moves the tip by `least` times the noise's RMS anyhow: what is seen where they may move it counts by so
    much less."""
    at, weight, _ = others_of(prepared, members, ())
    noise = noise_of_visits(prepared)
    long = prepared.observed.rows > prepared.observed.rules.search.long
    if noise is None or noise <= 0.0 or long:
        return prepared
    size = least
    if len(at):
        _, s, _, coordinates = _beside(prepared, members, at, weight)
        likeliest, likelier = _likeliest_size(prepared, s, coordinates, noise)
        size = max(least, likeliest if likelier > prepared.observed.rules.search.confident else 0.0)
    if size == 0.0:
        return prepared
    pool = prepared.pool
    # Whichever names are judged, the other ones may be small causes beside them.
    at, weight, _ = others_of(prepared, (), ())
    u, s, _ = _directions(pool.basis[:, at] * weight)
    off = 1.0 - 1.0 / np.sqrt(1.0 + len(prepared.vector) * (size * s) ** 2)
    basis = pool.basis - u @ (off[:, None] * (u.T @ pool.basis))
    vector = prepared.vector - u @ (off * (u.T @ prepared.vector))
    return replace(prepared, vector=vector, pool=replace(pool, basis=basis, room=None))


def _beside(
    prepared: Prepared, members: Sequence[int], at: NDArray[np.int64], weight: Array
) -> tuple[Array, Array, Array, Array]:
    """The directions of some columns of the basis beside some groups (a singular value decomposition), and what the
    remainder holds of each."""
    pool = prepared.pool
    names = orthonormal(pool.basis[:, pool.columns(members)])
    patterns = pool.basis[:, at] * weight
    u, s, vt = _directions(patterns - names @ (names.T @ patterns))
    return u, s, vt, u.T @ (prepared.vector - names @ (names.T @ prepared.vector))


def _directions(patterns: Array) -> tuple[Array, Array, Array]:
    """The singular value decomposition of patterns (n, M) by way of the products of the shorter side, which is many
    times faster and good to 1e-8 of the largest: directions of less tell nothing."""
    wide = patterns.shape[1] > len(patterns)
    tall = patterns.T if wide else patterns
    values, short = np.linalg.eigh(tall.T @ tall)
    seen = values > _PRODUCTS * values[-1]
    s, short = np.sqrt(values[seen]), short[:, seen]
    long = (tall @ short) / s
    return (short, s, long.T) if wide else (long, s, short.T)


def _likeliest_size(prepared: Prepared, s: Array, coordinates: Array, noise: float) -> tuple[float, float]:
    """How far each family moves the tip (RMS, times the noise's), most likely, and twice the logarithm of how much more
    likely that is than not at all."""
    count = len(prepared.vector)
    sizes = np.linspace(0.0, prepared.observed.rules.fitting.largest_small, _STEPS)
    spread = 1.0 + count * (sizes[:, None] * s) ** 2
    unlikely = np.sum(np.log(spread), axis=1) + np.sum(coordinates**2 / spread, axis=1) / noise
    best = int(np.argmin(unlikely))
    return float(sizes[best]), float(unlikely[0] - unlikely[best])


def noise_of_visits(prepared: Prepared) -> float | None:
    """The variance of the whitened noise that readings of one visit differ by; None where too few were read again."""
    observed, visit = prepared.observed, prepared.visits
    values = prepared.vector.reshape(observed.rows, -1)
    count = np.bincount(visit)
    freedom = values.shape[1] * (len(visit) - len(count))
    if freedom < observed.rules.fitting.enough:
        return None
    means = np.stack([np.bincount(visit, weights=column) / count for column in values.T], axis=1)
    return float(np.sum((values - means[visit]) ** 2)) / freedom


def _displacements(prepared: Prepared, members: Sequence[int], groups: Sequence[int], sizes: Array) -> Array:
    """What coefficients (M, K) of the groups' bases move, beyond nuisances and members, (N, C, K) in m and rad."""
    moved, at = np.zeros((*prepared.observed.residual.shape, sizes.shape[1])), 0
    for number in groups:
        group = prepared.pool.groups[number]
        moved += prepared.columns[number] @ (group.back @ sizes[at : at + group.rank])
        at += group.rank
    beside = np.concatenate([prepared.beside, *(prepared.columns[m] for m in members)], axis=2)
    if beside.shape[2] == 0:
        return moved
    white = prepared.observed.whitened
    return moved - beside @ solved(white(beside), white(moved))
