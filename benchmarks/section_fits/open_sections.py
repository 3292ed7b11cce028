"""Fits for shapes beyond the doubly symmetric ones, against boundary element samples.

``python -m benchmarks.section_fits.open_sections FOLDER`` writes `sections/fits/open_sections.json`, where FOLDER holds
what `benchmarks.section_fits.samples` left; the errors that remain go to standard error.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from benchmarks.section_fits.fitting import WORST_POISSON, Fits, minimax, nest, powers, save


def fillets(folder: Path) -> Fits:
    """How root fillets change an I-section: log of each factor over the sharp section's."""
    from linkwright.core.sections import ISection
    from linkwright.core.sections.formulas.fillets import fillet_junctions

    width, flange, web, radius, j, ay, cy, az, _ = np.load(folder / "filleted_i_section.npy").T
    height = np.ones_like(width)
    section = ISection(width, height, flange, web)
    none, some = section.properties(0.0), section.properties(0.45)
    sharp_y, sharp_z = none.area / none.shear_area_y, none.area / none.shear_area_z
    sharp_c = (some.area / some.shear_area_y - sharp_y) / WORST_POISSON
    features = (4 * web / width, 4 * flange / height, web / flange)
    lead, exponents = powers(features, 2)
    last, last_exponents = powers(features, 1)
    scales = (radius / width, radius / height, (radius / width) ** 2)
    matrix = np.hstack([lead * scales[0][:, None], lead * scales[1][:, None], last * scales[2][:, None]])
    share = WORST_POISSON * cy / (ay + WORST_POISSON * cy)
    junctions = fillet_junctions(flange, web, radius) - fillet_junctions(flange, web, 0.0)
    local, local_exponents = powers((web / flange, radius / flange, 4 * flange / width), 3)
    local = local * (radius / flange)[:, None]
    ratio = np.log(j / (none.torsion_constant + 2.0 * junctions))
    found = minimax(local, ratio, np.ones_like(j))
    print(f"fillet_torsion             {np.abs(local @ found - ratio).max():.2%}", file=sys.stderr)
    out: Fits = {"fillet_torsion": nest(local_exponents, found)}
    for name, ratio, weight in (
        ("fillet_shear", az / sharp_z, np.ones_like(j)),
        ("fillet_cross_shear", ay / sharp_y, np.ones_like(j)),
        ("fillet_poisson", cy / sharp_c, np.maximum(share, 0.02)),
    ):
        found = minimax(matrix, np.log(ratio), weight)
        error = np.abs(matrix @ found - np.log(ratio)) * weight
        print(f"{name:26s} {error.max():.2%}", file=sys.stderr)
        n = lead.shape[1]
        parts = (found[:n], found[n : 2 * n], found[2 * n :])
        out[name] = tuple(nest(e, c) for e, c in zip((exponents, exponents, last_exponents), parts, strict=True))
    return out


def octagons(folder: Path) -> Fits:
    """Regular octagons of unit width: J over that of the plain difference, and the two parts of A / A_s."""
    inner, j, a, c, _, _ = np.load(folder / "octagonal_tube.npy").T
    out: Fits = {}
    for name, value, weight, degree in (
        ("octagon_torsion", j / (1 - inner**4), 1 / (j / (1 - inner**4)), 8),
        ("octagon_shear", a, 1 / a, 8),
        ("octagon_poisson", c / (1 - inner**2) ** 2, WORST_POISSON * (1 - inner**2) ** 2 / a, 6),
    ):
        matrix, exponents = powers((inner,), degree)
        found = minimax(matrix, value, weight)
        print(f"{name:26s} {np.max(np.abs(matrix @ found - value) * weight):.3%}", file=sys.stderr)
        out[name] = nest(exponents, found)
    return out


def triangular_tubes(folder: Path) -> Fits:
    """Isosceles triangular tubes: features are width / (width + height) and the hollow's share of the outer size."""
    from linkwright.core.sections.formulas.closed_forms import triangle_torsion_constant

    width, inner, j, ay, cy, az, cz = np.load(folder / "triangular_tube.npy").T
    features = (width / (width + 1.0), inner)
    solid = triangle_torsion_constant(width, np.ones_like(width))
    out = fit_log("triangular_tube_torsion", features, j / (solid * (1 - inner**4)), np.ones_like(j), 6)
    for name, a, c, degree in (("y", ay, cy, 6), ("z", az, cz, 4)):
        total = a + WORST_POISSON * c
        least = np.maximum(WORST_POISSON * c / total, 0.01)
        out |= fit_log(f"triangular_tube_shear_{name}", features, a, a / total, 7)
        out |= fit_log(f"triangular_tube_poisson_{name}", features, c / (1 - inner) ** 2, least, degree)
    return out


def angles(folder: Path) -> Fits:
    """Angles of one thickness: features are (width - height) / (width + height) and t (1 / width + 1 / height)."""
    from linkwright.core.sections.shapes.angle import angle_torsion_base

    width, t, j, ay, cy, az, cz = np.load(folder / "angle.npy").T
    height = np.ones_like(width)
    features = ((width - height) / (width + height), t / width + t / height)
    out = fit_log("angle_torsion", features, j / angle_torsion_base(width, height, t), np.ones_like(j), 3)
    for name, a, c in (("y", ay, cy), ("z", az, cz)):
        total = a + WORST_POISSON * c
        least = np.maximum(WORST_POISSON * c / total, 0.01)
        out |= fit_log(f"angle_shear_{name}", features, a, a / total, 6)
        out |= fit_log(f"angle_poisson_{name}", features, c / t**2, least, 4)
    return out


def fit_log(name: str, features: tuple, ratio: np.ndarray, weight: np.ndarray, degree: int) -> Fits:
    matrix, exponents = powers(features, degree)
    found = minimax(matrix, np.log(ratio), weight)
    error = np.abs(np.expm1(matrix @ found - np.log(ratio))) * weight
    print(f"{name:26s} degree {degree}, {matrix.shape[1]} of {len(ratio)}: {error.max():.2%}", file=sys.stderr)
    return {name: nest(exponents, found)}


def main() -> None:
    """Fit and write the data file."""
    folder = Path(sys.argv[1])
    for make in (fillets, octagons, triangular_tubes, angles):
        save("open_sections", make(folder))


if __name__ == "__main__":
    main()
