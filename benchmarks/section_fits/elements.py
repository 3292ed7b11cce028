"""Torsion and flexure of sections made of axis-parallel blocks, with spectral elements.

The Saint-Venant problems (torsion, and flexure with its Poisson part) are solved on the symmetric half or quarter.
"""

from __future__ import annotations

import itertools

import numpy as np
import scipy.sparse as sp
from numpy.polynomial import legendre
from scipy.sparse.linalg import splu


def lobatto(order: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gauss-Lobatto-Legendre nodes, weights and differentiation matrix on [-1, 1]."""
    basis = np.zeros(order + 1)
    basis[-1] = 1.0
    inner = legendre.legroots(legendre.legder(basis))
    x = np.concatenate(([-1.0], inner, [1.0]))
    value = legendre.legval(x, basis)
    w = 2.0 / (order * (order + 1) * value**2)
    d = np.zeros((order + 1, order + 1))
    for i, j in itertools.product(range(order + 1), repeat=2):
        if i != j:
            d[i, j] = value[i] / (value[j] * (x[i] - x[j]))
    d[0, 0], d[-1, -1] = -order * (order + 1) / 4, order * (order + 1) / 4
    return x, w, d


ORDER = 6
NODES, WEIGHTS, DERIVATIVE = lobatto(ORDER)
MASS_1D = np.diag(WEIGHTS)
STIFF_1D = DERIVATIVE.T @ np.diag(WEIGHTS) @ DERIVATIVE
RATIO = 0.2


def graded(breaks: list[float], corners: set[int], size: float) -> np.ndarray:
    """Element boundaries over the breaks, refined geometrically towards the breaks that touch re-entrant
    corners."""
    out = [breaks[0]]
    for k, (low, high) in enumerate(itertools.pairwise(breaks)):
        length = high - low
        steps = [0.0, 0.04, 0.2, 1.0]
        left, right = k in corners, (k + 1) in corners
        if left and right:
            half = np.array(steps) / 2
            local = np.concatenate((half, 1 - half[::-1][1:]))
        elif left:
            local = np.array(steps)
        elif right:
            local = 1 - np.array(steps)[::-1]
        else:
            local = np.array([0.0, 1.0])
        edges = [0.0]
        for a, b in itertools.pairwise(local):
            # An element of order 6 resolves a boundary layer of its own size: split what is long against
            # the walls.
            n = 1
            while (b - a) * length / n > 3.0 * max(size, a * length if left and not right else 0.0) and n < 5:
                n += 1
            edges.extend(a + (b - a) * np.arange(1, n + 1) / n)
        out.extend(low + length * np.array(edges[1:]))
    return np.array(out)


class Blocks:
    """Spectral elements on a union of axis-parallel blocks."""

    def __init__(self, y_breaks, z_breaks, filled, y_corners, z_corners):
        sizes_y, sizes_z = np.diff(y_breaks), np.diff(z_breaks)
        size = min(sizes_y.min(), sizes_z.min())
        ye, ze = graded(list(y_breaks), y_corners, size), graded(list(z_breaks), z_corners, size)
        self.ny, self.nz = (len(ye) - 1) * ORDER + 1, (len(ze) - 1) * ORDER + 1
        rows, cols, data = [], [], []
        mass = np.zeros(self.ny * self.nz)
        self.y = np.zeros(self.ny)
        self.z = np.zeros(self.nz)
        cell = np.zeros((len(ye) - 1, len(ze) - 1), bool)
        for i, j in np.ndindex(cell.shape):
            yc, zc = (ye[i] + ye[i + 1]) / 2, (ze[j] + ze[j + 1]) / 2
            cell[i, j] = filled[np.searchsorted(y_breaks, yc) - 1][np.searchsorted(z_breaks, zc) - 1]
        for i in range(len(ye) - 1):
            self.y[i * ORDER : (i + 1) * ORDER + 1] = ye[i] + (NODES + 1) / 2 * (ye[i + 1] - ye[i])
        for j in range(len(ze) - 1):
            self.z[j * ORDER : (j + 1) * ORDER + 1] = ze[j] + (NODES + 1) / 2 * (ze[j + 1] - ze[j])
        grad = []
        for i, j in np.argwhere(cell):
            hy, hz = ye[i + 1] - ye[i], ze[j + 1] - ze[j]
            ids = ((i * ORDER + np.arange(ORDER + 1))[:, None] * self.nz + j * ORDER + np.arange(ORDER + 1)).ravel()
            k = np.kron(STIFF_1D, MASS_1D) * hz / hy + np.kron(MASS_1D, STIFF_1D) * hy / hz
            rows.append(np.repeat(ids, ids.size))
            cols.append(np.tile(ids, ids.size))
            data.append(k.ravel())
            m = np.kron(WEIGHTS, WEIGHTS) * hy * hz / 4
            np.add.at(mass, ids, m)
            grad.append((ids, hy, hz, m))
        self.elements = grad
        self.used = np.flatnonzero(mass)
        n = mass.size
        self.stiffness = sp.csr_matrix(
            (np.concatenate(data), (np.concatenate(rows), np.concatenate(cols))), shape=(n, n)
        )
        self.mass = mass
        self.Y, self.Z = (a.ravel() for a in np.meshgrid(self.y, self.z, indexing="ij"))

    def weak_divergence(self, fy: np.ndarray, fz: np.ndarray) -> np.ndarray:
        """Integral of f . grad(test) for nodal fields f."""
        out = np.zeros(self.mass.size)
        eye = np.eye(ORDER + 1)
        dy, dz = np.kron(DERIVATIVE, eye), np.kron(eye, DERIVATIVE)
        for ids, hy, hz, m in self.elements:
            np.add.at(out, ids, dy.T @ (m * fy[ids]) * 2 / hy + dz.T @ (m * fz[ids]) * 2 / hz)
        return out

    def solve(self, load: np.ndarray, zero: np.ndarray) -> np.ndarray:
        """Solution with the stiffness matrix, held at zero on the given nodes (or at one node if none)."""
        held = zero[self.used] if zero.any() else np.arange(self.used.size) == 0
        free = self.used[~held]
        out = np.zeros(self.mass.size)
        out[free] = splu(self.stiffness[free][:, free].tocsc()).solve(load[free])
        return out

    def integral(self, values: np.ndarray) -> float:
        return float(self.mass @ values)


def saint_venant(y_breaks, z_breaks, filled, y_corners, z_corners, *, quarter: bool) -> dict[str, float]:
    """A, I_y, I_z, J and a, c of A/A_s = a + c (nu/(1+nu))^2 for both directions.

    The blocks span y >= 0 (and z >= 0 if quarter); the section is symmetric about z (and y).
    """
    b = Blocks(np.asarray(y_breaks, float), np.asarray(z_breaks, float), filled, y_corners, z_corners)
    copies = 4 if quarter else 2
    area = copies * b.integral(np.ones_like(b.Y))
    centroid = 0.0 if quarter else copies * b.integral(b.Z) / area
    y, z = b.Y, b.Z - centroid
    iy, iz = copies * b.integral(z**2), copies * b.integral(y**2)
    on_y0, on_z0 = np.isclose(b.Y, 0.0, atol=1e-12), np.isclose(b.Z, 0.0, atol=1e-12)
    none = np.zeros(b.Y.size, bool)
    z_sym = on_z0 if quarter else none
    # torsion: warping is odd in y, and odd in z if doubly symmetric
    load = -b.weak_divergence(-z, y)
    w = b.solve(load, on_y0 | z_sym)
    j = iy + iz - copies * float(w @ load)
    out = {"A": area, "Iy": iy, "Iz": iz, "J": j}
    zero = np.zeros_like(y)
    for name, f, d, held in (
        ("z", z / iy, (zero, y**2 / (2 * iy)), z_sym),
        ("y", y / iz, (z**2 / (2 * iz), zero), on_y0),
    ):
        phi = b.solve(b.mass * f, held)
        out["a" + name] = area * copies * float(phi @ (b.mass * f))
        load = -b.weak_divergence(*d)
        phi = b.solve(load, held)
        out["c" + name] = area * (copies * b.integral(d[0] ** 2 + d[1] ** 2) - copies * float(phi @ load))
    return out


def rectangle(width: float, height: float) -> dict[str, float]:
    n = 4
    return saint_venant(
        np.linspace(0, width / 2, n),
        np.linspace(0, height / 2, n),
        np.ones((n - 1, n - 1), bool),
        set(),
        set(),
        quarter=True,
    )


def rectangular_tube(width: float, height: float, flange: float, web: float) -> dict[str, float]:
    return saint_venant(
        [0, width / 2 - web, width / 2],
        [0, height / 2 - flange, height / 2],
        [[False, True], [True, True]],
        {1},
        {1},
        quarter=True,
    )


def i_section(width: float, height: float, flange: float, web: float) -> dict[str, float]:
    return saint_venant(
        [0, web / 2, width / 2],
        [0, height / 2 - flange, height / 2],
        [[True, True], [False, True]],
        {1},
        {1},
        quarter=True,
    )


def unequal_i_section(height, top_width, bottom_width, top, bottom, web) -> dict[str, float]:
    edges = sorted({0.0, web / 2, top_width / 2, bottom_width / 2})
    zs = [0, bottom, height - top, height]
    filled = []
    for low, high in itertools.pairwise(edges):
        mid = (low + high) / 2
        filled.append([mid < bottom_width / 2, mid < web / 2, mid < top_width / 2])
    return saint_venant(edges, zs, filled, {1}, {1, 2}, quarter=False)
