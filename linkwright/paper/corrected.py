"""The paper's arm in the project's physics: true distances, nothing fitted to the paper."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.arm.worst.refine import uphill
from linkwright.core.arm.worst.search import WorstSearch
from linkwright.core.arm.worst.workspace import Workspace
from linkwright.core.materials.catalogue_entry import read_inline
from linkwright.core.materials.material import Material
from linkwright.core.sections import build
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.section import Section
from linkwright.core.units.quantities import format_quantity
from linkwright.paper.printed import FILE, Paper

DEFORMATION = frozenset({"link_bending", "slope_propagation", "axial", "torsion", "shear_deformation"})
"""The effects that are deformation; left out for the figures without it."""


@dataclass(frozen=True)
class PaperArm:
    """The paper's arm, in variants; what it lacks is said in this module's first lines."""

    paper: Paper

    @cached_property
    def section(self) -> Section:
        """The round bar of Table II."""
        return build("circle", {"diameter": self.paper.parameters.diameter})

    @cached_property
    def material(self) -> Material:
        """The aluminium of Table II."""
        parameters = self.paper.parameters
        aluminium = next(row for row in self.paper.material if row.name == "aluminium")
        return material(parameters.elastic_modulus, parameters.density, aluminium.poisson_ratio)

    def arm(
        self,
        *,
        clearance: Sequence[int] = (),
        backlash: Sequence[int] = (),
        clearance_size: float | None = None,
        backlash_size: float | None = None,
        leave_out: frozenset[str] = frozenset(),
        made_of: Material | None = None,
        section: Section | None = None,
        absolute: bool = False,
    ) -> Arm:
        """The arm with play in the joints named (from 1), of the inferred size unless given (m; rad to either side)."""
        radius = self.paper.clearance_size if clearance_size is None else clearance_size
        turn = self.paper.backlash_size if backlash_size is None else backlash_size
        joints = tuple(
            Joint(
                range=(-math.pi, math.pi),
                clearance=radius if number in clearance else 0.0,
                backlash=2.0 * turn if number in backlash else 0.0,
            )
            for number in (1, 2, 3)
        )
        links = tuple(
            Link(length, section=section or self.section, material=made_of or self.material)
            for length in self.paper.parameters.lengths
        )
        angles = "absolute" if absolute else "relative"
        return Arm("the paper's arm", joints, links, angles=angles, leave_out=leave_out)


def material(elastic_modulus: float, density: float, poisson_ratio: float) -> Material:
    """A material by its modulus (Pa), density (kg/m^3) and Poisson's ratio alone."""
    content: Mapping[str, object] = {
        "elastic_modulus": format_quantity(elastic_modulus, "elastic_modulus"),
        "density": format_quantity(density, "density"),
        "poisson_ratio": poisson_ratio,
    }
    return read_inline(dict(content), file=FILE, key="material")


def search_of(arm: Arm) -> tuple[WorstSearch, Array]:
    """The search for an arm's worst pose, and its design values."""
    return WorstSearch(error_model(arm), Workspace()), beam_values(beams_of(arm))


def worst_error(arm: Arm) -> float:
    """The arm's worst position error over all poses, m."""
    search, design = search_of(arm)
    return search.worst(design).error


def pose_errors(arm: Arm, poses: Array) -> Array:
    """The error (m) at poses (N, 3), rad, with the play where it is worst."""
    search, design = search_of(arm)
    return search.errors(poses, design, 0).error


def worst_signed(arm: Arm, signs: Sequence[int]) -> float:
    """The worst error (m) over all poses with each joint's backlash held to one side (1 or -1).

    The model's vector and backlash are its own; only where the play lies is not its choice.
    """
    search, design = search_of(arm)
    case = search.model.cases[0]
    sides = np.array(signs, dtype=float)

    def distance(q: Array) -> Array:
        arrays = case.arrays(np.ascontiguousarray(q), design)
        moved = arrays.vector + np.einsum("k,nki->ni", sides, arrays.intervals)
        return np.sqrt((moved * moved).sum(axis=1))

    poses = search.poses(design, 4096)
    starts = poses[np.argsort(-distance(poses))[:16]]
    free = (np.full(arm.size, -np.inf), np.full(arm.size, np.inf))
    return float(distance(uphill(distance, starts, free)).max())


def least_deformation(paper_arm: PaperArm) -> float:
    """The smallest error over many poses without play, m: deformation alone, where the arm stands or hangs."""
    arm = replace(paper_arm.arm(), name="the paper's arm")
    search, design = search_of(arm)
    upright = np.array([[0.5 * math.pi, 0.0, 0.0], [-0.5 * math.pi, 0.0, 0.0]])
    poses = np.vstack([search.poses(design, 4096), upright])
    return float(search.errors(poses, design, 0).error.min())
