"""Fits to boundary elements: `python -m benchmarks.section_fits FOLDER`.

Writes files for `sections/fits` into the folder: `hexagons.json` with torsion and shear of the hexagonal tube, and
`shear_centres.json` with shear centres and warping constants of others. Each fit is a polynomial of a total degree in
bounded features of a shape, by least squares over random sections in its range; its error is the greatest over others.
"""

from __future__ import annotations

import itertools
import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from linkwright.core.sections import SHAPES, Section
from linkwright.core.sections.formulas import open_walls as closed
from linkwright.core.sections.formulas.saint_venant import SaintVenant, moments, solve
from linkwright.core.sections.numeric import Array, polynomial

COMMAND = "python -m benchmarks.section_fits FOLDER"
FINENESS = 1.0
_HELD_OUT = 20

Sizes = Mapping[str, float]


@dataclass(frozen=True)
class Wanted:
    """A fit: its shape and figure, ranges of ratios, total degree, features and what is fitted, of sizes and solution.

    With `plain` the target itself is fitted, over the height; else its logarithm. `fitted` sections are, and
    others held out.
    """

    shape: str
    figure: str
    range: Mapping[str, tuple[float, float]]
    degree: int
    features: Callable[[Sizes], tuple[float, ...]]
    target: Callable[[Sizes, Section, SaintVenant], float]
    plain: bool = False
    fitted: int = 180


def _walls(low: float, high: float) -> dict[str, tuple[float, float]]:
    return {
        "width / height": (low, high),
        "flange_thickness / height": (0.01, 0.25),
        "web_thickness / width": (0.01, 0.25),
    }


def _open(s: Sizes) -> tuple[float, float, float, float]:
    return s["width"], s["height"], s["flange_thickness"], s["web_thickness"]


def _features(s: Sizes) -> tuple[float, ...]:
    return closed.walled_features(*_open(s))


def _angle(s: Sizes) -> tuple[float, float, float]:
    return s["width"], s["height"], s["thickness"]


def _of(figure: str) -> Callable[[Section], float]:
    return lambda section: float(getattr(section.properties(0.3), figure))


def _channel_centre(s: Sizes, section: Section, solved: SaintVenant) -> float:
    base = closed.channel_shear_centre_base(*_open(s), _of("centroid_y")(section))
    return math.log(-solved.shear_centre[0] / base)


def _t_centre(s: Sizes, section: Section, solved: SaintVenant) -> float:
    base = closed.t_shear_centre_base(*_open(s), s["height"] - _of("centroid_z")(section))
    return (solved.shear_centre[1] - base) / s["height"]


def _angle_centre(s: Sizes, section: Section, solved: SaintVenant) -> float:
    return math.log(-solved.shear_centre[0] / (_of("centroid_y")(section) - 0.5 * s["thickness"]))


def _warping(base: Callable[[Sizes], float]) -> Callable[[Sizes, Section, SaintVenant], float]:
    return lambda s, _, solved: math.log(solved.warping_constant / base(s))


def _inner(s: Sizes) -> float:
    radius = s["width"] * s["height"] / (s["width"] + math.hypot(s["width"], 2.0 * s["height"]))
    return 1.0 - s["thickness"] / radius


def _hollow(s: Sizes) -> float:
    return 1.0 - 2.0 * s["thickness"] / s["height"]


_LEGS = {"width / height": (0.3, 3.5), "thickness / shorter leg": (0.01, 0.25)}

_HEXAGON = {"thickness / height": (0.01, 0.45)}


def _hexagon(figure: str, degree: int, target: Callable[[float, SaintVenant], float]) -> Wanted:
    """A fit of a hexagonal tube of height one by the size of its hollow."""
    return Wanted(
        "hexagonal_tube",
        figure,
        _HEXAGON,
        degree,
        lambda s: (_hollow(s),),
        lambda s, _, solved: target(_hollow(s), solved),
        plain=True,
        fitted=40,
    )


