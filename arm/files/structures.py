"""Links beside plain beams, as an arm file gives them.

A 6 x 6 stiffness is a table (CSV) from finite elements, or its rows in place; a flange gives between a link's far end
and all that follows; a slide runs along a beam held at both ends; a boom or mast runs out of a sleeve, and bends over
its slide's coordinate (`bends_over`).
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np

from linkwright.core.arm.chain.balance import PointMass
from linkwright.core.arm.chain.chain import Flange, FloatVector, GuideBeam, Joint, Link, Matrix, asymmetry_of
from linkwright.core.arm.chain.vectors import add, cross, dot, norm, scale, subtract, unit
from linkwright.core.arm.files.origin import read_vector
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.materials.material import Material
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.section import Section
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import InputError, format_quantity, shown
from linkwright.core.units.reading import Mapping, read_text

AXES = ("fx", "fy", "fz", "mx", "my", "mz")
"""Rows and columns: forces with displacements, moments with rotations, along the axes of the link's frame."""
_SYMMETRIC = 1e-4
"""By how much of the geometric mean of the diagonal's entries two opposite ones may differ: digits of a printout."""
_LEAST = 1e-12
_TO_M = np.array([1e-3, 1e-3, 1e-3, 1.0, 1.0, 1.0])
_TO_NMM = np.array([1.0, 1.0, 1.0, 1e3, 1e3, 1e3])
"""What a displacement in mm is in m, and a moment in N*m in N*mm; a force and a rotation stay."""


def read_stiffness(link: Mapping) -> Matrix | None:
    """The compliance of a link's far end (rows for m and rad, columns for N and N*m) from its stiffness in N, mm and
    rad; None where the link has none. Raises `InputError` where it is no stiffness."""
    if not link.has("stiffness"):
        return None
    raw = link.raw("stiffness")
    if isinstance(raw, str):
        path = Path(str(link.file)).parent / raw
        rows, file, key = _table(path), cast(object, path), ""
    else:
        rows, file, key = raw, link.file, link.path_of("stiffness")
    matrix = _numbers(rows, file, key)
    _check(matrix, file, key)
    compliance = _TO_M[:, None] * np.linalg.inv(matrix) * _TO_NMM[None, :]
    compliance = 0.5 * (compliance + compliance.T)
    return tuple(tuple(row) for row in compliance.tolist())


def stiffness_rows(compliance: Matrix) -> list[list[float]]:
    """The stiffness (N, mm, rad) of a compliance (m, rad by N, N*m), as an arm file has its rows."""
    matrix = np.linalg.inv(np.array(compliance) / _TO_M[:, None] / _TO_NMM[None, :])
    return [[float(f"{value:.12g}") for value in row] for row in (0.5 * (matrix + matrix.T)).tolist()]


