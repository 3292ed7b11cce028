"""Many designs at once: the figures of every combination of section options and lengths, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from linkwright.core.arm.bodies.warping import held_torsion, warping_of
from linkwright.core.arm.chain.beam import elastic_beam
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.prices import price_by_length, price_by_mass
from linkwright.core.arm.errors.calibrated import calibrated_temperature
from linkwright.core.arm.errors.model import BEAM_FIELDS, beam_values, beams_of, needs_shear_modulus
from linkwright.core.arm.figures import Figure, Limit, OfLinks, Totals
from linkwright.core.arm.figures.local_buckling import values_of
from linkwright.core.arm.figures.strength import STRENGTH_FIELDS, strength_values
from linkwright.core.arm.limits.wall_modes import Mode, modes_of
from linkwright.core.optimize.choice.agreement import within
from linkwright.core.optimize.exchange.totals import carried_mass, drives_cost
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.rounding.options import Option
from linkwright.core.sections.numeric import Array

from .options import LinkList, agreeing
from .rows import Integers


@dataclass(frozen=True)
class Figures:
    """Figures of N designs (SI): beam values (N, 9 n), section values (N, 4 n), and N each of the rest."""

    p: Array
    sections: Array
    mass: Array
    cost: Array
    reach: Array


class Table:
    """All links' options and all choices of lengths, ready to be combined."""

    def __init__(self, problem: Problem, lists: Sequence[LinkList], lengths: Sequence[tuple[float, ...]] = ()) -> None:
        """Links without a list (rigid ones) stay as they are; without `lengths` those of the problem's arm count."""
        self.problem, self.arm = problem, problem.arm
        self.lists, self.lengths = tuple(lists), tuple(lengths) or (problem.arm.lengths,)
        arm = self.arm
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
        rows = [
            [self._row(option, link_list.link, shear, priced, strong) for option in link_list.options]
            for link_list in self.lists
        ]
        self._beams, self._sections, self._prices, self._allowed, self._warping = (
            [np.array([entry[place] for entry in row]) for row in rows] for place in range(5)
        )
        self._by_link: dict[Limit, list[Array]] = {}

    def _row(
        self, option: Option, link: int, shear: bool, priced: bool, strong: bool
    ) -> tuple[Array, Array, float, float, float]:
        """Beam values without length and held warping, section values, price (EUR/kg), the stress that is allowed (Pa)
        and the rigidity of warping (N*m^4)."""
        values = option.material.at(self.arm.temperature, calibrated_temperature(self.problem.load_cases))
        properties = option.section.properties(0.3 if values.poisson_ratio is None else values.poisson_ratio)
        beam = elastic_beam(1.0, properties, values, shear=shear)
        warps = 0.0 if beam.torsional_rigidity is None else values.need("elastic_modulus") * properties.warping_constant
        price = price_by_mass(self.problem.arm, option.material) if priced else 0.0
        # The moduli that count for strength are those of `evaluate`.
        moduli = strength_values([option.section.properties(0.3)])
        share = self.problem.strength_share(link, option.material)
        allowed = values.need("yield_strength") / share if strong else np.nan
        return beam_values([beam]), moduli, price, allowed, float(warps)

    def figures(self, picks: Integers) -> Figures:
        """The figures of designs: rows of picks are an option of each list, then a choice of lengths."""
        count, size = len(picks), self.arm.size
        lengths = self._length_rows[picks[:, -1]]
        p = np.broadcast_to(self._rigid, (count, *self._rigid.shape)).copy()
        s = np.broadcast_to(self._strong, (count, *self._strong.shape)).copy()
        cost = np.full(count, self._bought)
        mass = np.full(count, self._rigid_mass.sum())
        for number, link in enumerate(link_list.link for link_list in self.lists):
            p[:, link] = self._beams[number][picks[:, number]]
            self._hold_warping(p[:, link], lengths[:, link], link, self._warping[number][picks[:, number]])
            s[:, link] = self._sections[number][picks[:, number]]
            masses = p[:, link, BEAM_FIELDS.index("mass_per_length")] * lengths[:, link]
            mass += masses
            cost += masses * self._prices[number][picks[:, number]]
            cost += price_by_length(self.problem.arm) * lengths[:, link]
        p[:, :, BEAM_FIELDS.index("length")] = lengths
        width = len(STRENGTH_FIELDS) * size
        return Figures(p.reshape(count, -1), s.reshape(count, width), mass, cost, lengths.sum(axis=1))

    def _hold_warping(self, p: Array, lengths: Array, link: int, warping: Array) -> None:
        """Beam values (N, B) of a link (from 0), in place, with what its ends hold of warping."""
        if not warping.any():
            return
        stiff, by_weight = BEAM_FIELDS.index("torsional_rigidity"), BEAM_FIELDS.index("torsion_by_weight")
        with np.errstate(divide="ignore"):
            held = held_torsion(lengths, p[:, stiff], warping, warping_of(self.arm, link))
        p[:, stiff], p[:, by_weight] = held

    def totals(self, figures: Figures) -> Totals:
        """The sums over designs, as arrays."""
        return Totals(figures.mass, figures.cost, figures.reach, self.carried)

    def of_links(self, limit: Limit, follows: OfLinks, picks: Integers) -> Array:
        """The figure of the links (N) of designs that a limit is on, the worst over each design's links; 0 where none
        has anything to limit. What is not known of a link is left out."""
        if limit not in self._by_link:
            self._by_link[limit] = [
                np.array([self._worst_of(limit.figure, follows, option) for option in link_list.options])
                / limit.share(link_list.link)
                for link_list in self.lists
            ]
        columns = [worst[picks[:, number]] for number, worst in enumerate(self._by_link[limit])]
        least = limit.figure.more_is_better
        empty = np.inf if least else -np.inf
        values = np.full(len(picks), empty)
        for column in columns:
            values = np.fmin(values, column) if least else np.fmax(values, column)
        return np.where(values == empty, 0.0, values)

    def _worst_of(self, figure: Figure, follows: OfLinks, option: Option) -> float:
        values = follows.values(option.section, option.material.at(self.arm.temperature)) or ()
        return figure.worst([float(x) for x in values]) if values else np.nan

    def add_lengths(self, lengths: Sequence[tuple[float, ...]]) -> list[int]:
        """The numbers of choices of lengths (m), added where they are new."""
        fresh = [length for length in dict.fromkeys(lengths) if length not in self._placed]
        for item in fresh:
            self._placed[item] = len(self._placed)
        self.lengths = (*self.lengths, *fresh)
        self._length_rows = np.array(self.lengths)
        return [self._placed[length] for length in lengths]

    def allowed_stresses(self, picks: Integers) -> Array:
        """The links' yield strengths over what is asked of each safety factor, relative to the others (N, n), Pa; NaN
        where unknown."""
        stresses = np.full((len(picks), self.arm.size), np.nan)
        for number, link_list in enumerate(self.lists):
            stresses[:, link_list.link] = self._allowed[number][picks[:, number]]
        return stresses

    def wall_modes(self, picks: Integers, link: int) -> Array:
        """How a link's walls buckle (N, K, F); zeros where it has fewer modes, or none that are known."""
        for number, link_list in enumerate(self.lists):
            if link == link_list.link:
                return self._modes[number][picks[:, number]]
        return np.zeros((len(picks), 0, len(fields(Mode))))

    @cached_property
    def _modes(self) -> list[Array]:
        """Of each list's options, all with room for as many modes."""
        every = [[self._modes_of(option) for option in link_list.options] for link_list in self.lists]
        most = max((len(modes) for item in every for modes in item), default=0)
        empty = np.zeros((most, len(fields(Mode))))
        return [np.array([np.vstack([modes, empty[len(modes) :]]) for modes in item]) for item in every]

    def _modes_of(self, option: Option) -> Array:
        material = option.material.at(self.arm.temperature)
        properties = option.section.properties(0.3 if material.poisson_ratio is None else material.poisson_ratio)
        modes = modes_of(option.section, properties, material) or []
        return np.array([values_of(mode) for _, mode in modes]).reshape(len(modes), len(fields(Mode)))

    def arm_of(self, pick: Sequence[int]) -> Arm:
        """The arm that a row of picks describes."""
        links = list(self.arm.links)
        lengths = self.lengths[pick[-1]]
        for link_list, number in zip(self.lists, pick, strict=False):
            option = link_list.options[number]
            link = links[link_list.link]
            links[link_list.link] = link.chosen(option.section, option.stock, option.material)
        links = [replace(link, length=length) for link, length in zip(links, lengths, strict=True)]
        return self.arm.with_links(tuple(links))

    def agreeing(self, picks: Integers) -> Integers:
        """The picks in which the links agree in what they must."""
        for codes, most in self.agreed:
            picks = picks[within(codes, picks, most)]
        return picks

    @cached_property
    def agreed(self) -> list[tuple[list[Integers], int]]:
        """What the links must agree in: the kinds of the lists' options as numbers, and of how many they may be."""
        return agreeing(self.problem, self.lists)
