"""Fits of torsion constants and shear areas that have no closed form, against a high-resolution solver.

The Saint-Venant problems (torsion, and flexure with its Poisson part) are solved with spectral elements on
the
symmetric half or quarter of a section made of axis-parallel blocks. Run ``python
benchmarks/section_fits.py`` to
print the coefficients that `sections/coefficients.py` holds, and the errors they leave.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from numpy.polynomial import legendre
from scipy.sparse.linalg import splu
from scipy.stats import qmc


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
            ids = (
                (i * ORDER + np.arange(ORDER + 1))[:, None] * self.nz + j * ORDER + np.arange(ORDER + 1)
            ).ravel()
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


# ---- samples

CORE = {"ratio": (0.3, 3.0), "wall": (0.01, 0.25)}
"""Range over which the fits are held to 1 %: width / height, and wall / outer size along the same axis."""
WORST_POISSON = (0.45 / 1.45) ** 2


def sample(
    solver: Callable[..., dict[str, float]], most_web: float
) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Width / height, flange / height, web / width of samples (N x 3), and what the solver says of each."""
    axes = [np.log([0.3, 0.4, 0.55, 1.0, 1.8, 2.5, 3.0])] + 2 * [np.log([0.01, 0.03, 0.1, 0.17, 0.25])]
    grid = np.exp(np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3))
    points = [grid]
    for seed, (low, high) in enumerate(
        (([0.27, 0.008, 0.008], [3.4, 0.28, 0.28]), ([0.12, 0.003, 0.003], [8.0, 0.48, most_web]))
    ):
        p = qmc.Sobol(3, seed=seed + 5).random(1024)
        p = 0.5 - 0.5 * np.cos(np.pi * p) if seed else p
        points.append(np.exp(np.log(low) + p * np.log(np.divide(high, low))))
    x = np.vstack(points)
    rows = [solver(r, 1.0, v, u * r) for r, v, u in x]
    return x, {key: np.array([row[key] for row in rows]) for key in rows[0]}


# ---- fits


def powers(features: tuple[np.ndarray, ...], degree: int) -> tuple[np.ndarray, list[tuple[int, ...]]]:
    """All monomials of at most this total degree, as columns, and their exponents."""
    exponents = [e for e in itertools.product(range(degree + 1), repeat=len(features)) if sum(e) <= degree]
    columns = [np.prod([f**k for f, k in zip(features, e, strict=True)], axis=0) for e in exponents]
    return np.column_stack(columns), exponents


def minimax(matrix: np.ndarray, target: np.ndarray, weight: np.ndarray, rounds: int = 60) -> np.ndarray:
    """Coefficients that nearly minimise the greatest weighted residual (Lawson's reweighted least
    squares)."""
    scale, best, least = weight / weight.max(), None, np.inf
    for _ in range(rounds):
        coefficients = np.linalg.lstsq(matrix * scale[:, None], target * scale, rcond=1e-11)[0]
        error = np.abs(matrix @ coefficients - target) * weight
        if error.max() < least:
            best, least = coefficients, error.max()
        scale *= np.sqrt(0.3 + error / error.max())
        scale /= scale.max()
    assert best is not None
    return best


def nest(exponents: list[tuple[int, ...]], coefficients: np.ndarray) -> tuple:
    """Coefficients as nested tuples for `sections.numeric.polynomial`."""
    table = dict(zip(exponents, coefficients, strict=True))
    if len(exponents[0]) == 1:
        return tuple(float(f"{table[(k,)]:.10g}") for k in range(len(table)))
    out = []
    for k in range(max(e[0] for e in exponents) + 1):
        rest = [e[1:] for e in exponents if e[0] == k]
        out.append(nest(rest, np.array([table[(k, *e)] for e in rest])))
    return tuple(out)


def fit(name, features, ratio, weight, core, degree, fade=0.1) -> tuple[str, tuple]:
    """Fit log(ratio), printing the worst error within and without the core."""
    matrix, exponents = powers(features, degree)
    coefficients = minimax(matrix, np.log(ratio), weight * np.where(core, 1.0, fade))
    error = np.abs(np.expm1(matrix @ coefficients - np.log(ratio))) * weight
    print(
        f"{name:26s} degree {degree}: {error[core].max():.2%} in the core, {error.max():.2%} beyond",
        file=sys.stderr,
    )
    return name, nest(exponents, coefficients)


