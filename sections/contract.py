"""The contract of every shape, shipped or registered: its formulas, its outline and its walls say the same."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import fields
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from linkwright.core.sections.formulas.outlines import Outlined, about_centroid, with_shear
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.properties import POWERS, SectionProperties
from linkwright.core.sections.section import Section, SectionError, poisson_square
from linkwright.core.units.quantities import InputError

_SECTIONS, _DRAWS = 4, 200
_POISSON = 0.3
_ALIKE = 1e-6
"""By how much numbers, arrays, symbols and other sizes may differ, relative."""
_TOLERANCES: Mapping[str, float] = MappingProxyType(
    {
        "area": 0.005,
        "second_moment_y": 0.01,
        "second_moment_z": 0.01,
        "torsion_constant": 0.03,
        "shear_area_y": 0.04,
        "shear_area_z": 0.04,
        "section_modulus_y": 0.01,
        "section_modulus_z": 0.01,
        "torsion_modulus": 0.4,
        "plastic_modulus_y": 0.01,
        "plastic_modulus_z": 0.01,
        "extreme_fibre_y": 0.01,
        "extreme_fibre_z": 0.01,
        "width": 0.005,
        "height": 0.005,
        "centroid_y": 0.01,
        "centroid_z": 0.01,
    }
)
"""By how much closed forms may differ from the outline, whose curves are chords; relative. Torsion moduli leave the
corners of a hollow out."""
_CENTRE, _WARPING, _PRODUCT = 0.01, 0.2, 0.01
"""The same of the shear centre (of the height), of the warping constant, and of the product moment (of I)."""
_SLIGHT = 0.02
"""Of J times the square of the height: a warping constant that is felt over a fifth of the height at most."""
_SIZE = 0.02
"""By how much sizes of walls and of the bore may differ from the outline, relative."""
_GRID, _ZOOMS = 33, 6
"""Points a side at which the largest circle of a hollow is sought, and how often about the best at a quarter's size."""


def check_shape(kind: type[Section], *given: Section) -> None:
    """Raise `InputError` with one line that lists all that is wrong with a shape.

    On some sections of random dimensions, or those `given`: properties against the outline's area and moments and a
    boundary element solution of torsion and shear within it (J within 3 %, shear areas within 4 %, the shear centre
    within 1 % of the height, the torsion modulus within 40 %); the outline closed, about the centroid, of plain
    numbers and within the greatest radius; each property grows with its power of the size; floats, arrays and CasADi's
    symbols give the same; flat walls lie in the material, as thick and as wide as they say; the bore is the largest
    circle of a hollow. Seconds. A shape need not be registered.
    """
    faults: list[str] = []
    try:
        random = np.random.default_rng(20261128)
        sections = given or tuple(drawn(kind, random) for _ in range(_SECTIONS))
        faults = [fault for section in sections for fault in _faults(section)]
    except SectionError as error:
        faults = [str(error)]
    if faults:
        raise InputError("", f"shape {kind.shape}", "; ".join(dict.fromkeys(faults)))


def drawn(
    kind: type[Section], random: np.random.Generator, *, walls: tuple[float, float] = (0.03, 0.3), spread: float = 2.0
) -> Section:
    """A section of random dimensions that are not optional: outer sizes up to 100 mm, apart by `spread` at most, and
    walls of these shares of what would leave nothing open. Raises SectionError where none of many is possible."""
    needed = [dimension for dimension in kind.dimensions if not dimension.optional]
    if any(dimension.kind not in ("outer", "wall") for dimension in needed):
        raise SectionError("shape", "has dimensions that cannot be drawn at random; give sections to check")
    for _ in range(_DRAWS):
        sizes = {item.name: 0.1 * spread ** -random.uniform() for item in needed if item.kind == "outer"}
        most = min(kind.most_wall, 0.5) * min(sizes.values(), default=0.1)
        for item in needed:
            if item.kind == "wall":
                sizes[item.name] = most * math.exp(random.uniform(*np.log(walls)))
        section = kind(**sizes)
        if not section.check():
            return section
    raise SectionError("shape", f"no dimensions with outer sizes from {100.0 / spread:.3g} to 100 mm are possible")


