"""Designs as expressions of the optimiser's numbers: each link by itself, and all of them together."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from linkwright.core.arm.bodies.warping import FREE, warping_of
from linkwright.core.arm.chain.beam import Beam, elastic_beam
from linkwright.core.arm.chain.prices import price_by_length
from linkwright.core.arm.chain.similar_taper import similar_beam
from linkwright.core.arm.errors.model import BEAM_FIELDS, beams_of, symbolic_beams
from linkwright.core.arm.figures import ChosenMaterial, DesignExpressions
from linkwright.core.arm.figures.geometry.separation import SEPARATION
from linkwright.core.arm.figures.local_buckling import LOCAL_BUCKLING
from linkwright.core.arm.figures.strength import STRENGTH_FIELDS
from linkwright.core.arm.limits.wall_modes import Mode, modes_of
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections import SHAPES
from linkwright.core.sections.numeric import column_of_symbols, maximum
from linkwright.core.sections.properties import SectionProperties
from linkwright.core.sections.section import Section

from .design import MATERIAL_FIELDS, DesignSpace, any_section, material_values


@lru_cache(maxsize=64)
def properties_function(shape: str) -> Any:
    """A shape's properties as a compiled function of its design variables and Poisson's ratio.

    Writing a shape's formulas out as symbols takes far longer than calling a function that holds them, and a choice
    among shapes meets the same few hundreds of times.
    """
    kind = SHAPES[shape]
    sizes = column_of_symbols("sizes", len(kind.variables))
    poisson_ratio = column_of_symbols("nu")
    properties = kind.from_variables([sizes[k] for k in range(sizes.numel())]).properties(poisson_ratio)
    column = ca.vertcat(*[ca.SX(getattr(properties, item.name)) for item in fields(SectionProperties)])
    return ca.Function(shape, [sizes, poisson_ratio], [column])


def symbolic_properties(shape: str, sizes: list[Any], poisson_ratio: Any) -> SectionProperties:
    """A shape's properties for symbols in place of its design variables."""
    column = properties_function(shape)(ca.vertcat(*sizes), poisson_ratio)
    return SectionProperties(**{item.name: column[k] for k, item in enumerate(fields(SectionProperties))})


@lru_cache(maxsize=64)
def mode_count(shape: str) -> int:
    """In how many ways the walls of a shape buckle."""
    section = any_section(shape)
    return len(modes_of(section, section.properties(0.3), material_values(np.ones(len(MATERIAL_FIELDS)), 0)) or ())


LINK_FIELDS = (*BEAM_FIELDS, *STRENGTH_FIELDS, "mass", "cost", "radius")
"""What rows that see no section know of a link, beside how its walls buckle: all links together settle them."""


def link_fields(modes: int) -> tuple[str, ...]:
    """`LINK_FIELDS` with what so many ways in which its walls buckle are known by."""
    return (*LINK_FIELDS, *(f"{item.name} {number}" for number in range(modes) for item in fields(Mode)))


@dataclass(frozen=True)
class LinkExpressions:
    """What one link of a design is, as expressions: `mass` (kg) and `cost` (EUR) are its own, `modes` the ways in which
    its walls buckle and `radius` (m) how far its section reaches, where a limit asks for them."""

    section: Section | None
    material: ChosenMaterial | None
    properties: SectionProperties | None
    beam: Beam
    mass: Any
    cost: Any
    modes: tuple[Mode, ...] = ()
    radius: Any = 0.0

    @property
    def column(self) -> dict[str, Any]:
        """Its values by `link_fields`, 0 where it has none."""
        strength = [1.0 if self.properties is None else getattr(self.properties, name) for name in STRENGTH_FIELDS]
        of_beam = (getattr(self.beam, name) for name in BEAM_FIELDS)
        entries = [*of_beam, *strength, self.mass, self.cost, self.radius]
        entries += [getattr(mode, item.name) for mode in self.modes for item in fields(Mode)]
        names = link_fields(len(self.modes))
        return {name: ca.SX(0.0 if entry is None else entry) for name, entry in zip(names, entries, strict=True)}