def _table(path: Path) -> list[list[str]]:
    try:
        reader = csv.reader(io.StringIO(read_text(path), newline=""), skipinitialspace=True, strict=True)
        rows = [[cell.strip() for cell in row] for row in reader if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise InputError(path, "", f"is no table: {error}") from None
    names = [cell.lower() for cell in rows[0]] if rows else []
    if any(name in AXES for name in names):
        if tuple(name for name in names if name) != AXES:
            raise InputError(
                path, "line 1", f"needs the columns {', '.join(AXES)} in this order, not {', '.join(names)}"
            )
        rows = rows[1:]
    if rows and all(row[0].lower() == name for row, name in zip(rows, AXES, strict=False)):
        rows = [row[1:] for row in rows]
    return rows


def _numbers(rows: object, file: object, key: str) -> Array:
    entries = cast(list[object], rows) if isinstance(rows, list) else []
    wrong = len(entries) != 6 or any(not isinstance(row, list) or len(cast(list[object], row)) != 6 for row in entries)
    if wrong:
        message = f"needs 6 rows of 6 numbers ({', '.join(AXES)}; N, mm, rad), or a CSV of them"
        raise InputError(file, key, message)
    matrix = np.empty((6, 6))
    for i, row in enumerate(cast(list[list[object]], entries)):
        for j, value in enumerate(row):
            try:
                matrix[i, j] = float(str(value))
            except ValueError:
                matrix[i, j] = np.nan
            if not np.isfinite(matrix[i, j]):
                place = f"row {AXES[i]}, column {AXES[j]}"
                raise InputError(file, key, f"needs a number in {place} (N, mm, rad), not {shown(value)}")
    return matrix


def _check(matrix: Array, file: object, key: str) -> None:
    """Refuse what is no stiffness: one that differs from its transpose, or gives way by itself."""
    diagonal = np.diag(matrix)
    if (diagonal <= 0.0).any():
        name = AXES[int(np.argmin(diagonal))]
        raise InputError(file, key, f"is not positive: row {name}, column {name} must be above zero, as a stiffness is")
    scale = np.sqrt(np.outer(diagonal, diagonal))
    off = np.abs(matrix - matrix.T) / scale
    i, j = (int(k) for k in np.unravel_index(int(off.argmax()), off.shape))
    if off[i, j] > _SYMMETRIC:
        pair = f"row {AXES[i]}, column {AXES[j]} is {matrix[i, j]:g}, the other way round {matrix[j, i]:g}"
        raise InputError(file, key, f"is not symmetric: {pair}; a stiffness is, by Maxwell and Betti")
    if np.linalg.eigvalsh(0.5 * (matrix + matrix.T) / scale)[0] < _LEAST:
        raise InputError(file, key, "is not positive definite: some load would move the far end against itself")


_STIFFNESSES = ("tilting_stiffness", "torsional_stiffness")


def read_flange(link: Mapping) -> tuple[Flange | None, tuple[PointMass, ...]]:
    """A link's flange where it gives (None: rigid, or none), and its mass at the far end. Raises `InputError`."""
    if not link.has("flange"):
        return None, ()
    with link.mapping("flange").reading() as body:
        values = {name: body.optional_quantity(name, "torsional_stiffness") for name in _STIFFNESSES}
        for name, value in values.items():
            if value is not None and value <= 0.0:
                raise body.error(name, "must be positive; leave it out where the flange is rigid")
        mass = body.not_negative("mass", "mass", 0.0)
        if not mass and not any(values.values()):
            raise body.error("", "says nothing; give tilting_stiffness, torsional_stiffness or mass")
    flange = Flange(**values) if any(values.values()) else None
    return flange, (PointMass(mass, on="end"),) if mass else ()


_HAIR = 1e-9


def running_out(body: Mapping, joint: Joint, link: Link, number: int) -> Link:
    """A link of joint `number` (from 1) that `bends_over` its slide's coordinate. Raises `InputError` unless the joint
    is a slide along the link, which has a section and is long enough for its range."""
    named = body.text("bends_over")
    if named != f"q{number}":
        message = f"names the slide that carries the link, here q{number}, not {shown(named)}"
        raise body.error("bends_over", f"{message}; write what runs out of a sleeve as the link of its own slide")
    if joint.revolute:
        raise body.error(
            "bends_over", f"needs a slide, and joint {number} turns; write joint: {{type: prismatic, ...}}"
        )
    if joint.follows is not None:
        raise body.error("bends_over", f"needs a slide with a coordinate of its own, and joint {number} follows others")
    if link.section is None:
        raise body.error("bends_over", "needs a link that gives: write its section and material")
    if isinstance(link.section, Tapered):
        raise body.error("bends_over", "needs a section that is the same all along, not a tapered one")
    if not body.has("direction"):
        link = replace(link, direction=joint.axis)
    apart = norm(add(link.direction, scale(-1.0, joint.axis)))
    if apart > _HAIR or dot(link.direction, joint.axis) <= 0.0:
        raise body.error("bends_over", "needs a link that slides along itself: its direction must be the joint's axis")
    least, most = (end + joint.zero for end in joint.range)
    if least < -_HAIR or most > link.length + _HAIR:
        whole, low, high = (format_quantity(value, "length") for value in (link.length, least, most))
        raise body.error(
            "length",
            f"slide {number} runs out from {low} to {high}, but its boom is {whole}; write the length of the whole "
            f"boom, {high} or more, and a range from 0 mm on",
        )
    return replace(link, runs_out=True)


ReadSection = Callable[[Mapping], tuple[Section, str | None]]


def read_guide(
    joint: Mapping, catalogue: Catalogue, read_section: ReadSection, axis: FloatVector, travel: tuple[float, float]
) -> GuideBeam | None:
    """The beam of a slide that moves along `axis` over its `travel` (m); None without one. Raises `InputError`."""
    if not joint.has("beam"):
        return None
    with joint.mapping("beam").reading() as body:
        length = body.positive("length", "length")
        section, name = read_section(body)
        raw = body.raw("material", "a material's name, e.g. steel-s355")
        material: Material = catalogue.read(raw, file=body.file, key=body.path_of("material"))
        supports = cast(Literal["simple", "clamped"], body.choice("supports", ("simple", "clamped"), "simple"))
        rails = body.raw("rails") if body.has("rails") else 1
        if isinstance(rails, bool) or rails not in (1, 2):
            raise body.error("rails", "is 1 or 2, which share the load")
        begins = body.quantity("begins_at", "length", 0.5 * (travel[0] + travel[1] - length))
        if begins > travel[0] + 1e-12 or begins + length < travel[1] - 1e-12:
            ends = " to ".join(format_quantity(end, "length") for end in (begins, begins + length))
            raise body.error("length", f"does not hold the slide's range: the beam runs from {ends}")
        _check_beam(body, section)
        height = _height(body, axis)
    return GuideBeam(length, section, material, supports, rails, begins, height, name)


def _check_beam(body: Mapping, section: Section) -> None:
    lacking = None if isinstance(section, Tapered) else asymmetry_of(section)
    if lacking is None or lacking.askew or lacking.eccentric:
        raise body.error("section", "must be uniform, with two axes of symmetry: a tube, box or I-section, say")


def _height(body: Mapping, axis: FloatVector) -> FloatVector:
    """Where the section's height lies, in the joint's frame: across the axis, and where nobody says y, or z for a slide
    along that."""
    given = read_vector(body, "height_direction", "dimensionless", (0.0, 0.0, 0.0))
    across: Any = given
    if not any(given):
        across = (0.0, 1.0, 0.0) if norm(cast(FloatVector, cross((0.0, 1.0, 0.0), axis))) > 1e-6 else (0.0, 0.0, 1.0)
    across = subtract(across, scale(dot(across, axis), axis))
    if norm(across) < 1e-6:
        raise body.error("height_direction", "runs along the slide; the section's height lies across it")
    return unit(across)