FITS: Mapping[str, Wanted] = {
    "hexagon_torsion": _hexagon("torsion_constant", 8, lambda hollow, it: it.torsion_constant / (1.0 - hollow**4)),
    "hexagon_shear": _hexagon("shear_area_y", 8, lambda _, it: it.shear_y[0]),
    "hexagon_poisson": _hexagon("shear_area_z", 6, lambda hollow, it: it.shear_y[1] / (1.0 - hollow**2) ** 2),
    "channel_shear_centre": Wanted("channel", "shear_centre_y", _walls(0.2, 1.6), 5, _features, _channel_centre),
    "channel_warping": Wanted(
        "channel",
        "warping_constant",
        _walls(0.2, 1.6),
        5,
        _features,
        _warping(lambda s: closed.channel_warping_base(*_open(s))),
    ),
    "t_shear_centre": Wanted("t_section", "shear_centre_z", _walls(0.6, 3.0), 5, _features, _t_centre, plain=True),
    "angle_shear_centre": Wanted(
        "angle", "shear_centre_y", _LEGS, 5, lambda s: closed.angle_features(*_angle(s)), _angle_centre
    ),
    "angle_warping": Wanted(
        "angle",
        "warping_constant",
        _LEGS,
        5,
        lambda s: (closed.angle_features(*_angle(s))[0] ** 2, closed.angle_features(*_angle(s))[1]),
        _warping(lambda s: closed.angle_warping_base(*_angle(s))),
    ),
    "i_section_warping": Wanted(
        "i_section",
        "warping_constant",
        _walls(0.3, 3.0),
        5,
        _features,
        _warping(lambda s: closed.i_warping_base(*_open(s)[:3])),
    ),
    "triangle_shear_centre": Wanted(
        "triangle",
        "shear_centre_z",
        {"width / height": (0.1, 10.0)},
        9,
        lambda s: (s["width"] / (s["width"] + s["height"]),),
        lambda s, _, solved: solved.shear_centre[1] / s["height"],
        plain=True,
    ),
    "triangular_tube_shear_centre": Wanted(
        "triangular_tube",
        "shear_centre_z",
        {"width / height": (0.3, 3.5), "thickness / inscribed radius": (0.05, 0.75)},
        7,
        lambda s: (s["width"] / (s["width"] + s["height"]), _inner(s)),
        lambda s, _, solved: solved.shear_centre[1] / s["height"],
        plain=True,
    ),
}

FILES = {
    "hexagons": [name for name in FITS if name.startswith("hexagon")],
    "shear_centres": [name for name in FITS if not name.startswith("hexagon")],
}


def drawn(wanted: Wanted, random: np.random.Generator) -> dict[str, float]:
    """Random sizes of height one in the range of a fit."""
    sizes = {"height": 1.0}
    for ratio, (low, high) in wanted.range.items():
        part, of = ratio.split(" / ")
        if of == "shorter leg":
            base = min(sizes["width"], 1.0)
        elif of == "inscribed radius":
            base = sizes["width"] / (sizes["width"] + math.hypot(sizes["width"], 2.0))
        else:
            base = sizes[of]
        # Even in the ratio's logarithm, with the ends drawn as often as all between in each tenth.
        share = min(max(float(random.uniform(-0.1, 1.1)), 0.0), 1.0)
        sizes[part] = base * low * (high / low) ** share
    return sizes


def solved_for(shape: str, sizes: Sizes) -> tuple[Section, SaintVenant]:
    """The section of these sizes, and the boundary element solution about the centroid of its outline."""
    section = SHAPES[shape](**sizes)
    loops = [loop[:-1] for loop in section.outline()]
    m = moments(loops)
    return section, solve([loop - np.array([m.first_y, m.first_z]) / m.area for loop in loops], FINENESS)


def _powers(count: int, degree: int) -> list[tuple[int, ...]]:
    return [p for p in itertools.product(range(degree + 1), repeat=count) if sum(p) <= degree]


def _nested(values: Mapping[tuple[int, ...], float], count: int, degree: int, before: tuple[int, ...] = ()) -> Any:
    if count == 0:
        return float(f"{values[before]:.10g}")
    room = degree - sum(before)
    return [_nested(values, count - 1, degree, (*before, k)) for k in range(room + 1)]


def fit_all(names: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Every fit of these names, as `sections/fits` holds them."""
    entries: dict[str, dict[str, Any]] = {}
    samples: dict[tuple[str, str], list[tuple[dict[str, float], Section, SaintVenant]]] = {}
    for name in names:
        wanted = FITS[name]
        key = (wanted.shape, str(wanted.range))
        if key not in samples:
            random = np.random.default_rng(20261128)
            sizes = [drawn(wanted, random) for _ in range(wanted.fitted + _HELD_OUT)]
            samples[key] = [(s, *solved_for(wanted.shape, s)) for s in sizes]
        rows = samples[key]
        features = np.array([wanted.features(s) for s, _, _ in rows])
        targets = np.array([wanted.target(*row) for row in rows])
        powers = _powers(features.shape[1], wanted.degree)
        matrix: Array = np.stack([np.prod(features ** np.array(p), axis=1) for p in powers], axis=1)
        found = np.linalg.lstsq(matrix[: wanted.fitted], targets[: wanted.fitted], rcond=1e-12)[0]
        nested = _nested(dict(zip(powers, found.tolist(), strict=True)), features.shape[1], wanted.degree)
        rest = np.array([polynomial(nested, tuple(row)) for row in features.tolist()]) - targets
        inside, beside = np.abs(rest[: wanted.fitted]).max(), np.abs(rest[wanted.fitted :]).max()
        print(f"{name}: fitted {inside:.2e}, others {beside:.2e}", flush=True)
        entries[name] = {
            "shape": wanted.shape,
            "figure": wanted.figure,
            "range": {ratio: list(ends) for ratio, ends in wanted.range.items()},
            "error": float(f"{1.5 * np.abs(rest).max():.1g}"),
            "command": COMMAND,
            "coefficients": nested,
        }
    return entries


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for file, names in FILES.items():
        chosen = [name for name in names if name in (sys.argv[2:] or names)]
        if chosen:
            (folder / f"{file}.json").write_text(json.dumps(fit_all(chosen), indent=1) + "\n")
