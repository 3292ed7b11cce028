"""Torsion and flexural shear of polygons, by the boundary element method.

The warping functions of torsion and of flexure are harmonic up to known polynomials, so only their values
on the boundary are unknown, and every energy is a boundary integral. Elements are straight with three
collocation points each (quadratic, discontinuous); all kernels are integrated in closed form. Multiply
connected sections need nothing special: the functions are single-valued by construction.

With s = nu / (1 + nu) and f = c_y y + c_z z the axial change of the bending stress for a unit shear force,
the shear stress is grad(phi_0) + s (grad(phi_1) + d), d = (c_y z^2, c_z y^2) / 2, where laplace(phi_0) =
-f, d(phi_0)/dn = 0 and laplace(phi_1) = 0, d(phi_1)/dn = -d.n. The two parts are orthogonal, so A / A_s = a
+ c s^2 with two energies a and c that do not depend on nu.

Convention of the shear energy: F. Gruttmann and W. Wagner, Shear correction factors in Timoshenko's beam
theory for arbitrary shaped cross-sections, Computational Mechanics 27 (2001) 199-207,
doi:10.1007/s004660100239.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.numeric import Array

GAUSS_POINTS = np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)])
GAUSS_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 9.0
_BASIS = np.linalg.inv(np.vander(GAUSS_POINTS, increasing=True))
"""Column i holds the coefficients of the quadratic that is one at Gauss point i and zero at the others."""

FLAT_TURN = np.radians(30.0)
"""A corner that turns less than this belongs to a smooth curve."""


@dataclass(frozen=True)
class Moments:
    """Integrals over a polygon about given axes: area, first and second moments (m^2, m^3, m^4)."""

    area: float
    first_y: float
    first_z: float
    yy: float
    zz: float
    yz: float


def moments(loops: Sequence[Array]) -> Moments:
    """Exact integrals of 1, y, z, y^2, z^2, yz over the region left of the loops (N x 2 vertices, m)."""
    total = np.zeros(6)
    for loop in loops:
        y0, z0 = loop.T
        y1, z1 = np.roll(loop, -1, axis=0).T
        cross = y0 * z1 - y1 * z0
        total += (
            cross.sum() / 2.0,
            (cross * (y0 + y1)).sum() / 6.0,
            (cross * (z0 + z1)).sum() / 6.0,
            (cross * (y0**2 + y0 * y1 + y1**2)).sum() / 12.0,
            (cross * (z0**2 + z0 * z1 + z1**2)).sum() / 12.0,
            (cross * (y0 * z1 + 2.0 * y0 * z0 + 2.0 * y1 * z1 + y1 * z0)).sum() / 24.0,
        )
    return Moments(*(float(value) for value in total))


@dataclass(frozen=True)
class SaintVenant:
    """Solution of the torsion and flexure problems of one section.

    Attributes:
        torsion_constant: J, m^4.
        torsion_modulus: J over the greatest boundary shear stress per G and twist, m^3. At a re-entrant
        corner
            that stress is unbounded in theory; the tenth of an edge next to such a corner is left out.
        shear_y: (a, c) of A / A_sy = a + c (nu / (1 + nu))^2.
        shear_z: the same along z.
        shear_centre: (y, z) from the centroid, m, by Trefftz: the point about which the section turns under a torque,
            which does not depend on Poisson's ratio (E. Trefftz, Z. Angew. Math. Mech. 15 (1935) 220-225).
        warping_constant: integral of the warping function about the shear centre squared, m^6; zero with holes, whose
            closed walls hardly warp.
        nodes: number of boundary unknowns that were used.
    """

    torsion_constant: float
    torsion_modulus: float
    shear_y: tuple[float, float]
    shear_z: tuple[float, float]
    shear_centre: tuple[float, float]
    warping_constant: float
    nodes: int


def solve(loops: Sequence[Array], fineness: float = 1.0) -> SaintVenant:
    """Solve for the region left of the loops: outer edge anticlockwise, holes clockwise (N x 2 vertices, m).

    The axes must pass through the centroid. Elements shrink with ``fineness`` > 1. At 1 the error of the shear
    areas is below 0.2 % for walls down to a hundredth of the outer size, and so is that of J unless the section is open
    and thin: J is then a small difference of large integrals, and some 2 % off now and then (2.2 mends that).
    """
    size = max(float(np.ptp(loop)) for loop in loops)
    start, end, sharp = _elements([loop / size for loop in loops], fineness)
    boundary = _Boundary(start, end)
    m = moments([loop / size for loop in loops])
    y, z, ny, nz, weight = boundary.y, boundary.z, boundary.ny, boundary.nz, boundary.weight
    # Normal derivatives of the five harmonic functions: torsion, y^3 and z^3 parts of phi_0, both parts of
    # phi_1.
    flux = np.column_stack((z * ny - y * nz, 0.5 * y**2 * ny, 0.5 * z**2 * nz, -0.5 * z**2 * ny, -0.5 * y**2 * nz))
    # phi_0 of y^3 has a net flux (its Laplacian is y, which integrates to zero about the centroid): none is
    # left.
    warping = boundary.harmonic(flux)
    torsion = m.yy + m.zz - float(weight @ (warping[:, 0] * flux[:, 0]))
    stress = np.abs(boundary.tangential_derivative(warping[:, 0]) + (y * ny + z * nz))
    determinant = m.yy * m.zz - m.yz**2

    def energies(cy: float, cz: float) -> tuple[float, float]:
        particular = -(cy * y**3 + cz * z**3) / 6.0
        particular_flux = -0.5 * (cy * y**2 * ny + cz * z**2 * nz)
        phi0 = particular + cy * warping[:, 1] + cz * warping[:, 2]
        # Integral of f P over the region: each monomial is the divergence of its primitive.
        fp = -_polynomial_energy(boundary, cy, cz) / 6.0
        first = fp - float(weight @ ((phi0) * particular_flux))
        d_n = 0.5 * (cy * z**2 * ny + cz * y**2 * nz)
        phi1 = cy * warping[:, 3] + cz * warping[:, 4]
        d_squared = 0.25 * float(weight @ (cz**2 * y**5 / 5.0 * ny + cy**2 * z**5 / 5.0 * nz))
        second = d_squared + float(weight @ (phi1 * d_n))
        return m.area * first, m.area * second

    centre, warps = _warping(boundary, warping[:, 0], flux[:, 0], m, whole=len(loops) == 1)
    shear_y = energies(m.zz / determinant, -m.yz / determinant)
    shear_z = energies(-m.yz / determinant, m.yy / determinant)
    return SaintVenant(
        torsion_constant=torsion * size**4,
        torsion_modulus=torsion / float(stress[~np.repeat(sharp, 3)].max()) * size**3,
        shear_y=shear_y,
        shear_z=shear_z,
        shear_centre=(centre[0] * size, centre[1] * size),
        warping_constant=warps * size**6,
        nodes=y.size,
    )


def _warping(
    boundary: _Boundary, warping: Array, flux: Array, m: Moments, *, whole: bool
) -> tuple[tuple[float, float], float]:
    """Shear centre and warping constant from the warping function about the centroid, known on the boundary.

    Integrals of y and z times that function follow from Green's identity with y^3 / 6 and z^3 / 6. Its square is half
    of |f|^2 + Re f^2, where f = w + i r^2 / 2 is analytic: the integral of either is one along the boundary of a
    section that is `whole` (without holes), of the first by f times the primitive of f.
    """
    y, z, ny, nz, weight = boundary.y, boundary.z, boundary.ny, boundary.nz, boundary.weight
    with_y = float(weight @ (0.5 * y**2 * ny * warping - y**3 / 6.0 * flux))
    with_z = float(weight @ (0.5 * z**2 * nz * warping - z**3 / 6.0 * flux))
    matrix = np.array([[-m.yz, m.yy], [-m.zz, m.yz]])
    y_s, z_s = (float(item) for item in np.linalg.solve(matrix, [with_y, with_z]))
    if not whole:
        return (y_s, z_s), 0.0
    square = y**2 + z**2
    alone = float(weight @ (0.5 * (y * ny + z * nz) * warping - 0.25 * square * flux))
    values = warping + 0.5j * square
    primitive = boundary.primitive(values)
    along = weight * (-nz + 1j * ny)
    analytic = np.sum(along * values**2 * (y - 1j * z)) / 2j
    modulus = np.sum(along * values * np.conj(primitive)) / 2j
    total = 0.5 * float(analytic.real + modulus.real)
    return (y_s, z_s), total - alone**2 / m.area - z_s * with_y + y_s * with_z


def _polynomial_energy(boundary: _Boundary, cy: float, cz: float) -> float:
    """Integral of (cy y + cz z)(cy y^3 + cz z^3) over the region."""
    y, z, ny, nz = boundary.y, boundary.z, boundary.ny, boundary.nz
    integrand = (cy**2 * y**5 / 5.0 + cy * cz * z * y**4 / 4.0) * ny + (
        cz**2 * z**5 / 5.0 + cy * cz * y * z**4 / 4.0
    ) * nz
    return float(boundary.weight @ integrand)


class _Boundary:
    """Straight elements with three nodes each; arrays over nodes are (3 n,), element after element."""

    def __init__(self, start: Array, end: Array) -> None:
        self._middle = 0.5 * (start + end)
        self._length = np.hypot(*(end - start).T)
        self._tangent = (end - start) / self._length[:, None]
        points = self._middle[:, None, :] + 0.5 * (end - start)[:, None, :] * GAUSS_POINTS[None, :, None]
        self._points = points.reshape(-1, 2)
        self.y, self.z = self._points.T
        self.ny = np.repeat(self._tangent[:, 1], 3)
        self.nz = np.repeat(-self._tangent[:, 0], 3)
        self.weight = (0.5 * self._length[:, None] * GAUSS_WEIGHTS[None, :]).ravel()

    def harmonic(self, flux: Array) -> Array:
        """Boundary values (mean zero) of the harmonic functions with these normal derivatives, one a
        column."""
        from scipy.linalg import lu_factor, lu_solve  # here, for a list of sections needs none of it

        single, double = self._layers()
        matrix = double
        matrix[np.diag_indices_from(matrix)] += 0.5
        matrix += self.weight[None, :] / self.weight.sum()
        return lu_solve(lu_factor(matrix, overwrite_a=True), single @ flux)

    def tangential_derivative(self, values: Array) -> Array:
        """Derivative of nodal values along the boundary."""
        slope = np.vander(GAUSS_POINTS, increasing=True)[:, :2] @ (np.array([[1.0], [2.0]]) * _BASIS[1:])
        return ((values.reshape(-1, 3) @ slope.T) * (2.0 / self._length)[:, None]).ravel()

    def primitive(self, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """The integral of nodal values over the complex coordinate along the boundary, from its first point."""
        columns = values.reshape(-1, 3) @ _BASIS.T
        powers = np.arange(1, 4)
        to_node = (GAUSS_POINTS[:, None] ** powers - (-1.0) ** powers) / powers
        to_end = (1.0 - (-1.0) ** powers) / powers
        step = 0.5 * self._length * (self._tangent[:, 0] + 1j * self._tangent[:, 1])
        whole = step * (columns @ to_end)
        before = np.cumsum(whole) - whole
        return (before[:, None] + step[:, None] * (columns @ to_node.T)).ravel()

    def _layers(self) -> tuple[Array, Array]:
        """Matrices of the single and double layer potential, -ln(r) / (2 pi) and its normal derivative."""
        count = self._length.size
        offset = self._points[:, None, :] - self._middle[None, :, :]
        along = np.einsum("pek,ek->pe", offset, self._tangent)
        normal = np.column_stack((self._tangent[:, 1], -self._tangent[:, 0]))
        d = -np.einsum("pek,ek->pe", offset, normal)
        values = np.repeat(np.arange(count), 3)
        d[np.arange(3 * count), values] = 0.0
        d[np.abs(d) < 1e-14] = 0.0
        half = 0.5 * self._length[None, :]
        on_line, d_square = d == 0.0, d * d
        safe = np.where(on_line, 1.0, d)

        def primitives(s: Array) -> tuple[Array, Array, Array, Array, Array, Array]:
            # Cubes are products here: powers of large arrays take many times as long.
            s_square = s * s
            square = s_square + d_square
            log = np.log(square)
            angle = np.where(on_line, 0.0, np.arctan(s / safe))
            d_angle = d * angle
            return (
                0.5 * s * log - s + d_angle,
                0.25 * (square * log - square),
                s * (s_square * (log / 6.0 - 1.0 / 9.0) + d_square / 3.0) - d_square * d_angle / 3.0,
                angle,
                0.5 * d * log,
                d * s - d * d_angle,
            )

        upper, lower = primitives(half - along), primitives(-half - along)
        s0, s1, s2, d0, d1, d2 = (u - v for u, v in zip(upper, lower, strict=True))
        layers: list[Array] = []
        for m0, m1, m2 in ((s0, s1, s2), (d0, d1, d2)):
            # From powers of the distance along the element to powers of its local coordinate in [-1, 1].
            x1 = (m1 + along * m0) / half
            x2 = (m2 + 2.0 * along * m1 + along**2 * m0) / half**2
            layer = np.empty((3 * count, count, 3))
            for node, (b0, b1, b2) in enumerate((-_BASIS / (2.0 * np.pi)).T.tolist()):
                layer[:, :, node] = b0 * m0 + b1 * x1 + b2 * x2
            layers.append(layer.reshape(3 * count, 3 * count))
        return layers[0], layers[1]


def _elements(loops: Sequence[Array], fineness: float) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Split edges into elements: short where another edge is near, or towards a re-entrant corner.

    Returns start and end points, and whether an element is in the tenth of an edge next to a re-entrant
    corner.
    """
    start = np.vstack(loops)
    end = np.vstack([np.roll(loop, -1, axis=0) for loop in loops])
    edges = start.shape[0]
    following, offset = np.empty(edges, dtype=int), 0
    for loop in loops:
        following[offset : offset + len(loop)] = offset + np.roll(np.arange(len(loop)), -1)
        offset += len(loop)
    vector = end - start
    turn = np.arctan2(
        vector[:, 0] * vector[following, 1] - vector[:, 1] * vector[following, 0],
        np.einsum("ek,ek->e", vector, vector[following]),
    )
    reentrant = turn < -FLAT_TURN
    ignored = np.eye(edges, dtype=bool)
    for edge in np.flatnonzero(~reentrant):
        ignored[edge, following[edge]] = ignored[following[edge], edge] = True
    perimeter = float(np.hypot(*vector.T).sum())
    longest = perimeter / (40.0 * fineness)
    shortest = perimeter / (4000.0 * fineness)
    preceding = np.argsort(following)
    pieces: list[tuple[Array, Array]] = []
    sharp: list[bool] = []
    for edge in range(edges):
        length = float(np.hypot(*vector[edge]))
        least = max(shortest, 1e-3 * length)
        others = np.flatnonzero(~ignored[edge])
        stack = [(0.0, 1.0)]
        while stack:
            low, high = stack.pop()
            middle = 0.5 * (low + high)
            near = _distance(start[edge] + middle * vector[edge], start[others], vector[others]) if others.size else 9.0
            allowed = min(longest, max(1.2 * near / fineness, least))
            # Three elements on every true edge at least, so that both ends can bend on their own.
            if (high - low) * length > allowed or (length > longest / 3.0 and high - low > 0.34):
                stack += [(middle, high), (low, middle)]
                continue
            pieces.append((start[edge] + low * vector[edge], start[edge] + high * vector[edge]))
            sharp.append(bool((reentrant[preceding[edge]] and low < 0.1) or (reentrant[edge] and high > 0.9)))
    return np.array([a for a, _ in pieces]), np.array([b for _, b in pieces]), np.array(sharp)


def _distance(point: Array, start: Array, vector: Array) -> float:
    """Least distance from a point to segments, m."""
    along = np.clip(np.einsum("ek,ek->e", point - start, vector) / np.einsum("ek,ek->e", vector, vector), 0.0, 1.0)
    return float(np.min(np.hypot(*(start + along[:, None] * vector - point).T)))
