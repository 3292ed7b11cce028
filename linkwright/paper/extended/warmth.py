"""Materials at equal size and at equal mass, cold and in the workshop's 50 degC."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.errors.model import beam_values, beams_of
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Material, OutOfRange
from linkwright.core.sections import build
from linkwright.core.sections.section import Section
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE
from linkwright.paper.corrected import PaperArm, material, search_of
from linkwright.paper.rows import Cell, Column, ExtendedTable
from linkwright.results.figures_in_words import figure, mm

COLD, WARM = REFERENCE_TEMPERATURE, REFERENCE_TEMPERATURE + 30.0
"""20 degC (ISO 1), and the 50 degC that the paper gives for the workshop, in kelvin."""


def growth_of(made_of: Material, length: float, temperature: float = WARM) -> float | None:
    """By how much a length (m) of the material grows from 20 degC to a temperature (K), m; None where not known."""
    try:
        expansion = made_of.at(temperature).thermal_expansion
    except OutOfRange:
        return None
    return None if expansion is None else expansion * (temperature - COLD) * length


def warmed(arm: Arm, temperature: float = WARM) -> Arm:
    """The arm at a temperature (K), with the growth of its links as an error."""
    return replace(arm, temperature=temperature, effects=(*arm.effects, EffectEntry("thermal_expansion")))


def mass_of(arm: Arm) -> float:
    """The mass of an arm's links, kg."""
    return sum(float(beam.mass_per_length * beam.length) for beam in beams_of(arm))


def material_table(arms: PaperArm, names: Sequence[str] | None = None) -> ExtendedTable:
    """The paper's and the catalogue's materials at equal size and equal mass, at 20 and at 50 degC.

    `names` takes only these of the catalogue; by default all but the paper's own entries.
    """
    compared = _Compared(arms)
    rows = [compared.row(name, made_of, laws=False) for name, made_of in compared.printed()]
    catalogue = load_catalogue(user=False)
    wanted = [each.name for each in catalogue if each.family != "paper"] if names is None else names
    found = [catalogue.find(name) for name in wanted]
    shown = [compared.row(each.name, each, laws=True) for each in found if each.has("shear_modulus")]
    rows += sorted(shown, key=lambda row: float(row[6] or math.inf))
    without = ", ".join(each.name for each in found if not each.has("shear_modulus"))
    note = (
        f"Deformation alone. Equal size: round bars of {mm(arms.paper.parameters.diameter)}; equal mass: bars of "
        f"{figure(mass_of(arms.arm()))} kg together, of the diameter given. The modulus at 50 °C is the "
        "catalogue's (the same where it has no law), the paper's materials have none. Best at equal mass first. "
        "Growth is what the whole arm lengthens by from 20 to 50 °C; it is no part of the other figures. Rubber and "
        "soft plastics are shown as the model gives them: linear bending means nothing there."
    )
    if without:
        note += f" Left out for want of a shear modulus: {without}."
    columns = (
        Column("material"),
        Column("E", "GPa"),
        Column("density", "kg/m³"),
        Column("equal size, 20 °C", "mm"),
        Column("equal size, 50 °C", "mm"),
        Column("diameter", "mm"),
        Column("equal mass, 20 °C", "mm"),
        Column("equal mass, 50 °C", "mm"),
        Column("growth", "mm"),
    )
    return ExtendedTable("materials_fairly", "Materials at equal size and at equal mass", columns, tuple(rows), note)


@dataclass(frozen=True)
class _Compared:
    arms: PaperArm

    @cached_property
    def search(self) -> WorstSearch:
        """One model for all: they differ in rigidities and masses only."""
        return search_of(self.arms.arm())[0]

    def printed(self) -> list[tuple[str, Material]]:
        """The paper's materials, at both ends of their ranges."""
        found: list[tuple[str, Material]] = []
        for row in self.arms.paper.material:
            ends = list(dict.fromkeys(zip(row.elastic_modulus, row.density, strict=True)))
            for number, (modulus, density) in enumerate(ends):
                end = "" if len(ends) == 1 else (", lower", ", upper")[number]
                found.append((f"{row.name} (paper{end})", material(modulus, density, row.poisson_ratio)))
        return found

    def row(self, name: str, made_of: Material, *, laws: bool) -> tuple[Cell, ...]:
        """A material's row; without `laws` nothing is known of it at 50 degC."""
        parameters = self.arms.paper.parameters
        density = made_of.need("density", COLD)
        diameter = parameters.diameter * math.sqrt(parameters.density / density)
        cells: list[Cell] = [name, made_of.need("elastic_modulus", COLD) / 1e9, density]
        for section in (None, build("circle", {"diameter": diameter})):
            if section is not None:
                cells.append(1e3 * diameter)
            cells += [self._sag(made_of, section, COLD), self._sag(made_of, section, WARM) if laws else None]
        growth = growth_of(made_of, sum(parameters.lengths))
        return (*cells, None if growth is None else 1e3 * growth)

    def _sag(self, made_of: Material, section: Section | None, temperature: float) -> float | None:
        arm = replace(self.arms.arm(made_of=made_of, section=section), temperature=temperature)
        try:
            beams = beams_of(arm)
        except OutOfRange:
            return None  # the material's source does not go as far
        return 1e3 * self.search.worst(beam_values(beams)).error