def fit_walls(tube, section) -> list[tuple[str, tuple]]:
    """Corrections of `sections.thin_walls` from samples of tubes and of I-sections."""
    from sections import thin_walls as tw

    out = []
    for kind, (x, q) in (("tube", tube), ("i", section)):
        r, v, u = x.T
        b, h, flange, web = r, np.ones_like(r), v, u * r
        low, high = CORE["wall"]
        core = (r > 0.299) & (r < 3.01) & (np.minimum(u, v) > low - 1e-9) & (np.maximum(u, v) < high + 1e-9)
        total = {k: q["a" + k] + WORST_POISSON * q["c" + k] for k in "yz"}
        # Where a part does not count, a small weight keeps its fit sane all the same.
        share = {k: WORST_POISSON * q["c" + k] / total[k] for k in "yz"}
        least = {k: np.maximum(share[k], 0.02) for k in "yz"}
        one = np.ones_like(r)
        if kind == "tube":
            features = ((b - h) / (b + h), 2 * u, 2 * v)
            flipped = ((h - b) / (b + h), 2 * v, 2 * u)
            both = tuple(np.concatenate(pair) for pair in zip(features, flipped, strict=True))
            twice = np.concatenate((core, core))
            out.append(
                fit(
                    "TUBE_TORSION",
                    both,
                    np.tile(q["J"] / tw.tube_torsion_base(b, h, flange, web), 2),
                    np.tile(one, 2),
                    twice,
                    5,
                )
            )
            base_z = tw.corner_shear_base(b, h, flange, web, q["A"], q["Iy"])
            base_y = tw.corner_shear_base(h, b, web, flange, q["A"], q["Iz"])
            out.append(
                fit(
                    "CORNER_SHEAR",
                    both,
                    np.concatenate((q["az"] / base_z, q["ay"] / base_y)),
                    np.concatenate((1 - share["z"], 1 - share["y"])),
                    twice,
                    6,
                )
            )
            base_z = tw.tube_poisson_base(b, h, flange, web, q["A"], q["Iy"])
            base_y = tw.tube_poisson_base(h, b, web, flange, q["A"], q["Iz"])
            out.append(
                fit(
                    "TUBE_POISSON",
                    both,
                    np.concatenate((q["cz"] / base_z, q["cy"] / base_y)),
                    np.concatenate((least["z"], least["y"])),
                    twice,
                    4,
                )
            )
        else:
            features = ((b - h) / (b + h), u, 2 * v)
            wide = (web / (web + flange) - 0.5, *features)
            base = tw.i_section_torsion_base(b, h, flange, web)
            out.append(fit("I_SECTION_TORSION", wide, q["J"] / base, one, core, 5))
            base = tw.i_section_cross_base(b, h, flange, web, q["A"], q["Iz"])
            out.append(fit("I_SECTION_CROSS_SHEAR", wide, q["ay"] / base, 1 - share["y"], core, 5))
            base = tw.i_section_poisson_base(b, h, flange, web, q["A"], q["Iy"])
            out.append(fit("I_SECTION_POISSON", features, q["cz"] / base, least["z"], core, 4))
            base = tw.i_section_cross_poisson_base(b, h, flange, web, q["A"], q["Iz"])
            out.append(fit("I_SECTION_CROSS_POISSON", wide, q["cy"] / base, least["y"], core, 4))
    return out


