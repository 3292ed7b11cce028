"""Fits for channels and T-sections, and the samples that they are made from.

``python -m benchmarks.section_fits.channels sample FOLDER`` solves some thousand sections by boundary elements (ten
minutes); ``python -m benchmarks.section_fits.channels fit FOLDER`` then writes `sections/fits/channels.json`. The
errors that remain on the samples go to standard error, and with them those on samples that the fits have not seen.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from benchmarks.section_fits.fitting import WORST_POISSON, Fits, minimax, nest, powers, save
from benchmarks.section_fits.samples import centred, channel, clustered, rows, t_section

RANGES = {
    channel: ([0.18, 0.009, 0.009], [1.7, 0.27, 0.27]),
    t_section: ([0.45, 0.009, 0.009], [3.4, 0.27, 0.27]),
}
"""Least and greatest width, flange and web (as a share of the width) of a section of unit height."""


def sample(folder: Path, count: int, seed: int, ending: str) -> None:
    """Solve both shapes over their dimensions."""
    for number, (make, (low, high)) in enumerate(RANGES.items()):
        points = clustered(low, high, count, seed + number)
        points[:, 2] *= points[:, 0]
        np.save(folder / f"{make.__name__}{ending}.npy", rows(make, points))


def junctions(folder: Path) -> None:
    """J of the junction of long strips beyond that of the strips, over the share of the first thickness."""
    from linkwright.core.sections.formulas.open_walls import FREE_END
    from linkwright.core.sections.formulas.saint_venant import solve

    share = 0.006 + 0.988 * (0.5 - 0.5 * np.cos(np.pi * (np.arange(26) + 0.5) / 26))
    found = []
    for w, t in zip(share, 1.0 - share, strict=True):
        a, c = 4.0 * t, 4.0 * w
        ends = c * w**3 / 3.0 - FREE_END * w**4, a * t**3 / 3.0 - FREE_END * t**4
        corner = centred([(0, 0), (w + a, 0), (w + a, t), (w, t), (w, t + c), (0, t + c)])
        s, r = w / 2, w / 2 + a
        tee = centred([(-r, 0), (r, 0), (r, t), (s, t), (s, t + c), (-s, t + c), (-s, t), (-r, t)])
        found.append(
            (
                solve(corner, 1.5).torsion_constant - ends[0] - ends[1],
                solve(tee, 1.5).torsion_constant - ends[0] - 2.0 * ends[1],
            )
        )
    np.save(folder / "junctions.npy", np.column_stack((share, found)))


def junction_fits(folder: Path) -> Fits:
    """Both junctions as polynomials."""
    share, *values = np.load(folder / "junctions.npy").T
    out: Fits = {}
    for name, value in zip(("l_junction", "t_junction"), values, strict=True):
        matrix, exponents = powers((share,), 6)
        found = minimax(matrix, value, np.ones_like(share))
        print(f"{name:20s} {np.abs(matrix @ found - value).max():.1e} of the fourth power", file=sys.stderr)
        out[name] = nest(exponents, found)
    return out


class Fit:
    """One quantity: features, log ratio to its base and weight, on the samples to fit and on fresh ones."""

    def __init__(self, name: str, degree: int) -> None:
        self.name, self.degree = name, degree
        self.parts: dict[str, list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = {"": [], "_fresh": []}

    def add(self, ending: str, features: tuple, ratio: np.ndarray, weight: np.ndarray) -> None:
        self.parts[ending].append((np.column_stack(features), np.log(ratio), weight))

    def made(self) -> tuple:
        (features, target, weight), fresh = (
            tuple(np.concatenate(each) for each in zip(*parts, strict=True)) for parts in self.parts.values()
        )
        matrix, exponents = powers(tuple(features.T), self.degree)
        found = minimax(matrix, target, weight)
        errors = [
            np.abs(np.expm1(powers(tuple(f.T), self.degree)[0] @ found - value)) * w
            for f, value, w in ((features, target, weight), fresh)
        ]
        told = f"{errors[0].max():.2%} of {len(target)}, fresh {errors[1].max():.2%} of {len(errors[1])}"
        print(f"{self.name:20s} degree {self.degree}, {len(found)} terms: {told}", file=sys.stderr)
        return nest(exponents, found)


def wall_fits(folder: Path) -> Fits:
    """Everything else, each weighted by its share of what it enters."""
    from linkwright.core.sections.formulas import open_walls as walls
    from linkwright.core.sections.formulas.thin_walls import i_section_cross_base
    from linkwright.core.sections.shapes.channel import Channel
    from linkwright.core.sections.shapes.t_section import TSection

    half, along_flange = Fit("half_shear", 5), Fit("t_shear_y", 4)
    twisted = {
        channel: (Fit("channel_poisson_y", 3), Fit("channel_poisson_z", 3)),
        t_section: (Fit("t_poisson_y", 3), Fit("t_poisson_z", 3)),
    }
    for ending in ("", "_fresh"):
        for make in RANGES:
            b, t, w, _, ay, cy, az, cz = np.load(folder / f"{make.__name__}{ending}.npy").T
            h = np.ones_like(b)
            found = (Channel if make is channel else TSection)(b, h, t, w).properties(0.0)
            area, iy, iz = found.area, found.second_moment_y, found.second_moment_z
            total_y, total_z = ay + WORST_POISSON * cy, az + WORST_POISSON * cz
            shares = [np.maximum(WORST_POISSON * c / a, 0.01) for c, a in ((cy, total_y), (cz, total_z))]
            if make is channel:
                features = walls.channel_features(b, h, t, w)
                arguments = (0.5 * h, w, t, b)
                base = walls.half_shear_base(*arguments, found.centroid_y, 0.5 * area, 0.5 * iz)
                half.add(ending, walls.half_features(*arguments), ay / base, ay / total_y)
                bases = (
                    walls.channel_poisson_base_y(h, b, t, w),
                    walls.channel_poisson_base_z(h, b, t, w, found.centroid_y),
                )
            else:
                features = walls.t_features(b, h, t, w)
                arguments = (0.5 * b, t, 0.5 * w, h)
                base = walls.half_shear_base(*arguments, h - found.centroid_z, 0.5 * area, 0.5 * iy)
                half.add(ending, walls.half_features(*arguments), az / base, az / total_z)
                cross = i_section_cross_base(b, 2.0 * h, t, w, 2.0 * area, 2.0 * iz)
                along_flange.add(ending, features, ay / cross, ay / total_y)
                bases = (
                    walls.t_poisson_base_y(b, h, t, w, h - found.centroid_z),
                    walls.t_poisson_base_z(b, h, t, w),
                )
            for fit, c, moment, twist, share in zip(twisted[make], (cy, cz), (iz, iy), bases, shares, strict=True):
                fit.add(ending, features, c / (area * twist / moment**2), share)
    fits = [half, along_flange, *twisted[channel], *twisted[t_section]]
    return {fit.name: fit.made() for fit in fits}


def main() -> None:
    """Sample into the folder, or fit what is there and write the data file."""
    what, folder = sys.argv[1], Path(sys.argv[2])
    if what == "sample":
        junctions(folder)
        sample(folder, 512, 11, "")
        sample(folder, 128, 21, "_fresh")
        return
    save("channels", {**junction_fits(folder), **wall_fits(folder)})


if __name__ == "__main__":
    main()
