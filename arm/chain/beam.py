"""A link as a beam: its rigidities, from section and material, in floats or in the optimiser's symbols."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from linkwright.core.arm.bodies.warping import FREE, Warping, held_torsion

from .vectors import ZERO, Scalar, Vector, minus, plus, times

if TYPE_CHECKING:
    from linkwright.core.materials.material import MaterialValues
    from linkwright.core.sections.properties import SectionProperties


QUARTERS = 4
"""Into how many parts a tapered link can be cut (see `arm.limits.modes`)."""
STATIONS = tuple(k / 60 for k in range(61))
"""Where along a tapered link its stress is looked at, as a share of its length from its joint."""


@dataclass(frozen=True)
class BendingFactors:
    """How much more a tapered link bends than a uniform one that bends as much under a force at its end.

    Deflection and slope of the far end, under the link's weight and under a moment at its end. (The slope under a
    force is the deflection under a moment, by Maxwell's theorem.)
    """

    weight_deflection: float = 1.0
    moment_deflection: float = 1.0
    moment_slope: float = 1.0
    weight_slope: float = 1.0


UNIFORM_BENDING = BendingFactors()
"""Of a uniform link."""


@dataclass(frozen=True)
class Station:
    """A cut of a tapered link at a `share` of its length: the share of its weight beyond, that weight's moment about
    the cut (per weight and length), and the section's figures over those at the joint."""

    share: float
    weight_beyond: float
    moment_beyond: float
    area: float
    section_modulus_y: float
    section_modulus_z: float
    torsion_modulus: float


@dataclass(frozen=True)
class Part:
    """A quarter of a tapered link: its effective rigidities over those of the whole link, and its taper."""

    rigidities: Mapping[str, float]
    taper: Taper


@dataclass(frozen=True)
class Taper:
    """What a tapered link is against a uniform one of its effective rigidities and its mean mass per length.

    `balance` is where its centre of mass is, as a share of its length from its joint. `axial_weight` and so on say how
    much more it gives under its weight; `column_height` and `column_width` how much more compression it holds;
    `offset_square` is the mean square of the shear centre's eccentricity over the square of its mean, by flexibility.
    `density` is the mass per length over its mean at the ends of its `parts`. Plain numbers, whatever the length.
    """

    balance: float = 0.5
    height: BendingFactors = UNIFORM_BENDING
    width: BendingFactors = UNIFORM_BENDING
    axial_weight: float = 1.0
    shear_height_weight: float = 1.0
    shear_width_weight: float = 1.0
    column_height: float = 1.0
    column_width: float = 1.0
    offset_square: float = 1.0
    parts: tuple[Part, ...] = ()
    density: tuple[float, ...] = ()
    stations: tuple[Station, ...] = ()


UNIFORM = Taper()
"""A link that is the same all along."""