def _faults(section: Section) -> Iterator[str]:
    loops = section.outline()
    if any(loop.dtype != np.float64 or loop.ndim != 2 or loop.shape[1] != 2 for loop in loops):
        yield "its outline is not of arrays (N, 2) of plain numbers"
        return
    if any(not np.allclose(loop[0], loop[-1], rtol=0.0, atol=1e-9) for loop in loops):
        yield "its outline is not closed"
        return
    stated = section.properties(_POISSON)
    central = about_centroid([loop[:-1] for loop in loops])
    height = float(stated.height)
    if np.abs(central[0].max(axis=0) - loops[0].max(axis=0)).max() > _CENTRE * height:
        yield "its outline is not about the centroid"
    farthest = max(float(np.linalg.norm(loop, axis=1).max()) for loop in loops)
    if not section.greatest_radius >= farthest * (1.0 - _CENTRE):
        radius = f"{1e3 * float(section.greatest_radius):.4g} mm"
        yield f"its greatest radius is {radius} where its outline has {1e3 * farthest:.4g} mm"
    yield from _by_outline(section, stated, central)
    yield from _alike(section, stated)
    yield from _walls(section, loops, stated)


def _by_outline(section: Section, stated: SectionProperties, loops: list[Array]) -> Iterator[str]:
    solved = with_shear(Outlined(loops).figures, poisson_square(_POISSON))
    height, second_moment = float(solved.height), float(solved.second_moment_y)
    compared = [(name, share, getattr(solved, name)) for name, share in _TOLERANCES.items()]
    compared += [(name, _CENTRE, height) for name in ("shear_centre_y", "shear_centre_z")]
    compared.append(("product_moment_yz", _PRODUCT, second_moment))
    slight = _SLIGHT * float(solved.torsion_constant) * height**2
    if solved.warping_constant > slight:
        compared.append(("warping_constant", _WARPING, solved.warping_constant))
    for name, share, scale in compared:
        value, expected = float(getattr(stated, name)), float(getattr(solved, name))
        if not abs(value - expected) <= share * abs(float(scale)):
            sizes = ", ".join(f"{key} {1e3 * item:.4g} mm" for key, item in section.given().items())
            yield f"{name} of {sizes} is {value:.4g} where its outline has {expected:.4g} (SI)"


def _alike(section: Section, stated: SectionProperties) -> Iterator[str]:
    """Other sizes, arrays and symbols give what a float gives."""
    names = [item.name for item in fields(SectionProperties)]
    expected = np.array([float(getattr(stated, name)) for name in names])
    height = float(stated.height)
    scales = np.maximum(np.abs(expected), _ALIKE * np.array([height ** POWERS[name] for name in names]))
    twice = section.scaled(2.0).properties(_POISSON)
    grown = np.array([float(getattr(twice, name)) / 2.0 ** POWERS[name] for name in names])
    for name in np.array(names)[np.abs(grown - expected) > _ALIKE * scales].tolist():
        yield f"{name} does not grow with power {POWERS[name]} of the size"
    if not section.variables:
        return
    import casadi as ca

    values = [float(value) for value in section.variable_values()]
    arrays = type(section).from_variables([np.array([value, value]) for value in values]).properties(_POISSON)
    column = ca.SX.sym("x", len(values))
    symbols = type(section).from_variables(ca.vertsplit(column)).properties(_POISSON)
    by_symbol = ca.Function("f", [column], [ca.vertcat(*(ca.SX(getattr(symbols, name)) for name in names))])
    for what, got in (
        ("arrays", np.array([np.broadcast_to(getattr(arrays, name), 2)[1] for name in names])),
        ("symbols", by_symbol(values).full().ravel()),
    ):
        for name in np.array(names)[~(np.abs(got - expected) <= _ALIKE * scales)].tolist():
            yield f"{name} by {what} is not that by numbers"


