"""A link as a beam: its rigidities, from section and material, in floats or in the optimiser's symbols."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .vectors import Scalar, times

if TYPE_CHECKING:
    from materials.material import MaterialValues
    from sections.properties import SectionProperties


@dataclass(frozen=True)
class Beam:
    """The rigidities of a straight uniform link, or those of a rigid one (None: it does not give in that way).

    `height` is the direction in the section's plane along which its height lies: `flexural_rigidity_height` (E I_y,
    N*m^2) resists bending in the plane of link and height, `flexural_rigidity_width` (E I_z) bending across it;
    `flexural_rigidity_coupling` (E I_yz) is zero but for sections without an axis of symmetry.
    Axial rigidity E A in N, torsional rigidity G J in N*m^2, shear rigidities G A_s in N, mass per length in kg/m,
    thermal expansion in 1/K. A rigid link has `lumped_mass` in kg at `lumped_at` m from its joint.
    """

    length: Scalar
    mass_per_length: Scalar = 0.0
    axial_rigidity: Scalar | None = None
    flexural_rigidity_height: Scalar | None = None
    flexural_rigidity_width: Scalar | None = None
    torsional_rigidity: Scalar | None = None
    shear_rigidity_height: Scalar | None = None
    shear_rigidity_width: Scalar | None = None
    thermal_expansion: float | None = None
    lumped_mass: Scalar = 0.0
    lumped_at: Scalar = 0.0
    flexural_rigidity_coupling: Scalar = 0.0


def elastic_beam(length: Scalar, section: SectionProperties, material: MaterialValues, *, shear: bool = True) -> Beam:
    """The beam that a section (SI) makes of a material at its temperature.

    Without `shear` the shear modulus may be missing; the beam then has no torsional and shear rigidity.
    Raises `materials.material.MissingProperty` for a figure that is needed and not there.
    """
    youngs, density = material.need("elastic_modulus"), material.need("density")
    modulus = material.need("shear_modulus") if shear else material.shear_modulus
    return Beam(
        length=length,
        mass_per_length=density * section.area,
        axial_rigidity=youngs * section.area,
        flexural_rigidity_height=youngs * section.second_moment_y,
        flexural_rigidity_width=youngs * section.second_moment_z,
        flexural_rigidity_coupling=times(youngs, section.product_moment_yz),
        torsional_rigidity=None if modulus is None else modulus * section.torsion_constant,
        shear_rigidity_height=None if modulus is None else modulus * section.shear_area_z,
        shear_rigidity_width=None if modulus is None else modulus * section.shear_area_y,
        thermal_expansion=material.thermal_expansion,
    )