@dataclass(frozen=True)
class Beam:
    """The rigidities of a straight link, or those of a rigid one (None: it does not give in that way).

    Those of a tapered link are the effective ones under a force at its far end, and `taper` tells the rest.
    `height` is the direction in the section's plane along which its height lies: `flexural_rigidity_height` (E I_y,
    N*m^2) resists bending in the plane of link and height, `flexural_rigidity_width` (E I_z) bending across it;
    `flexural_rigidity_coupling` (E I_yz) is zero but for sections without an axis of symmetry.
    Axial rigidity E A in N, shear rigidities G A_s in N, mass per length in kg/m, thermal expansion in 1/K. The
    torsional rigidity (N*m^2) is the torque at the far end times the length over the twist: G J, or more where warping
    is held (`arm.bodies.warping`); `torsion_by_weight` is how much more an even torque along the link twists it than
    half of that at its end. `shear_centre_height` and `shear_centre_width` are where it turns, from its centroid (m).
    A rigid link has `lumped_mass` in kg at `lumped_at` m from its joint. `first_moment`
    (kg*m) is what its mass times its centre, along the link and along its height and width, is beyond that of the rest.
    `stiffness_when_calibrated` and `shear_when_calibrated` are the moduli where the arm was calibrated over these.
    `log_taper` is the logarithm of the far end's size over that at the joint, where the two are alike.
    Of what an optimiser chooses beside sections, `balancer` is the figure of the joint's counterbalance,
    `counterweight` (kg) the mass on the joint's housing and `counterweight_at` (m) where that is along the link.
    `housed` (kg) is what of a link that runs out of a sleeve is still in it.
    """

    length: Scalar
    mass_per_length: Scalar = 0.0
    axial_rigidity: Scalar | None = None
    flexural_rigidity_height: Scalar | None = None
    flexural_rigidity_width: Scalar | None = None
    torsional_rigidity: Scalar | None = None
    shear_rigidity_height: Scalar | None = None
    shear_rigidity_width: Scalar | None = None
    thermal_expansion: Scalar | None = None
    lumped_mass: Scalar = 0.0
    lumped_at: Scalar = 0.0
    flexural_rigidity_coupling: Scalar = 0.0
    shear_centre_height: Scalar = 0.0
    shear_centre_width: Scalar = 0.0
    torsion_by_weight: Scalar = 1.0
    taper: Taper = UNIFORM
    first_moment: Vector = ZERO
    stiffness_when_calibrated: Scalar = 1.0
    shear_when_calibrated: Scalar = 1.0
    log_taper: Scalar = 0.0
    balancer: Scalar = 0.0
    counterweight: Scalar = 0.0
    counterweight_at: Scalar = 0.0
    housed: Scalar = 0.0

    def run_out(self, length: Scalar) -> Beam:
        """The beam that has run out of its sleeve so far (m): the rest is housed."""
        return replace(self, length=length, housed=times(self.mass_per_length, minus(self.length, length)))

    @property
    def calibrated(self) -> Beam:
        """The beam at the temperature at which the arm was calibrated."""

        def times_(ratio: Scalar, rigidity: Scalar | None) -> Scalar | None:
            return None if rigidity is None else times(ratio, rigidity)

        normal, shear = self.stiffness_when_calibrated, self.shear_when_calibrated
        return replace(
            self,
            axial_rigidity=times_(normal, self.axial_rigidity),
            flexural_rigidity_height=times_(normal, self.flexural_rigidity_height),
            flexural_rigidity_width=times_(normal, self.flexural_rigidity_width),
            flexural_rigidity_coupling=times(normal, self.flexural_rigidity_coupling),
            torsional_rigidity=times_(shear, self.torsional_rigidity),
            shear_rigidity_height=times_(shear, self.shear_rigidity_height),
            shear_rigidity_width=times_(shear, self.shear_rigidity_width),
        )

    @property
    def mass(self) -> Scalar:
        """The whole mass, kg."""
        return plus(times(self.mass_per_length, self.length), self.lumped_mass)


def elastic_beam(
    length: Scalar,
    section: SectionProperties,
    material: MaterialValues,
    *,
    shear: bool = True,
    warping: Warping = FREE,
) -> Beam:
    """The beam that a section (SI) makes of a material at its temperature; `warping` says which of its ends hold that.

    Without `shear` the shear modulus may be missing; the beam then has no torsional and shear rigidity.
    Raises `materials.material.MissingProperty` for a figure that is needed and not there.
    """
    youngs, density = material.need("elastic_modulus"), material.need("density")
    modulus = material.need("shear_modulus") if shear else material.shear_modulus
    torsional, by_weight = None, 1.0
    if modulus is not None:
        warps = times(youngs, section.warping_constant)
        torsional, by_weight = held_torsion(length, modulus * section.torsion_constant, warps, warping)
    return Beam(
        length=length,
        mass_per_length=density * section.area,
        axial_rigidity=youngs * section.area,
        flexural_rigidity_height=youngs * section.second_moment_y,
        flexural_rigidity_width=youngs * section.second_moment_z,
        flexural_rigidity_coupling=times(youngs, section.product_moment_yz),
        torsional_rigidity=torsional,
        torsion_by_weight=by_weight,
        shear_centre_height=section.shear_centre_z,
        shear_centre_width=section.shear_centre_y,
        shear_rigidity_height=None if modulus is None else modulus * section.shear_area_z,
        shear_rigidity_width=None if modulus is None else modulus * section.shear_area_y,
        thermal_expansion=material.thermal_expansion,
        stiffness_when_calibrated=material.stiffness_when_calibrated,
        shear_when_calibrated=material.shear_when_calibrated,
    )
