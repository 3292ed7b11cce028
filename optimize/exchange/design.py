"""One combination of shapes and materials as variables: from the optimiser's numbers to beams, and back to an arm."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache, reduce
from typing import Any

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.chain import Arm, Asymmetry, LoadCase, asymmetry_of
from linkwright.core.arm.chain.prices import price_by_mass
from linkwright.core.arm.errors.calibrated import calibrated_temperature
from linkwright.core.arm.errors.model import (
    beam_values,
    beams_of,
)
from linkwright.core.arm.figures import ChosenMaterial
from linkwright.core.materials.material import Material
from linkwright.core.materials.walls import WallCompliance
from linkwright.core.optimize.balance.balance import FIELDS, balance_values, balanced
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.reading.conditions import needed_figures
from linkwright.core.sections import SHAPES
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.section import DesignVariable, Section
from linkwright.core.sections.taper import FreeTaper, Tapered, similar, size_ratio

MATERIAL_FIELDS = (
    "elastic_modulus",
    "shear_modulus",
    "density",
    "poisson_ratio",
    "yield_strength",
    "allowed_stress",
    "cost",
    "thermal_expansion",
    "stiffness_when_calibrated",
    "shear_when_calibrated",
    *(field.name for field in fields(WallCompliance)),
)
"""The order in which a program's parameters list each link's material (SI; 0 where unknown and not needed), with how
its walls buckle."""
LENGTH = "length"
"""The variable that is the length of a link."""
TAPER = "taper"
"""The variable that is the size of a link's far end over that at its joint."""
_UNIFORM = 1e-6
"""A taper nearer to 1 than this is none."""


@dataclass(frozen=True)
class Variable:
    """One number of the optimiser: the design quantity is exp(x), or x times `scale`, between `lower` and `upper`
    (SI)."""

    link: int
    name: str
    logarithmic: bool
    scale: float
    lower: float
    upper: float

    def to_x(self, value: float) -> float:
        """The optimiser's number for a design value (SI)."""
        return math.log(value / self.scale) if self.logarithmic else value / self.scale

    def from_x(self, x: Any) -> Any:
        """The design value (SI) for the optimiser's number, in floats or symbols."""
        return self.scale * (ca.exp(x) if self.logarithmic else x)


@dataclass(frozen=True)
class DesignSpace:
    """The variables of a combination of shapes (one a link, None for a rigid link), whatever the materials."""

    problem: Problem
    shapes: tuple[str | None, ...]
    variables: tuple[Variable, ...]

    @property
    def free_lengths(self) -> bool:
        """Whether lengths are among the variables."""
        return any(variable.name == LENGTH for variable in self.variables)

    def values(self, x: Any) -> list[Any]:
        """The design quantities (SI) of all variables."""
        return [variable.from_x(x[k]) for k, variable in enumerate(self.variables)]

    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of x."""
        lower = np.array([variable.to_x(variable.lower) for variable in self.variables])
        upper = np.array([variable.to_x(variable.upper) for variable in self.variables])
        return lower, upper

    def balance(self, x: Any) -> dict[tuple[int, str], Any]:
        """What is chosen of counterbalances and counterweights (SI), by link and field of its beam."""
        values = self.values(x)
        numbers = {(v.link, v.name): values[k] for k, v in enumerate(self.variables) if v.name in FIELDS}
        for index, link in enumerate(self.problem.arm.links):
            for mass in link.masses:
                if mass.chosen:
                    numbers.setdefault((index, "counterweight_at"), mass.at[0])
        return numbers

    def hung(self, x: Any) -> Any:
        """By how much the counterweights (kg) are heavier than those of the arm as given."""
        given = sum(mass.mass for link in self.problem.arm.links for mass in link.masses if mass.chosen)
        chosen = [value for (_, name), value in self.balance(x).items() if name == "counterweight"]
        return sum(chosen, -given) if chosen else 0.0

    def chosen(self, x: Any) -> list[tuple[list[Any], Any]]:
        """For each link the values (SI) of its section's design variables (none where rigid), and its length (m)."""
        values = self.values(x)
        chosen: list[tuple[list[Any], Any]] = []
        for link, shape in enumerate(self.shapes):
            length = self.problem.arm.links[link].length
            numbers = {v.name: values[k] for k, v in enumerate(self.variables) if v.link == link}
            if shape is None:
                chosen.append(([], length))
                continue
            first = self.shapes.index(shape) if "size" in self.problem.same else link
            sizes = {v.name: values[k] for k, v in enumerate(self.variables) if v.link == first}
            chosen.append(([sizes[variable.name] for variable in SHAPES[shape].variables], numbers.get(LENGTH, length)))
        return chosen

    def log_tapers(self, x: Any) -> list[Any]:
        """For each link the logarithm of its far end's size over that at its joint; 0 where it has no taper to
        choose."""
        chosen = {v.link: x[k] for k, v in enumerate(self.variables) if v.name == TAPER}
        tapers: list[Any] = []
        for link, shape in enumerate(self.shapes):
            first = self.shapes.index(shape) if shape is not None and "size" in self.problem.same else link
            tapers.append(0.0 if shape is None else chosen.get(first, 0.0))
        return tapers

    def sections_and_lengths(self, x: Any) -> tuple[list[Section | None], list[Any]]:
        """Each link's section, at its joint, and its length (m) for the optimiser's numbers."""
        chosen = self.chosen(x)
        sections = [
            None if shape is None else SHAPES[shape].from_variables(sizes)
            for shape, (sizes, _) in zip(self.shapes, chosen, strict=True)
        ]
        return sections, [length for _, length in chosen]


