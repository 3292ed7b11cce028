"""The links of an arm as solids in a STEP file (ISO 10303-21), put together as the arm stands with all joints at 0."""

from __future__ import annotations

import io
import itertools
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.descriptions.formats import Exported
from linkwright.core.arm.placed.views import Stand, stands
from linkwright.core.sections.section import Section
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.extras import not_installed
from linkwright.core.units.quantities import InputError, shown

from .contours import Arc, Arcs, Contour, Corners, Line, Point, Ring, contours, edges

if TYPE_CHECKING:
    from build123d import Solid, Wire

Array = NDArray[np.float64]

_MADE = "2000-01-01T00:00:00"
"""A date for the head of every file, so that the same arm gives the same file."""
_SOUND = 1e-5
"""How far, relative to the whole, a solid's volume and its centre along the link may be off before it is refused."""
_ASIDE = 1e-2
"""The same of its centre across the link, relative to the section. A uniform link's is exact; the centroids of a
lopsided taper's cuts are on a curve between those of its ends, its edges are straight."""


def need_build123d() -> None:
    """Raises `InputError`, one line, where build123d cannot be used: before anything is computed."""
    try:
        import build123d  # noqa: F401  # pyright: ignore[reportUnusedImport]
    except ModuleNotFoundError:
        raise InputError("", "to", not_installed("STEP", "build123d", "step")) from None
    except (ImportError, OSError) as error:
        what = f"STEP needs build123d, which cannot be loaded here ({shown(str(error))})"
        raise InputError("", "to", f"{what}; where it lacks libGL: apt-get install libgl1") from None


def solids(arm: Arm, progress: Callable[[str, float], None] | None = None) -> dict[str, Solid]:
    """The links that have a section as solids in the base frame with all joints at 0, mm, by their names.

    Each is held against the volume and the centre that its section has by its formulas. Raises `InputError` where
    build123d is missing, or makes of a section what it is not.
    """
    tell = progress or _silent
    tell("loading build123d", 0.0)
    need_build123d()
    solids_by_name: dict[str, Solid] = {}
    for number, (link, stand) in enumerate(zip(arm.links, _places(arm), strict=True), start=1):
        tell(f"link {number}", (number - 1) / arm.size)
        if link.section is None or link.length <= 0.0:
            continue
        solid = _solid(link.section, stand)
        _check(number, link.section, stand, solid)
        solids_by_name[f"link {number}"] = solid
    return solids_by_name


def stepped(arm: Arm, progress: Callable[[str, float], None] | None = None) -> Exported:
    """The arm's links as named bodies of one assembly, AP214, in mm. Raises `InputError` where build123d is missing,
    and for an arm of which no link has a section."""
    result = solids(arm, progress)
    if not result:
        raise InputError("", "to", "no link of the arm has a section, so that there is no body to write as STEP")
    from build123d import Compound, export_step

    (progress or _silent)("writing", 1.0)
    bodies: list[Solid] = []
    for name, solid in result.items():
        solid.label = name
        bodies.append(solid)
    whole = Compound(children=bodies, label=arm.name or "arm")
    file = io.BytesIO()
    export_step(whole, file, timestamp=_MADE)
    bare = [str(k) for k in range(1, arm.size + 1) if f"link {k}" not in result]
    lost: list[str] = []
    if bare:
        verb = "is rigid and has" if len(bare) == 1 else "are rigid and have"
        lost.append(f"link{'s' * (len(bare) > 1)} {', '.join(bare)} {verb} no section to make a body of")
    lost.append("how links are joined to the joints, drives, and what hangs on links")
    carried = ("lengths and cross-sections as solid bodies, in mm", "where they stand with all joints at 0")
    counted = itertools.count(1)
    text = re.sub(
        r"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\(')\d+'",  # numbered on from file to file
        lambda match: f"{match[1]}{next(counted)}'",
        file.getvalue().decode("utf-8"),
    )
    return Exported(arm, "step", text, carried, tuple(lost), ())


def _silent(text: str, share: float) -> None:
    del text, share


def _places(arm: Arm) -> list[Stand]:
    """Where each link stands as it is made: all of its length, of one that runs out of a sleeve too."""
    return [replace(stand, length=link.length) for stand, link in zip(stands(arm), arm.links, strict=True)]


def _solid(section: Section, stand: Stand) -> Solid:
    from build123d import Face, Solid, Vector

    if not isinstance(section, Tapered):
        outer, *holes = (_wire(contour, stand, 0.0) for contour in contours(section))
        return Solid.extrude(Face(outer, holes), Vector(*(1e3 * stand.length * stand.along)))
    cuts = [_aligned(section, share) for share in _CUTS]
    outer, *holes = (_loft(item, stand) for item in zip(*cuts, strict=True))
    if not holes:
        return outer
    (left,) = (outer - holes).solids()
    return left