def link_expressions(space: DesignSpace, x: Any, materials: Any) -> list[LinkExpressions]:
    """Each link of a design for symbols x and the materials' parameters."""
    arm = space.problem.arm
    sections, lengths = space.sections_and_lengths(x)
    chosen, tapers = space.chosen(x), space.log_tapers(x)
    rigid_beams = beams_of(arm, space.problem.load_cases) if any(section is None for section in sections) else None
    links: list[LinkExpressions] = []
    for link, (section, length) in enumerate(zip(sections, lengths, strict=True)):
        if section is None:
            assert rigid_beams is not None
            beam = rigid_beams[link]
            links.append(LinkExpressions(None, None, None, beam, beam.lumped_mass, 0.0))
            continue
        material = material_values(materials, link)
        result = symbolic_properties(section.shape, chosen[link][0], material.poisson_ratio)
        # Warping is taken as free along a tapered link.
        held = warping_of(arm, link) if space.problem.ranges[link].taper is None else FREE
        beam = elastic_beam(length, result, material, shear=True, warping=held)
        if space.problem.ranges[link].taper is not None:
            beam = similar_beam(beam, tapers[link])
        weight = beam.mass_per_length * length
        cost = weight * material.cost + price_by_length(arm) * length
        modes = modes_of(section, result, material) if space.problem.limit(LOCAL_BUCKLING.name) else ()
        radius = section.greatest_radius if space.problem.limit(SEPARATION.name) else 0.0
        if space.problem.ranges[link].taper is not None:
            radius = radius * maximum(1.0, ca.exp(tapers[link]))
        own = tuple(mode for _, mode in modes or ())
        links.append(LinkExpressions(section, material, result, beam, weight, cost, own, radius))
    return links


def expressions(space: DesignSpace, x: Any, materials: Any) -> DesignExpressions:
    """The design's figures for symbols x and the materials' parameters."""
    links = link_expressions(space, x, materials)
    for (link, name), value in space.balance(x).items():
        changed_figure: dict[str, Any] = {name: value}
        links[link] = replace(links[link], beam=replace(links[link].beam, **changed_figure))
    columns = [link.column for link in links]
    return DesignExpressions(
        tuple(link.section for link in links),
        tuple(link.material for link in links),
        tuple(link.modes for link in links),
        tuple(link.beam for link in links),
        ca.vertcat(*[column[name] for column in columns for name in BEAM_FIELDS]),
        ca.vertcat(*[column[name] for column in columns for name in STRENGTH_FIELDS]),
        sum((link.mass for link in links), 0.0),
        sum((link.cost for link in links), 0.0),
        sum(space.sections_and_lengths(x)[1]),
        tuple(column["radius"] for column in columns),
        space.hung(x),
    )


def expressions_of_links(problem: Problem, modes: int, columns: Any, materials: Any) -> DesignExpressions:
    """The design's figures for symbols of what each link brings (`link_fields`, link after link), whatever its shape;
    nothing is known of sections."""
    size, names = problem.arm.size, link_fields(modes)
    of_links = [{name: columns[len(names) * k + at] for at, name in enumerate(names)} for k in range(size)]
    beam_column = ca.vertcat(*[link[name] for link in of_links for name in BEAM_FIELDS])
    beams = symbolic_beams(problem.arm, beam_column)
    return DesignExpressions(
        (None,) * size,
        tuple(material_values(materials, k) if link.elastic else None for k, link in enumerate(problem.arm.links)),
        tuple(
            tuple(
                Mode(**{field.name: link[f"{field.name} {number}"] for field in fields(Mode)})
                for number in range(modes)
            )
            for link in of_links
        ),
        beams,
        beam_column,
        ca.vertcat(*[link[name] for link in of_links for name in STRENGTH_FIELDS]),
        sum(link["mass"] for link in of_links),
        sum(link["cost"] for link in of_links),
        sum(beam.length for beam in beams),
        tuple(link["radius"] for link in of_links),
    )
