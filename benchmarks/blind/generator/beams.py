"""Cross sections and the geometrically exact (Cosserat, Reissner-Simo) beam by spectral collocation.

A link is a rod with strains (axial, two shears) and curvatures (torsion, two bendings) linear in the internal force and
moment, but its shape is exact: psi' and r' are integrated over Gauss-Legendre nodes whose polynomial integration is
exact to degree 2k - 1. Source: J. C. Simo, Comput. Meth. Appl. Mech. Eng. 49 (1985), doi:10.1016/0045-7825(85)90050-7.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.blind.generator.vectors import Array, rotated, rotation_rate

NODES = 5


def _collocation(count: int) -> tuple[Array, Array, Array]:
    """Nodes and weights of Gauss-Legendre on [0, 1], and the matrix that integrates from 0 to each node."""
    x, w = np.polynomial.legendre.leggauss(count)
    nodes, weights = (x + 1.0) / 2.0, w / 2.0
    powers = np.arange(count)
    values = nodes[:, None] ** powers
    integrals = nodes[:, None] ** (powers + 1) / (powers + 1)
    return nodes, weights, integrals @ np.linalg.inv(values)


_N, _W, _A = _collocation(NODES)
for _constant in (_N, _W, _A):
    _constant.setflags(write=False)


@dataclass(frozen=True)
class Section:
    """A bar's cross section: area, bending stiffnesses' moments (m^4), torsion constant, shear areas, depth in m."""

    keys: tuple[tuple[str, str | float], ...]  # as the arm file spells it, lengths in m
    area: float
    inertia_in_plane: float
    inertia_across: float
    torsion: float
    shear_area_in_plane: float
    shear_area_across: float
    depth: float


def tube(diameter: float, thickness: float, poisson: float) -> Section:
    """A round tube. Shear by energy coefficients: W. D. Pilkey, Analysis and Design of Elastic Beams (2002)."""
    a, b = diameter / 2.0, diameter / 2.0 - thickness
    area = math.pi * (a**2 - b**2)
    inertia = math.pi / 4.0 * (a**4 - b**4)
    above = 6.0 * (1.0 + poisson) ** 2 * (a**2 + b**2) ** 2
    below = (
        7 * a**4
        + 34 * a**2 * b**2
        + 7 * b**4
        + poisson * (12 * a**4 + 48 * a**2 * b**2 + 12 * b**4)
        + poisson**2 * (4 * a**4 + 16 * a**2 * b**2 + 4 * b**4)
    )
    shear = area * above / below
    keys = (("shape", "tube"), ("diameter", diameter), ("thickness", thickness))
    return Section(keys, area, inertia, inertia, 2.0 * inertia, shear, shear, diameter)


def circle(diameter: float, poisson: float) -> Section:
    """A round bar, the tube without its hole."""
    solid = tube(diameter, diameter / 2.0, poisson)
    return Section((("shape", "circle"), ("diameter", diameter)), *_figures(solid))


def rectangular_tube(width: float, height: float, thickness: float) -> Section:
    """A thin rectangular tube, bending over its height; shear and torsion by thin-wall theory on the mid-line."""
    inner_w, inner_h = width - 2 * thickness, height - 2 * thickness
    area = width * height - inner_w * inner_h
    strong = (width * height**3 - inner_w * inner_h**3) / 12.0
    weak = (height * width**3 - inner_h * inner_w**3) / 12.0
    w, h = width - thickness, height - thickness
    torsion = 2.0 * thickness * (w * h) ** 2 / (w + h)
    keys = (("shape", "rectangular_tube"), ("width", width), ("height", height), ("thickness", thickness))
    return Section(
        keys, area, strong, weak, torsion, _thin_shear(w, h, thickness), _thin_shear(h, w, thickness), height
    )


def _thin_shear(w: float, h: float, t: float) -> float:
    """Shear area of a thin box under a shear along h: from the energy of the shear flow V S / I."""
    flange = w / 2.0 * t * h / 2.0  # first moment where the half flange meets its web
    web = np.linspace(0.0, h / 2.0, 201)
    in_web = flange + t * (h / 2.0 * web - web**2 / 2.0)
    energy = 4.0 * (flange**2 * (w / 2.0) / 3.0 + float(np.trapezoid(in_web**2, web))) / t
    inertia = 2.0 * (t * h**3 / 12.0 + w * t * h**2 / 4.0)
    return inertia**2 / energy


def _figures(section: Section) -> tuple[float, float, float, float, float, float, float]:
    return (
        section.area,
        section.inertia_in_plane,
        section.inertia_across,
        section.torsion,
        section.shear_area_in_plane,
        section.shear_area_across,
        section.depth,
    )


@dataclass(frozen=True)
class RodShape:
    """The shape of rods in the frame of their roots: at the nodes and at the end; positions in m, rotation vectors."""

    psi: Array  # (3, m, k)
    position: Array  # (3, m, k)
    end_psi: Array  # (3, m)
    end_position: Array  # (3, m)


def rod_shape(length: Array, strain: Array, curvature: Array, sweeps: int = 3) -> RodShape:
    """Shape of rods with given strains and curvatures (3, m, k) in the material frame; `sweeps` resolve psi'."""
    per = length[:, None]
    psi = per * (curvature @ _A.T)
    rate = curvature
    for _ in range(sweeps):
        rate = rotation_rate(psi, curvature)
        psi = per * (rate @ _A.T)
    tangent = strain.copy()
    tangent[0] += 1.0
    slope = rotated(psi, tangent)
    return RodShape(psi, per * (slope @ _A.T), length * (rate @ _W), length * (slope @ _W))


def internal_loads(
    length: Array, shape: RodShape, force: Array, moment: Array, weight: Array
) -> tuple[Array, Array, Array, Array]:
    """Force and moment in rods at their nodes, in the material frame, and at their roots, in the root's frame.

    `force` and `moment` (3, m) act at the end, `weight` (3, m) per length, all in the frame of the root.
    """
    left = length[:, None] * (1.0 - _N)
    beyond = force[:, :, None] + weight[:, :, None] * left
    to_end = shape.end_position[:, :, None] - shape.position
    # integral of (p(t) - p(s)) dt from s to the end
    whole = length * (shape.position @ _W)
    upto = length[:, None] * (shape.position @ _A.T)
    arm_of_weight = whole[:, :, None] - upto - shape.position * left
    at_nodes = moment[:, :, None] + _cross(to_end, force[:, :, None]) + _cross(arm_of_weight, weight[:, :, None])
    root_force = force + weight * length
    root_moment = moment + _cross(shape.end_position, force) + _cross(whole, weight)
    return rotated(-shape.psi, beyond), rotated(-shape.psi, at_nodes), root_force, root_moment


def _cross(a: Array, b: Array) -> Array:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