_CUTS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Shares of a link's length at which a hole is given that no straight lines make."""


def _aligned(section: Tapered, share: float) -> list[Contour]:
    """The edges of a taper's cut, whose outer corners are moved onto the straight lines between those of its ends."""
    outer, *holes = contours(section.cut(share))
    if not isinstance(outer, Corners):
        return [outer, *holes]
    near, far = (contours(end)[0] for end in (section.near, section.far))
    assert isinstance(near, Corners)  # both are of one shape
    assert isinstance(far, Corners)
    first, last, start = near.points[0], far.points[0], outer.points[0]
    step = tuple(a + share * (b - a) - c for a, b, c in zip(first, last, start, strict=True))
    return [
        Corners(tuple((y + step[0], z + step[1]) for y, z in hole.points), hole.radii)
        if isinstance(hole, Corners)
        else hole
        for hole in (outer, *holes)
    ]


def _loft(cuts: Sequence[Contour], stand: Stand) -> Solid:
    """The solid between the cuts of one edge: by straight lines where they make it."""
    from build123d import Solid

    keep: tuple[bool, ...] = ()
    if any(isinstance(cut, Corners) and any(cut.radii) for cut in cuts):
        radii = [cut.radii for cut in cuts if isinstance(cut, Corners)]
        keep = tuple(any(at) for at in zip(*radii, strict=True))
    wires = [_wire(cut, stand, share, keep) for cut, share in zip(cuts, _CUTS, strict=True)]
    ends, middle = (_figures(cuts[0]), _figures(cuts[-1])), _figures(cuts[len(cuts) // 2])
    straight = np.allclose(0.5 * (ends[0] + ends[1]), middle, rtol=0.0, atol=1e-9)
    return Solid.make_loft([wires[0], wires[-1]] if straight else wires, ruled=bool(straight))


def _figures(contour: Contour) -> Array:
    """All that makes an edge, m."""
    match contour:
        case Ring():
            return np.array([contour.across, contour.high])
        case Corners():
            return np.array([*np.ravel(contour.points), *contour.radii])
        case Arcs():
            return np.ravel([(arc.first, arc.middle) for arc in contour.arcs])


def _wire(contour: Contour, stand: Stand, share: float, keep: Sequence[bool] = ()) -> Wire:
    from build123d import Edge, Plane, Wire

    def at(point: Point) -> tuple[float, float, float]:
        x, y, z = (float(item) for item in 1e3 * stand.at(share, np.array([point]))[0])
        return x, y, z

    match contour:
        case Ring():
            # An ellipse is distinguished from a circle by its axes: the longer one leads.
            plane = Plane(at((0.0, 0.0)), x_dir=tuple(stand.width), z_dir=tuple(np.cross(stand.width, stand.height)))
            if math.isclose(contour.across, contour.high, rel_tol=1e-12):
                return Wire([Edge.make_circle(1e3 * contour.across, plane)])
            return Wire([Edge.make_ellipse(1e3 * contour.across, 1e3 * contour.high, plane)])
        case Arcs():
            pieces: Sequence[Line | Arc] = contour.arcs
        case Corners():
            pieces = edges(contour, keep)
    return Wire(
        [
            Edge.make_line(at(piece.first), at(piece.second))
            if isinstance(piece, Line)
            else Edge.make_three_point_arc(at(piece.first), at(piece.middle), at(piece.second))
            for piece in pieces
        ]
    )


def _check(number: int, section: Section, stand: Stand, solid: Solid) -> None:
    """Hold a solid against the areas of its section, which are formulas of their own. Raises `InputError`."""
    points, weights = leggauss(12)
    share = 0.5 * (points + 1.0)
    if isinstance(section, Tapered):
        area = np.broadcast_to(np.asarray(section.along(share, 0.3).area, dtype=float), share.shape)
    else:
        area = np.full_like(share, float(section.properties(0.3).area))
    mean = float(0.5 * weights @ area)
    balance = float(0.5 * weights @ (area * share)) / mean
    center = np.array(tuple(solid.center())) / 1e3 - stand.joint
    whole = section.properties(0.3)
    aside = float(np.hypot(center @ stand.width, center @ stand.height)) / float(np.hypot(whole.width, whole.height))
    off = {
        "its volume": solid.volume / 1e9 / (mean * stand.length) - 1.0,
        "its centre along the link": center @ stand.along / stand.length - balance,
        "its centre across the link": max(0.0, aside - (_ASIDE if isinstance(section, Tapered) else _SOUND)),
    }
    for what, error in off.items():
        if not abs(error) <= _SOUND or not solid.is_valid:
            message = f"link {number} would be wrong as a solid: {what} is off by {error:.2g}; nothing was written"
            raise InputError("", "to", message)
