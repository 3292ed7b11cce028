"""Fits of rectangles, triangles, rectangular tubes and I-sections.

``python -m benchmarks.section_fits.closed_and_i`` samples (an hour) and writes `sections/fits/closed_and_i.json`; the
errors that remain go to standard error.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
from scipy.stats import qmc

from benchmarks.section_fits.elements import i_section, rectangle, rectangular_tube
from benchmarks.section_fits.fitting import WORST_POISSON, Fits, minimax, nest, powers, save

# ---- samples

CORE = {"ratio": (0.3, 3.0), "wall": (0.01, 0.25)}
"""Range over which the fits are held to 1 %: width / height, and wall / outer size along the same axis."""


def sample(solver: Callable[..., dict[str, float]], most_web: float) -> tuple[np.ndarray, dict[str, np.ndarray]]:
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


def fit(name, features, ratio, weight, core, degree, fade=0.1) -> Fits:
    """Fit log(ratio), printing the worst error within and without the core."""
    matrix, exponents = powers(features, degree)
    coefficients = minimax(matrix, np.log(ratio), weight * np.where(core, 1.0, fade))
    error = np.abs(np.expm1(matrix @ coefficients - np.log(ratio))) * weight
    print(
        f"{name:26s} degree {degree}: {error[core].max():.2%} in the core, {error.max():.2%} beyond",
        file=sys.stderr,
    )
    return {name: nest(exponents, coefficients)}


def fit_walls(tube, section) -> Fits:
    """Corrections of `sections.formulas.thin_walls` from samples of tubes and of I-sections."""
    from linkwright.core.sections.formulas import thin_walls as tw

    out: Fits = {}
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
            out.update(
                fit(
                    "tube_torsion",
                    both,
                    np.tile(q["J"] / tw.tube_torsion_base(b, h, flange, web), 2),
                    np.tile(one, 2),
                    twice,
                    5,
                )
            )
            base_z = tw.corner_shear_base(b, h, flange, web, q["A"], q["Iy"])
            base_y = tw.corner_shear_base(h, b, web, flange, q["A"], q["Iz"])
            out.update(
                fit(
                    "corner_shear",
                    both,
                    np.concatenate((q["az"] / base_z, q["ay"] / base_y)),
                    np.concatenate((1 - share["z"], 1 - share["y"])),
                    twice,
                    6,
                )
            )
            base_z = tw.tube_poisson_base(b, h, flange, web, q["A"], q["Iy"])
            base_y = tw.tube_poisson_base(h, b, web, flange, q["A"], q["Iz"])
            out.update(
                fit(
                    "tube_poisson",
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
            out.update(fit("i_section_torsion", wide, q["J"] / base, one, core, 5))
            base = tw.i_section_cross_base(b, h, flange, web, q["A"], q["Iz"])
            out.update(fit("i_section_cross_shear", wide, q["ay"] / base, 1 - share["y"], core, 5))
            base = tw.i_section_poisson_base(b, h, flange, web, q["A"], q["Iy"])
            out.update(fit("i_section_poisson", features, q["cz"] / base, least["z"], core, 4))
            base = tw.i_section_cross_poisson_base(b, h, flange, web, q["A"], q["Iz"])
            out.update(fit("i_section_cross_poisson", wide, q["cy"] / base, least["y"], core, 4))
    return out


def fit_solids() -> Fits:
    """Corrections of `sections.formulas.closed_forms`: rectangle from its series, triangle from boundary elements."""
    from linkwright.core.sections.formulas.saint_venant import solve

    def plain(x: np.ndarray, value: np.ndarray, degree: int, weight: np.ndarray | None = None) -> tuple:
        matrix, exponents = powers((x,), degree)
        weight = 1 / value if weight is None else weight
        coefficients = minimax(matrix, value, weight, 200)
        print(f"  worst {np.max(np.abs(matrix @ coefficients - value) * weight):.1e}", file=sys.stderr)
        return nest(exponents, coefficients)

    out: Fits = {}
    odd = np.arange(1, 4001, 2)
    r = np.exp(np.linspace(0, np.log(1e4), 400))
    third = np.array([np.sum(np.tanh(odd * np.pi * s / 2) / odd**5) for s in r])
    value = (1 / 3 - 64 / np.pi**5 / r * third) * 3 * (1 + r**2) / r**2
    out["rectangle_torsion"] = plain(r / (1 + r**2), value, 7)

    def poisson(s: float) -> float:
        if s > 6:  # the series cancels
            return rectangle(s, 1.0)["cz"]
        n = np.arange(1, 20001, dtype=np.longdouble)
        total = np.sum(np.tanh(n * np.pi / s) / n**5)
        return float(144 * s**4 * (np.longdouble(1) / 720 - s / (8 * np.longdouble(np.pi) ** 5) * total))

    r = np.exp(np.linspace(np.log(0.02), np.log(30), 150))
    c = np.array([poisson(float(s)) for s in r])
    weight = WORST_POISSON * r**4 / (5 + r**2) / (1.2 + WORST_POISSON * c)
    out["rectangle_shear"] = plain(r / (1 + r), c * (5 + r**2) / r**4, 7, weight)

    w = np.exp(np.linspace(np.log(0.1), np.log(10), 81))
    rows = [solve([np.array([[-s / 2, -1 / 3], [s / 2, -1 / 3], [0, 2 / 3]])], 2.5) for s in w]
    x = w / (1 + w)
    value = np.array([row.torsion_constant for row in rows]) * 12 * (1 + w**2) / w**3
    out["triangle_torsion"] = plain(x, value, 7)
    value = np.array([row.torsion_modulus for row in rows]) * (1 + w) / w**2
    out["triangle_torsion_modulus"] = plain(x, value, 7)
    for name, pick, a_scale, c_scale in (
        ("y", lambda row: row.shear_y, np.ones_like(w), 1 / (w**2 * (1 + w**2))),
        ("z", lambda row: row.shear_z, 1 + w**2 / 14, w**4 / (1 + w**2)),
    ):
        a, c = np.array([pick(row) for row in rows]).T
        total = a + WORST_POISSON * c
        out[f"triangle_shear_{name}"] = plain(x, a / a_scale, 7, a_scale / total)
        out[f"triangle_poisson_{name}"] = plain(x, c / c_scale, 7, WORST_POISSON * c_scale / total)
    return out


def main() -> None:
    """Sample, fit and write; the bases of the thin-walled fits already use the new table of the rectangle."""
    tube, section = sample(rectangular_tube, 0.48), sample(i_section, 0.93)
    save("closed_and_i", fit_solids())
    save("closed_and_i", fit_walls(tube, section))


if __name__ == "__main__":
    main()