def _walls(section: Section, loops: list[Array], stated: SectionProperties) -> Iterator[str]:
    """Flat walls are as thick as the material across their middle and as wide as their ends are apart, or by a corner
    wider; and the bore fits."""
    corner = np.array([float(stated.centroid_y), float(stated.centroid_z)])
    for wall in section.wall_parts("internal") or ():
        if wall.ends is None:
            continue
        start, end = (np.array(point, dtype=float) - corner for point in wall.ends)
        middle, apart = 0.5 * (start + end), float(np.linalg.norm(end - start))
        if sum(_encloses(loop, middle) for loop in loops) != 1:
            yield f"the middle of its wall '{wall.name}' does not lie in the material"
            continue
        thickness, width = float(wall.thickness), float(wall.width)
        drawn = _across(loops, middle, np.array([start[1] - end[1], end[0] - start[0]]) / apart)
        if not abs(thickness - drawn) <= _SIZE * drawn:
            yield f"its wall '{wall.name}' is {1e3 * thickness:.4g} mm thick where its outline has {1e3 * drawn:.4g} mm"
        if not -_SIZE * apart <= width - apart <= thickness + _SIZE * apart:
            yield f"its wall '{wall.name}' is {1e3 * width:.4g} mm wide and its ends are {1e3 * apart:.4g} mm apart"
    if section.inner_diameter is not None:
        bore, most = float(section.inner_diameter), max((_largest_circle(loop) for loop in loops[1:]), default=0.0)
        if not abs(bore - most) <= _SIZE * most:
            yield f"its inner diameter is {1e3 * bore:.4g} mm where its outline has {1e3 * most:.4g} mm"


def _across(loops: list[Array], point: Array, direction: Array) -> float:
    """How much material a line through a point of it crosses there, m."""
    crossings: list[Array] = []
    for loop in loops:
        side = (loop - point) @ np.array([-direction[1], direction[0]])
        along = (loop - point) @ direction
        cut = (side[:-1] > 0.0) != (side[1:] > 0.0)
        share = side[:-1][cut] / (side[:-1][cut] - side[1:][cut])
        crossings.append(along[:-1][cut] + share * (along[1:][cut] - along[:-1][cut]))
    places = np.concatenate(crossings)
    return float(places[places > 0.0].min(initial=np.inf) - places[places <= 0.0].max(initial=-np.inf))


def _largest_circle(loop: Array) -> float:
    """Diameter of the largest circle within a closed loop, m."""
    low, high = loop.min(axis=0), loop.max(axis=0)
    centre, half, best = 0.5 * (low + high), 0.5 * (high - low), 0.0
    edges = np.diff(loop, axis=0)
    squares = np.maximum(np.sum(edges**2, axis=1), 1e-30)
    for _ in range(_ZOOMS):
        sides = [np.linspace(-size, size, _GRID) for size in half]
        points = centre + np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2)
        points = points[_encloses(loop, points)]
        if not len(points):
            break
        offsets = points[:, None, :] - loop[:-1]
        share = np.clip(np.einsum("pea,ea->pe", offsets, edges) / squares, 0.0, 1.0)
        radii = np.linalg.norm(offsets - share[:, :, None] * edges, axis=2).min(axis=1)
        centre, half, best = points[radii.argmax()], 0.25 * half, max(best, 2.0 * float(radii.max()))
    return best


def _encloses(loop: Array, points: Array) -> NDArray[np.bool_]:
    """Whether a loop runs around points (..., 2): the turn that it makes about each."""
    offset = loop - points[..., None, :]
    turn = np.diff(np.unwrap(np.arctan2(offset[..., 1], offset[..., 0])))
    return np.abs(turn.sum(axis=-1)) > math.pi
