"""What a beam needs to know of its cross-section."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from linkwright.core.sections.numeric import Number, atan2, sqrt

POWERS: Mapping[str, int] = MappingProxyType(
    {
        "area": 2,
        "second_moment_y": 4,
        "second_moment_z": 4,
        "torsion_constant": 4,
        "shear_area_y": 2,
        "shear_area_z": 2,
        "section_modulus_y": 3,
        "section_modulus_z": 3,
        "plastic_modulus_y": 3,
        "plastic_modulus_z": 3,
        "extreme_fibre_y": 1,
        "extreme_fibre_z": 1,
        "torsion_modulus": 3,
        "width": 1,
        "height": 1,
        "centroid_y": 1,
        "centroid_z": 1,
        "product_moment_yz": 4,
        "shear_centre_y": 1,
        "shear_centre_z": 1,
        "warping_constant": 6,
        "shear_stress_area_y": 2,
        "shear_stress_area_z": 2,
        "junction_modulus_y": 3,
        "junction_shear_area_z": 2,
    }
)
"""With which power of its size each property of a section grows."""

_UNFELT = 1e6
"""How much larger than the section modulus a modulus is that stands for no stress."""


@dataclass(frozen=True)
class SectionProperties:
    """Geometric properties of a cross-section about axes through its centroid, in SI units.

    ``y`` runs along the width (to the right), ``z`` along the height (up), ``x`` along the link. Each value
    is
    a float, an array or a CasADi expression, whatever the section's dimensions were.

    Attributes:
        area: A, m^2.
        second_moment_y: integral of z^2 dA, m^4; resists bending about y, in the plane of the height.
        second_moment_z: integral of y^2 dA, m^4; resists bending about z, in the plane of the width.
        torsion_constant: J of Saint-Venant, m^4; the twist per length is T / (G J).
        shear_area_y: effective area for a shear force along y, m^2.
        shear_area_z: effective area for a shear force along z, m^2. Both by strain energy: the energy per
        length
            of the exact flexural shear stress (Poisson's ratio included) is V^2 / (2 G A_s).
        section_modulus_y: second_moment_y / extreme_fibre_y, m^3; the least elastic modulus about y.
        section_modulus_z: second_moment_z / extreme_fibre_z, m^3.
        plastic_modulus_y: integral of |z - z_0| dA, m^3, where z_0 halves the area; for bending about y.
        plastic_modulus_z: the same of y, for bending about z.
        extreme_fibre_y: distance of the outermost fibre in bending about y, that is max |z| from the
        centroid, m.
        extreme_fibre_z: distance of the outermost fibre in bending about z, that is max |y| from the
        centroid, m.
        torsion_modulus: W_t, m^3; the greatest shear stress of torsion is T / W_t.
        width: of the bounding box, along y, m.
        height: of the bounding box, along z, m.
        centroid_y: distance of the centroid from the left edge of the bounding box, m.
        centroid_z: distance of the centroid from the lower edge of the bounding box, m.
        product_moment_yz: integral of y z dA, m^4; zero where either axis is one of symmetry.
        shear_centre_y: the shear centre's eccentricity from the centroid along y, m: a force through the
        centroid twists
            the section by its moment about the shear centre. Trefftz's, which no Poisson's ratio moves.
        shear_centre_z: the same along z, m.
        warping_constant: Vlasov's, about the shear centre, m^6; zero where a section hardly warps (closed or
        solid).
        shear_stress_area_y: a shear force along y over the greatest shear stress that it makes (Jourawski's, at the
            centroid's axis), m^2; where a shape does not say, 0.8 of the shear area, which is 2/3 of a rectangle.
        shear_stress_area_z: the same along z, m^2.
        junction_modulus_y: a moment about y over its stress where web and flange meet, m^3; where they do not, so large
            that there is none.
        junction_shear_area_z: a shear force along z over its stress in the web where that meets a flange, m^2.
    """

    area: Number
    second_moment_y: Number
    second_moment_z: Number
    torsion_constant: Number
    shear_area_y: Number
    shear_area_z: Number
    section_modulus_y: Number
    section_modulus_z: Number
    plastic_modulus_y: Number
    plastic_modulus_z: Number
    extreme_fibre_y: Number
    extreme_fibre_z: Number
    torsion_modulus: Number
    width: Number
    height: Number
    centroid_y: Number
    centroid_z: Number
    product_moment_yz: Number = 0.0
    shear_centre_y: Number = 0.0
    shear_centre_z: Number = 0.0
    warping_constant: Number = 0.0
    shear_stress_area_y: Number = None
    shear_stress_area_z: Number = None
    junction_modulus_y: Number = None
    junction_shear_area_z: Number = None

    def __post_init__(self) -> None:
        for side in ("y", "z"):
            if getattr(self, f"shear_stress_area_{side}") is None:
                object.__setattr__(self, f"shear_stress_area_{side}", 0.8 * getattr(self, f"shear_area_{side}"))
        if self.junction_modulus_y is None or self.junction_shear_area_z is None:
            object.__setattr__(self, "junction_modulus_y", _UNFELT * self.section_modulus_y)
            object.__setattr__(self, "junction_shear_area_z", self.shear_stress_area_z)

    @property
    def shear_centre(self) -> tuple[Number, Number]:
        """The shear centre's eccentricity (y, z) from the centroid, m."""
        return self.shear_centre_y, self.shear_centre_z

    @property
    def principal_moments(self) -> tuple[Number, Number]:
        """The greatest and the least second moment about axes through the centroid, m^4."""
        mean = 0.5 * (self.second_moment_y + self.second_moment_z)
        half = 0.5 * (self.second_moment_y - self.second_moment_z)
        radius = sqrt(half**2 + self.product_moment_yz**2)
        return mean + radius, mean - radius

    @property
    def principal_angle(self) -> Number:
        """How far y is turned, anticlockwise towards z, to the axis of the greatest second moment; rad, +-pi / 2."""
        return 0.5 * atan2(-2.0 * self.product_moment_yz, self.second_moment_y - self.second_moment_z)
