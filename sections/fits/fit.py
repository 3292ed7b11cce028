"""The fits by name, read once from the data files beside this module, from boundary and spectral elements."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from linkwright.core.sections.numeric import Number, polynomial

FILES = ("closed_and_i", "open_sections", "channels", "shear_centres", "hexagons")
"""The data files. `benchmarks.section_fits` makes the last two, modules of that name at commit 068436f the others."""


@dataclass(frozen=True)
class Fit:
    """A polynomial in dimensionless features of a shape that corrects a formula for one of its figures.

    Attributes:
        shape: the shape on which it is checked.
        figure: the figure of that shape that it enters.
        range: least and greatest ratio of dimensions, by `width / height` and the like, in which `error` holds.
        error: greatest relative error of the figure at any Poisson's ratio from 0 to 0.45; of a shear centre that may
            be at the centroid over the height.
        command: what made the coefficients.
        coefficients: nested as `sections.numeric.polynomial` takes them.
    """

    shape: str
    figure: str
    range: Mapping[str, Sequence[float]]
    error: float
    command: str
    coefficients: Sequence[Any]


@cache
def fits() -> Mapping[str, Fit]:
    """Every fit by name."""
    texts = (
        files("linkwright.core.sections.fits").joinpath(f"{name}.json").read_text(encoding="utf-8") for name in FILES
    )
    return MappingProxyType({name: Fit(**entry) for text in texts for name, entry in json.loads(text).items()})


def coefficients(name: str) -> Sequence[Any]:
    """The coefficients of the fit of that name."""
    return fits()[name].coefficients


def fitted(name: str, features: Sequence[Number]) -> Number:
    """The polynomial of the fit of that name at these features."""
    return polynomial(coefficients(name), features)