_ANY_SIZES = ((0.005, 0.5), (0.001, 0.05))
"""m; outer sizes and walls of a section that stands for its shape alone."""


def with_chosen_links(problem: Problem) -> Problem:
    """The problem with a uniform link wherever the choice of shapes replaces a tapered or an askew one, and with links
    whose taper is free where that is to be chosen.

    What the given section brings beside its rigidities (a taper's factors, a plane that it does not keep) is no
    candidate's, so models are built of the arm without it, and with what any candidate lacks of symmetry.
    """
    if problem.shapes is None and problem.sizes is None and not problem.free_tapers:
        return problem
    links = list(problem.arm.links)
    for index, link in enumerate(links):
        section = link.section and link.section.ends[0]
        lacking = link.may_lack
        if section is not None:
            candidates = _candidates(problem, index)
            lacking = reduce(Asymmetry.with_that, map(asymmetry_of, candidates), lacking)
            if candidates and not lacking.covers(asymmetry_of(section)):
                section = candidates[0]
        if section is not None and problem.ranges[index].taper is not None:
            section = _free_taper(link.section, section)
        if section is not link.section or lacking != link.may_lack:
            name = link.section_name if section is link.section else None
            links[index] = replace(link, section=section, section_name=name, may_lack=lacking)
    if all(new is old for new, old in zip(links, problem.arm.links, strict=True)):
        return problem
    return replace(problem, arm=problem.arm.with_links(tuple(links)))


@lru_cache(maxsize=64)
def any_section(shape: str) -> Section:
    """A section that stands for its shape alone; its sizes take a search, and every combination asks for some."""
    return SHAPES[shape].start(1e-3, *_ANY_SIZES)


def _candidates(problem: Problem, link: int) -> list[Section]:
    """A section of each shape that may be chosen for a link (from 0); none where its shape stays."""
    if problem.sizes is not None:
        return list({item.section.shape: item.section for item in problem.sizes[link]}.values())
    if problem.shapes is None:
        return []
    return [any_section(shape) for shape in problem.shapes_of(link)]


def _free_taper(section: Section | None, near: Section) -> Section:
    """The section whose taper is chosen, with the ends that the arm as given has where those are alike."""
    if isinstance(section, FreeTaper):
        return section
    tapered = isinstance(section, Tapered) and size_ratio(section) is not None
    return FreeTaper(near, section.far if isinstance(section, Tapered) and tapered else near)


def design_space(problem: Problem, shapes: tuple[str | None, ...]) -> DesignSpace:
    """The variables of a combination of shapes."""
    problem = with_chosen_links(problem)
    variables: list[Variable] = []
    for link, shape in enumerate(shapes):
        if shape is None:
            continue
        shared = "size" in problem.same and shape in shapes[:link]
        kind = SHAPES[shape]
        ranges = problem.ranges[link]
        bounds = kind.variable_bounds(*ranges.sizes)
        for variable, (lower, upper) in zip(kind.variables, bounds, strict=True):
            if not shared:
                variables.append(_section_variable(link, variable, lower, upper))
        if ranges.taper is not None and not shared:
            variables.append(Variable(link, TAPER, True, 1.0, *ranges.taper))
        if ranges.link_length is not None:
            variables.append(Variable(link, LENGTH, True, 1.0, *ranges.link_length))
    for balance in problem.balances:
        scale = max(abs(balance.lower), abs(balance.upper))
        variables.append(Variable(balance.place, balance.field, False, scale, balance.lower, balance.upper))
    return DesignSpace(problem, shapes, tuple(variables))


