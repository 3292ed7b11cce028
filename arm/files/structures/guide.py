"""The beam along which a slide runs, held at both ends, as an arm file gives it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, cast

from linkwright.core.arm.chain.chain import FloatVector, GuideBeam, asymmetry_of
from linkwright.core.arm.chain.vectors import cross, dot, norm, scale, subtract, unit
from linkwright.core.arm.files.origin import read_vector
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.materials.material import Material
from linkwright.core.sections.section import Section
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import format_quantity
from linkwright.core.units.reading import Mapping

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
        _check(body, section)
        height = _height(body, axis)
    return GuideBeam(length, section, material, supports, rails, begins, height, name)


def _check(body: Mapping, section: Section) -> None:
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
