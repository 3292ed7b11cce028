"""Each fit says where it holds, how well and what made it, and is as good as it says."""

import json
import math
import re
from functools import cache
from importlib.resources import files

import numpy as np
import pytest

from linkwright.core.sections import SHAPES, Section
from linkwright.core.sections.fits.fit import FILES, Fit, fits
from linkwright.core.sections.formulas.saint_venant import SaintVenant, solve

POINTS = 2
SOLVER_ERROR = 2e-4
"""What the solver itself leaves at this fineness, on a slender rectangle."""
CHORD_ERROR = 4e-3
"""What the chords of a drawn fillet take away."""


def test_every_fit_tells_its_range_error_and_command() -> None:
    for name, fit in fits().items():
        assert fit.shape in SHAPES, name
        # How much held warping stiffens goes with the root of its constant, at most.
        assert 0.0 < fit.error < (0.04 if fit.figure == "warping_constant" else 0.02), name
        assert fit.range, name
        assert all(0.0 < low < high for low, high in fit.range.values()), name
        assert re.match(r"python -m benchmarks\.section_fits[. ]", fit.command), name


def test_no_name_comes_twice() -> None:
    names = [
        name
        for file in FILES
        for name in json.loads(files("linkwright.core.sections.fits").joinpath(f"{file}.json").read_text("utf-8"))
    ]
    assert sorted(names) == sorted(fits())


@cache
def sample(shape: str, ratios: tuple[tuple[str, float, float], ...], number: int) -> tuple[Section, SaintVenant]:
    """A section in the range of a fit, 10 % inside its ends, and what boundary elements say of it."""
    random = np.random.default_rng([number, *shape.encode()])
    size = {"height": 1.0} if any("/ height" in ratio for ratio, _, _ in ratios) else {"width": 1.0}
    for ratio, low, high in ratios:
        part, of = ratio.split(" / ")
        base = size.get(of, math.nan)
        if of == "shorter leg":
            base = min(size["width"], size["height"])
        elif of == "inscribed radius":
            base = size["width"] / (size["width"] + math.hypot(size["width"], 2.0))
        size[part] = base * float(np.exp(random.uniform(math.log(1.1 * low), math.log(high / 1.1))))
    section = SHAPES[shape](**size)
    return section, solve([loop[:-1] for loop in section.outline()])


@pytest.mark.parametrize("number", range(POINTS))
@pytest.mark.parametrize("name", sorted(fits()))
def test_figure_is_within_the_error(name: str, number: int) -> None:
    fit: Fit = fits()[name]
    section, solved = sample(fit.shape, tuple((key, *ends) for key, ends in fit.range.items()), number)
    for ratio in (0.0, 0.45):
        result = section.properties(ratio)
        square = (ratio / (1.0 + ratio)) ** 2
        expected = {
            "torsion_constant": solved.torsion_constant,
            "torsion_modulus": solved.torsion_modulus,
            "shear_area_y": result.area / (solved.shear_y[0] + square * solved.shear_y[1]),
            "shear_area_z": result.area / (solved.shear_z[0] + square * solved.shear_z[1]),
            "shear_centre_y": solved.shear_centre[0],
            "shear_centre_z": solved.shear_centre[1],
            "warping_constant": solved.warping_constant,
        }[fit.figure]
        if fit.figure == "shear_centre_z":  # which may be at the centroid
            assert result.shear_centre_z == pytest.approx(expected, abs=(fit.error + SOLVER_ERROR) * result.height)
            continue
        own = CHORD_ERROR if "root_radius / flange_thickness" in fit.range else SOLVER_ERROR
        assert getattr(result, fit.figure) == pytest.approx(expected, rel=fit.error + own)