def _section_variable(link: int, variable: DesignVariable, lower: float, upper: float) -> Variable:
    # Areas span several decades: a scale between the bounds keeps the optimiser's numbers near one.
    scale = 1.0 if variable.logarithmic else math.sqrt(lower * upper)
    return Variable(link, variable.name, variable.logarithmic, scale, lower, upper)


def material_row(materials: Sequence[Material | None], problem: Problem, first: int = 0) -> Array:
    """The materials' figures as the programs' parameters (for each link from the `first` on `MATERIAL_FIELDS`; the cost
    with work by the kilogram); raises `MissingProperty` for what is needed."""
    needed = needed_figures(problem)
    rows: list[float] = []
    for link, material in enumerate(materials, start=first):
        if material is None:
            rows += [0.0] * len(MATERIAL_FIELDS)
            continue
        values = material.at(problem.arm.temperature, calibrated_temperature(problem.load_cases))
        # What nobody knows of walls limits nothing.
        walls = WallCompliance() if values.walls is None else values.walls
        for name in MATERIAL_FIELDS:
            if name == "cost" and (name in needed or material.has(name)):
                rows.append(price_by_mass(problem.arm, material))
            elif name in needed:
                rows.append(material.need(name, problem.arm.temperature))  # type: ignore[arg-type]
            elif name == "allowed_stress":
                rows.append((values.yield_strength or 0.0) / problem.strength_share(link, material))
            elif name == "poisson_ratio":
                rows.append(0.3 if values.poisson_ratio is None else values.poisson_ratio)
            elif hasattr(walls, name):
                rows.append(getattr(walls, name))
            else:
                figure = getattr(values, name)
                rows.append(0.0 if figure is None else figure)
    return np.array(rows)


def material_values(row: Any, link: int) -> ChosenMaterial:
    """One link's material from the parameters, as symbols or floats."""
    base = len(MATERIAL_FIELDS) * link
    figures = {name: row[base + k] for k, name in enumerate(MATERIAL_FIELDS)}
    walls = WallCompliance(**{field.name: figures.pop(field.name) for field in fields(WallCompliance)})
    return ChosenMaterial("chosen", 0.0, **figures, walls=walls)


def arm_of(space: DesignSpace, x: Array, materials: Sequence[Material | None]) -> Arm:
    """The arm that the optimiser's numbers describe."""
    sections, lengths = space.sections_and_lengths([float(value) for value in x])
    tapers = space.log_tapers(x)
    links = list(space.problem.arm.links)
    for k, (section, length, material) in enumerate(zip(sections, lengths, materials, strict=True)):
        if section is None:
            continue
        plain: Section = type(section)(**{name: float(value) for name, value in section.given().items()})
        ratio = math.exp(float(tapers[k]))
        plain = plain if abs(ratio - 1.0) < _UNIFORM else similar(plain, ratio)
        links[k] = replace(links[k].chosen(plain, None, material), length=float(length))
    return balanced(space.problem.arm.with_links(tuple(links)), space.balance([float(value) for value in x]))


def numeric_beams(arm: Arm, loads: Sequence[LoadCase]) -> Array:
    """The beam values of an arm under load cases, as the error model takes them."""
    return beam_values(beams_of(arm, loads))


def starting_points(space: DesignSpace, materials: Array, count: int, seed: int = 7) -> list[Array]:
    """Starting values of x: equal shares of the mass allowed, the arm as given, then random ones (seeded)."""
    lower, upper = space.bounds()
    lengths = _starting_lengths(space)
    starts = [_shared_mass(space, materials, lengths)]
    given = as_given(space)
    if given is not None:
        starts.append(given)
    generator = np.random.default_rng(seed)
    starts = [np.clip(start, lower, upper) for start in starts]
    starts = [starts[0], *(start for start in starts[1:] if _possible(space, start))]
    while len(starts) < count:
        shift = generator.uniform(-0.5, 0.5, len(lower))
        trials = (np.clip(starts[0] + 0.5**halved * shift, lower, upper) for halved in range(8))
        starts.append(next((trial for trial in trials if _possible(space, trial)), starts[0]))
    return starts[:count]


