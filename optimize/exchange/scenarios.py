"""An arm as it may be instead: the error model's row p for a scenario, in floats and in the optimiser's symbols."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from linkwright.core.arm.bodies.warping import FREE, warping_of
from linkwright.core.arm.chain.beam import Beam, elastic_beam
from linkwright.core.arm.chain.chain import Arm, Link, LoadCase
from linkwright.core.arm.chain.similar_taper import similar_beam
from linkwright.core.arm.errors.model import BEAM_FIELDS, ErrorModel, beam_values, beams_of
from linkwright.core.arm.figures import DesignExpressions
from linkwright.core.arm.worst.search import WorstCase, WorstSearch
from linkwright.core.optimize.balance.balance import FIELDS
from linkwright.core.optimize.uncertain import Scenario
from linkwright.core.sections import Section
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.taper import Tapered

_RIGIDITIES = np.array(["rigidity" in name for name in BEAM_FIELDS])


@dataclass(frozen=True)
class Scenarios:
    """What a robust exchange holds designs against: the error model whose rows p go on with factors of the drives, its
    search, and the scenarios. Their load cases are numbered scenario after scenario."""

    model: ErrorModel
    search: WorstSearch
    held: tuple[Scenario, ...]

    def worst(self, arm: Arm, loads: Sequence[LoadCase], **settings: Any) -> WorstCase:
        """The worst case of an arm over all scenarios; `settings` as in `WorstSearch.worst`."""
        worst = [self.search.worst(scenario_values(arm, loads, scenario), **settings) for scenario in self.held]
        count = len(self.model.cases)
        poses = [
            replace(pose, load_case=pose.load_case + count * number)
            for number, item in enumerate(worst)
            for pose in item.poses
        ]
        bounds = [item.upper_bound for item in worst]
        return WorstCase(
            max(item.error for item in worst),
            None if None in bounds else max(bound for bound in bounds if bound is not None),
            all(item.certified for item in worst),
            tuple(sorted(poses, key=lambda pose: -pose.error)),
        )


def resized(section: Section, size: Any, thickness: Any) -> Section:
    """A section with all its dimensions times one factor, and its walls times another besides."""
    if isinstance(size, float) and isinstance(thickness, float) and size == thickness == 1.0:
        return section
    if isinstance(section, Tapered):
        return type(section)(*(resized(end, size, thickness) for end in (section.near, section.far)))
    scaled = section.scaled(size)
    walls = {dimension.name for dimension in section.dimensions if dimension.kind == "wall"}
    if not walls or thickness == 1.0:
        return scaled
    return type(section)(**{k: v * thickness if k in walls else v for k, v in scaled.given().items()})


def scenario_values(arm: Arm, loads: Sequence[LoadCase], scenario: Scenario) -> Array:
    """The row p of an arm as a scenario has it."""
    links = [_resized_link(*item) for item in zip(arm.links, scenario.size, scenario.thickness, strict=True)]
    changed = any(new is not old for new, old in zip(links, arm.links, strict=True))
    values = beam_values(beams_of(arm.with_links(tuple(links)) if changed else arm, loads)).reshape(arm.size, -1)
    factors = np.where(_RIGIDITIES, np.array(scenario.elastic_modulus)[:, None], 1.0)
    return np.concatenate([(values * factors).ravel(), scenario.beyond_links])


def _resized_link(link: Link, size: float, thickness: float) -> Link:
    if link.section is None or size == thickness == 1.0:
        return link
    return replace(link, section=resized(link.section, size, thickness), section_name=None)


def scenario_column(arm: Arm, design: DesignExpressions, scenario: Scenario) -> Any:
    """The same for a design in the optimiser's symbols."""
    beams = [_beam(arm, design, link, scenario) for link in range(len(design.beams))]
    column = [getattr(beam, name) for beam in beams for name in BEAM_FIELDS]
    entries = [0.0 if entry is None else entry for entry in column]
    return ca.vertcat(*[ca.SX(entry) for entry in (*entries, *scenario.beyond_links)])


def _beam(arm: Arm, design: DesignExpressions, link: int, scenario: Scenario) -> Beam:
    beam, section, material = design.beams[link], design.sections[link], design.materials[link]
    if section is None or material is None:
        return beam
    size, thickness = scenario.size[link], scenario.thickness[link]
    if size != 1.0 or thickness != 1.0:
        properties = resized(section, size, thickness).properties(material.poisson_ratio)
        held = warping_of(arm, link) if isinstance(beam.log_taper, float) else FREE
        plain = elastic_beam(beam.length, properties, material, shear=True, warping=held)
        if not isinstance(beam.log_taper, float):
            plain = similar_beam(plain, beam.log_taper)  # both ends are off by the same, so that they stay alike
        beam = replace(plain, **{name: getattr(beam, name) for name in FIELDS})
    factor = scenario.elastic_modulus[link]
    names = [name for name in BEAM_FIELDS if "rigidity" in name and getattr(beam, name) is not None]
    return replace(beam, **{name: factor * getattr(beam, name) for name in names})