def fit_solids() -> list[tuple[str, tuple]]:
    """Corrections of `sections.closed_forms`: rectangle from its series, triangle from boundary elements."""
    from sections.saint_venant import solve

    def plain(x: np.ndarray, value: np.ndarray, degree: int, weight: np.ndarray | None = None) -> tuple:
        matrix, exponents = powers((x,), degree)
        weight = 1 / value if weight is None else weight
        coefficients = minimax(matrix, value, weight, 200)
        print(f"  worst {np.max(np.abs(matrix @ coefficients - value) * weight):.1e}", file=sys.stderr)
        return nest(exponents, coefficients)

    out = []
    odd = np.arange(1, 4001, 2)
    r = np.exp(np.linspace(0, np.log(1e4), 400))
    third = np.array([np.sum(np.tanh(odd * np.pi * s / 2) / odd**5) for s in r])
    value = (1 / 3 - 64 / np.pi**5 / r * third) * 3 * (1 + r**2) / r**2
    out.append(("RECTANGLE_TORSION", plain(r / (1 + r**2), value, 7)))

    def poisson(s: float) -> float:
        if s > 6:  # the series cancels
            return rectangle(s, 1.0)["cz"]
        n = np.arange(1, 20001, dtype=np.longdouble)
        total = np.sum(np.tanh(n * np.pi / s) / n**5)
        return float(144 * s**4 * (np.longdouble(1) / 720 - s / (8 * np.longdouble(np.pi) ** 5) * total))

    r = np.exp(np.linspace(np.log(0.02), np.log(30), 150))
    c = np.array([poisson(float(s)) for s in r])
    weight = WORST_POISSON * r**4 / (5 + r**2) / (1.2 + WORST_POISSON * c)
    out.append(("RECTANGLE_SHEAR", plain(r / (1 + r), c * (5 + r**2) / r**4, 7, weight)))

    w = np.exp(np.linspace(np.log(0.1), np.log(10), 81))
    rows = [solve([np.array([[-s / 2, -1 / 3], [s / 2, -1 / 3], [0, 2 / 3]])], 2.5) for s in w]
    x = w / (1 + w)
    value = np.array([row.torsion_constant for row in rows]) * 12 * (1 + w**2) / w**3
    out.append(("TRIANGLE_TORSION", plain(x, value, 7)))
    value = np.array([row.torsion_modulus for row in rows]) * (1 + w) / w**2
    out.append(("TRIANGLE_TORSION_MODULUS", plain(x, value, 7)))
    for name, pick, a_scale, c_scale in (
        ("TRIANGLE_SHEAR_Y", lambda row: row.shear_y, np.ones_like(w), 1 / (w**2 * (1 + w**2))),
        ("TRIANGLE_SHEAR_Z", lambda row: row.shear_z, 1 + w**2 / 14, w**4 / (1 + w**2)),
    ):
        a, c = np.array([pick(row) for row in rows]).T
        total = a + WORST_POISSON * c
        out.append(
            (
                name,
                (
                    plain(x, a / a_scale, 7, a_scale / total),
                    plain(x, c / c_scale, 7, WORST_POISSON * c_scale / total),
                ),
            )
        )
    return out


def main() -> None:
    """Sample, fit, and write the coefficients to standard output."""
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
    write(fit_all(sample(rectangular_tube, 0.48), sample(i_section, 0.93)))


def fit_all(tube, section) -> list[tuple[str, tuple]]:
    """Every table; the bases of the thin-walled fits already use the new table of the rectangle."""
    from sections import closed_forms

    solids = fit_solids()
    closed_forms.RECTANGLE_TORSION = dict(solids)["RECTANGLE_TORSION"]
    return solids + fit_walls(tube, section)


def write(rows: list[tuple[str, tuple]]) -> None:
    print('"""Coefficients of fits, written by benchmarks/section_fits.py; not to be edited by hand."""\n')
    print("# fmt: off")
    for name, value in rows:
        print(f"{name} = {layout(value)}")


def layout(value, indent: int = 0) -> str:
    """Nested tuples, one innermost tuple a line or more."""
    pad = " " * (indent + 4)
    if not isinstance(value[0], tuple):
        lines, line = [], ""
        for number in value:
            if len(line) > 80:
                lines.append(line.rstrip())
                line = ""
            line += f"{number!r}, "
        lines.append(line.rstrip())
        inner = ("\n" + pad).join(lines)
        return f"(\n{pad}{inner}\n{' ' * indent})"
    inner = "".join(f"{pad}{layout(v, indent + 4)},\n" for v in value)
    return f"(\n{inner}{' ' * indent})"


if __name__ == "__main__":
    main()