def ladder(space: DesignSpace, materials: Array, count: int) -> list[Array]:
    """Starting values of x from the lightest sections to the heaviest, all links alike, within what the mass allows."""
    problem = space.problem
    lengths = _starting_lengths(space)
    most = min((limit.value for limit in problem.limit("mass") if limit.relation != ">="), default=math.inf)
    lower, upper = space.bounds()
    rungs: list[Array] = []
    for share in np.linspace(0.0, 1.0, count):
        x: list[float] = []
        mass = 0.0
        for link, shape in enumerate(space.shapes):
            if shape is None:
                continue
            kind, ranges = SHAPES[shape], problem.ranges[link].sizes
            least, greatest = (float(kind.start(area, *ranges).properties(0.3).area) for area in (1e-12, 1e3))
            section = kind.start(least * (greatest / least) ** float(share), *ranges)
            density = materials[len(MATERIAL_FIELDS) * link + MATERIAL_FIELDS.index("density")]
            mass += float(section.properties(0.3).area) * density * lengths[link]
            x += _section_values(space, link, section, lengths[link])
        rung = np.clip(np.array([*x, *_given_balance(space)]), lower, upper)
        if mass <= most * (1.0 + 1e-9) and len(rung) == len(lower) and _possible(space, rung):
            rungs.append(rung)
    return rungs


def _possible(space: DesignSpace, x: Array) -> bool:
    """Whether the optimiser's numbers make real sections: an area within its bounds may not fit its diameter."""
    with np.errstate(invalid="ignore"):
        sections, _ = space.sections_and_lengths([float(value) for value in x])
        return not any(section.check() for section in sections if section is not None)


def _starting_lengths(space: DesignSpace) -> list[float]:
    problem = space.problem
    spans = zip(problem.arm.links, problem.length_spans, strict=True)
    return [min(max(link.length, low), high) for link, (low, high) in spans]


def _shared_mass(space: DesignSpace, materials: Array, lengths: list[float]) -> Array:
    problem = space.problem
    most = min((limit.value for limit in problem.limit("mass") if limit.relation != ">="), default=math.inf)
    elastic = [k for k, shape in enumerate(space.shapes) if shape is not None]
    x: list[float] = []
    for link in elastic:
        shape = space.shapes[link]
        assert shape is not None
        density = materials[len(MATERIAL_FIELDS) * link + MATERIAL_FIELDS.index("density")]
        share = 0.9 * most / (len(elastic) * density * lengths[link]) if math.isfinite(most) else 3e-3
        section = _starting_section(shape, share, *problem.ranges[link].sizes)
        x += _section_values(space, link, section, lengths[link])
    return np.array([*x, *_given_balance(space)])


@lru_cache(maxsize=256)
def _starting_section(shape: str, area: float, outer: tuple[float, float], walls: tuple[float, float]) -> Section:
    """A section of an area (m^2): its sizes take a search, and every combination of shapes asks for the same few."""
    return SHAPES[shape].start(area, outer, walls)


def _given_balance(space: DesignSpace) -> list[float]:
    """The optimiser's numbers for what balances the arm as given."""
    numbers = [variable for variable in space.variables if variable.name in FIELDS]
    pairs = zip(numbers, balance_values(space.problem.arm, space.problem.balances), strict=True)
    return [variable.to_x(min(max(value, variable.lower), variable.upper)) for variable, value in pairs]


def _section_values(space: DesignSpace, link: int, section: Section, length: float, taper: float = 1.0) -> list[float]:
    named = dict(zip((v.name for v in section.variables), section.variable_values(), strict=True))
    named[LENGTH] = length
    named[TAPER] = taper
    return [
        variable.to_x(min(max(float(named[variable.name]), variable.lower), variable.upper))
        for variable in space.variables
        if variable.link == link and variable.name not in FIELDS
    ]


def as_given(space: DesignSpace) -> Array | None:
    """The numbers of the arm as given, or the nearest within the bounds; None where its shapes are others."""
    lengths = _starting_lengths(space)
    x: list[float] = []
    for link, (shape, item) in enumerate(zip(space.shapes, space.problem.arm.links, strict=True)):
        if shape is None:
            continue
        if item.section is None or item.section.shape != shape:
            return None
        ratio = size_ratio(item.section)
        if ratio is None:
            return None
        x += _section_values(space, link, item.section.ends[0], lengths[link], ratio)
    return np.array([*x, *_given_balance(space)])
