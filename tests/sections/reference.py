"""Independent values: the finite element package sectionproperties, on the section's own outline."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from sectionproperties.analysis import Section as FiniteElements
from sectionproperties.pre import Geometry, Material
from shapely import Polygon as ShapelyPolygon

from linkwright.core.sections import Section


class Reference(NamedTuple):
    area: float
    second_moment_y: float
    second_moment_z: float
    product_moment_yz: float
    torsion_constant: float
    shear_area_y: float
    shear_area_z: float
    centroid: tuple[float, float]
    shear_centre: tuple[float, float]
    warping_constant: float


def reference(section: Section, poisson_ratio: float, elements: int = 1500) -> Reference:
    """Properties by finite elements, of the outline as drawn (unit scale is kept near one for the mesher)."""
    outer, *holes = section.outline()
    size = float(np.ptp(outer, axis=0).max())
    polygon = ShapelyPolygon(outer / size, [hole / size for hole in holes])
    material = Material("unit", 1.0, poisson_ratio, 1.0, 1.0, "white")
    geometry = Geometry(polygon, material=material)
    geometry.create_mesh(mesh_sizes=[polygon.area / elements])
    solved = FiniteElements(geometry)
    solved.calculate_geometric_properties()
    solved.calculate_warping_properties()
    iy, iz, iyz = solved.get_eic(e_ref=1.0)
    asy, asz = solved.get_eas(e_ref=1.0)
    return Reference(
        solved.get_area() * size**2,
        iy * size**4,
        iz * size**4,
        iyz * size**4,
        solved.get_ej(e_ref=1.0) * size**4,
        asy * size**2,
        asz * size**2,
        tuple(size * c for c in solved.get_c()),
        tuple(size * (s - c) for s, c in zip(solved.get_sc_t(), solved.get_c(), strict=True)),
        solved.get_egamma(e_ref=1.0) * size**6,
    )
