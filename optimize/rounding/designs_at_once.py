"""Many designs at once: the figures of every combination of section options and lengths, as arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.beam import elastic_beam
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.prices import price_by_length, price_by_mass
from linkwright.core.arm.errors.calibrated import calibrated_temperature
from linkwright.core.arm.errors.model import BEAM_FIELDS, beam_values, beams_of, needs_shear_modulus
from linkwright.core.arm.limits.local_buckling import values_of
from linkwright.core.arm.limits.strength import STRENGTH_FIELDS, strength_values
from linkwright.core.arm.limits.wall_modes import Mode, modes_of
from linkwright.core.optimize.exchange.program import carried_mass, drives_cost
from linkwright.core.optimize.limits import Figure, OfLinks, Totals
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections.numeric import Array

from .options import Option

Integers = NDArray[np.intp]


@dataclass(frozen=True)
class Group:
    """Links (from 0) that must agree in their dimensions, and what they can be: an option for each of them, the ones
    nearest to the optimum first. The first `near` are those to try in every combination."""

    links: tuple[int, ...]
    options: tuple[tuple[Option, ...], ...]
    near: int


@dataclass(frozen=True)
class Figures:
    """Figures of N designs (SI): beam values (N, 9 n), section values (N, 4 n), and N each of the rest."""

    p: Array
    sections: Array
    mass: Array
    cost: Array
    reach: Array


class Table:
    """All groups' options and all choices of lengths, ready to be combined."""

    def __init__(
        self, problem: Problem, arm: Arm, groups: Sequence[Group], lengths: Sequence[tuple[float, ...]]
    ) -> None:
        """`arm` is the optimum; links in no group (rigid ones) stay as they are."""
        self.problem, self.arm = problem, arm
        self.groups, self.lengths = tuple(groups), tuple(lengths)
        self.carried = carried_mass(problem)
        self._bought = drives_cost(problem)
        self._length_rows = np.array(self.lengths)
        self._placed = {lengths: number for number, lengths in enumerate(self.lengths)}
        self._rigid = beam_values(beams_of(arm, problem.load_cases)).reshape(arm.size, -1)
        self._rigid_mass = np.array([0.0 if link.elastic else link.mass or 0.0 for link in arm.links])
        self._strong = strength_values(
            [None if link.section is None else link.section.properties(0.3) for link in arm.links]
        ).reshape(arm.size, -1)
        shear = needs_shear_modulus(arm, problem.load_cases)
        strong, priced = problem.needs("yield_strength"), problem.needs("cost")
        rows = [[self._rows(option, shear, priced, strong) for option in group.options] for group in self.groups]

        def column(place: int) -> list[Array]:
            return [np.array([[entry[place] for entry in own] for own in group]) for group in rows]

        self._beams, self._sections, self._prices, self.yields = (column(place) for place in range(4))
        self._by_link: dict[str, list[Array]] = {}

    def _rows(
        self, options: tuple[Option, ...], shear: bool, priced: bool, strong: bool
    ) -> list[tuple[Array, Array, float, float]]:
        """For each link: beam values without length, section values, price (EUR/kg) and yield strength (Pa)."""
        found: list[tuple[Array, Array, float, float]] = []
        temperature = self.arm.temperature
        for option in options:
            assert option.section is not None
            assert option.material is not None
            values = option.material.at(temperature, calibrated_temperature(self.problem.load_cases))
            properties = option.section.properties(0.3 if values.poisson_ratio is None else values.poisson_ratio)
            beam = elastic_beam(1.0, properties, values, shear=shear)
            price = price_by_mass(self.problem.arm, option.material) if priced else 0.0
            strength = values.need("yield_strength") if strong else np.nan
            # The moduli that count for strength are those of `evaluate`.
            moduli = strength_values([option.section.properties(0.3)])
            found.append((beam_values([beam]), moduli, price, strength))
        return found

    def figures(self, picks: Integers) -> Figures:
        """The figures of designs: rows of picks are an option of each group, then a choice of lengths."""
        count, size = len(picks), self.arm.size
        lengths = self._length_rows[picks[:, -1]]
        p = np.broadcast_to(self._rigid, (count, *self._rigid.shape)).copy()
        s = np.broadcast_to(self._strong, (count, *self._strong.shape)).copy()
        cost = np.full(count, self._bought)
        mass = np.full(count, self._rigid_mass.sum())
        for number, group in enumerate(self.groups):
            for place, link in enumerate(group.links):
                p[:, link] = self._beams[number][picks[:, number], place]
                s[:, link] = self._sections[number][picks[:, number], place]
                own = p[:, link, BEAM_FIELDS.index("mass_per_length")] * lengths[:, link]
                mass += own
                cost += own * self._prices[number][picks[:, number], place]
                cost += price_by_length(self.problem.arm) * lengths[:, link]
        p[:, :, BEAM_FIELDS.index("length")] = lengths
        width = len(STRENGTH_FIELDS) * size
        return Figures(p.reshape(count, -1), s.reshape(count, width), mass, cost, lengths.sum(axis=1))

    def totals(self, figures: Figures) -> Totals:
        """The sums over designs, as arrays."""
        return Totals(figures.mass, figures.cost, figures.reach, self.carried)

    def of_links(self, figure: Figure, follows: OfLinks, picks: Integers) -> Array:
        """A figure of the links (N) of designs, the worst over each design's links; 0 where none has anything to
        limit. What is not known of a link is left out."""
        if figure.name not in self._by_link:
            self._by_link[figure.name] = [
                np.array([self._worst_of(figure, follows, option) for option in group.options]) for group in self.groups
            ]
        columns = [worst[picks[:, number]] for number, worst in enumerate(self._by_link[figure.name])]
        least = figure.more_is_better
        empty = np.inf if least else -np.inf
        found = np.full(len(picks), empty)
        for column in columns:
            found = np.fmin(found, column) if least else np.fmax(found, column)
        return np.where(found == empty, 0.0, found)

    def _worst_of(self, figure: Figure, follows: OfLinks, option: tuple[Option, ...]) -> float:
        found: list[float] = []
        for each in option:
            assert each.section is not None
            assert each.material is not None
            found += [float(x) for x in follows.values(each.section, each.material.at(self.arm.temperature)) or ()]
        return figure.worst(found) if found else np.nan

    def add_lengths(self, lengths: Sequence[tuple[float, ...]]) -> list[int]:
        """The numbers of choices of lengths (m), added where they are new."""
        fresh = [each for each in dict.fromkeys(lengths) if each not in self._placed]
        for each in fresh:
            self._placed[each] = len(self._placed)
        self.lengths = (*self.lengths, *fresh)
        self._length_rows = np.array(self.lengths)
        return [self._placed[each] for each in lengths]

    def yield_strengths(self, picks: Integers) -> Array:
        """The links' yield strengths (N, n), Pa; NaN where unknown."""
        found = np.full((len(picks), self.arm.size), np.nan)
        for number, group in enumerate(self.groups):
            for place, link in enumerate(group.links):
                found[:, link] = self.yields[number][picks[:, number], place]
        return found

    def wall_modes(self, picks: Integers, link: int) -> Array:
        """How a link's walls buckle (N, K, F); noughts where it has fewer modes, or none that are known."""
        for number, group in enumerate(self.groups):
            if link in group.links:
                return self._modes[number][picks[:, number], group.links.index(link)]
        return np.zeros((len(picks), 0, len(fields(Mode))))

    @cached_property
    def _modes(self) -> list[Array]:
        """Of each group's options, link by link, all with room for as many modes."""
        every = [[[self._modes_of(each) for each in option] for option in group.options] for group in self.groups]
        most = max((len(modes) for group in every for option in group for modes in option), default=0)
        empty = np.zeros((most, len(fields(Mode))))
        return [
            np.array([[np.vstack([modes, empty[len(modes) :]]) for modes in option] for option in group])
            for group in every
        ]

    def _modes_of(self, option: Option) -> Array:
        assert option.section is not None
        assert option.material is not None
        material = option.material.at(self.arm.temperature)
        properties = option.section.properties(0.3 if material.poisson_ratio is None else material.poisson_ratio)
        modes = modes_of(option.section, properties, material) or []
        return np.array([values_of(mode) for _, mode in modes]).reshape(len(modes), len(fields(Mode)))

    def arm_of(self, pick: Sequence[int]) -> Arm:
        """The arm that a row of picks describes."""
        links = list(self.arm.links)
        lengths = self.lengths[pick[-1]]
        for number, group in enumerate(self.groups):
            for option, link in zip(group.options[pick[number]], group.links, strict=True):
                links[link] = replace(
                    links[link],
                    section=option.section,
                    section_name=option.stock,
                    material=option.material,
                )
        links = [replace(link, length=length) for link, length in zip(links, lengths, strict=True)]
        return self.arm.with_links(tuple(links))

    def agreeing(self, picks: Integers) -> Integers:
        """The picks in which all links are of one material, or of one shape, where the problem asks for that."""
        kinds: dict[str, Callable[[Option], str]] = {
            "material": lambda option: "" if option.material is None else option.material.name,
            "section": lambda option: "" if option.section is None else option.section.shape,
        }
        for same, kind in kinds.items():
            if same in self.problem.same and len(picks):
                picks = self._of_one(picks, kind)
        return picks

    def _of_one(self, picks: Integers, kind: Callable[[Option], str]) -> Integers:
        names = sorted({kind(option) for group in self.groups for own in group.options for option in own})
        columns: list[Integers] = []
        for number, group in enumerate(self.groups):
            for place in range(len(group.links)):
                own = [names.index(kind(each[place])) for each in group.options]
                columns.append(np.array(own, dtype=np.intp)[picks[:, number]])
        return picks[np.all([column == columns[0] for column in columns], axis=0)]
