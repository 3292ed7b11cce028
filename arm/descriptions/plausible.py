"""Weights of a URDF that no body of that size has, each with its figure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwright.core.arm.bodies.bodies import Mass, principal_moments
from linkwright.core.materials.catalogue import shipped_layers
from linkwright.core.sections.numeric import Array

from .reading.meshes import Solid, solid
from .reading.tree import Frame, Robot, TreeLink

_ROUNDING = 1e-3
"""Of the greatest moment: tensors are written with three digits."""
_LIGHTER = 15.0
"""One link in a hundred of 1,308 that public URDFs weigh is lighter by more than the lighter of its neighbours."""
_FOAM = 33.0
"""kg/m^3: Plastazote LD33, a packaging foam (data sheet, EN ISO 845: customfoams.co.uk/shop/plastazote-ld33).
Hollow links lie between it and the densest material of the catalogue."""
_NOTHING = 1e-20
"""m^2: times a mass, what rounding leaves of a moment of zero."""


def doubts_of(
    robot: Robot, bodies: Sequence[tuple[Sequence[tuple[str, Frame]], Mass | None]], lengths: Sequence[float]
) -> tuple[str, ...]:
    """What is doubtful of the weights of bodies, given as their links with where these stand and their whole mass.

    `lengths` (m) are those of the arm's links: a body whose radius of gyration is beyond the longest, and beyond all
    that it is drawn by, would reach farther than the arm.
    """
    doubts: list[str] = []
    for links, _ in bodies:
        for name, _ in links:
            doubts += _of_link(name, robot.links[name], robot)
    weights = [None if whole is None else whole.mass for _, whole in bodies]
    for index, weight in enumerate(weights):
        beside = [other for k in (index - 1, index + 1) if 0 <= k < len(weights) and (other := weights[k])]
        if weight and beside and min(beside) > _LIGHTER * weight:
            neighbours = " and ".join(map(_mass, beside))
            doubts.append(f"{bodies[index][0][0][0]} weighs {_mass(weight)}, what stands beside it {neighbours}")
    for links, whole in bodies:
        if whole is not None and whole.mass > 0.0:
            doubts += _of_size(robot, links, whole, max(lengths))
    return tuple(doubts)


def _of_link(name: str, link: TreeLink, robot: Robot) -> list[str]:
    """What a link's figures say: its tensor, and its mass beside what it is drawn by."""
    doubts: list[str] = []
    held = link.inertial
    if held is not None and held.inertia is not None:
        least, middle, greatest = principal_moments(held.inertia)
        room = _ROUNDING * max(abs(least), abs(greatest)) + _NOTHING * held.mass
        figures = f"{least:.3g}, {middle:.3g} and {greatest:.3g} kg*m^2"
        if least < -room:
            doubts.append(f"{name} has the principal moments {figures}: no body has a negative one")
        elif greatest > least + middle + room:
            doubts.append(f"{name} has the principal moments {figures}: no body has one above the sum of the others")
    solids = [solid(shape, robot.file) for shape in link.shapes]
    volumes = [None if item is None else item.volume for item in solids]
    known = [volume for volume in volumes if volume]
    if held is None or held.mass == 0.0 or not known or len(known) < len(volumes):
        return doubts
    density = held.mass / sum(known)
    densest = max(
        (material for layer in shipped_layers() for material in layer.materials.values()),
        key=lambda material: material.need("density"),
    )
    if not _FOAM <= density <= densest.need("density"):
        than = "lighter than foam" if density < _FOAM else f"denser than solid {densest.name}"
        doubts.append(
            f"{name} weighs {_mass(held.mass)} in the {1e3 * sum(known):.3g} litres that it is drawn by: {than}"
        )
    return doubts


def _of_size(robot: Robot, links: Sequence[tuple[str, Frame]], whole: Mass, longest: float) -> list[str]:
    """What a body's tensor says of how far its mass would have to reach."""
    reach = float(np.sqrt(max(0.0, float(whole.moments[2])) / whole.mass))
    drawn = [
        _placed(made, frame)
        for name, frame in links
        for shape in robot.links[name].shapes
        if (made := solid(shape, robot.file)) is not None
    ]
    farthest = max((float(np.linalg.norm(item - whole.center, axis=1).max()) for item in drawn), default=longest)
    if reach <= max(farthest, 0.0 if drawn else float(np.linalg.norm(whole.center))):
        return []
    extent = "what it is drawn by reaches" if drawn else "the arm's longest link is"
    return [
        f"{links[0][0]} has {whole.moments[2]:.3g} kg*m^2 and {_mass(whole.mass)}: a radius of gyration of "
        f"{1e3 * reach:.0f} mm, where {extent} {1e3 * farthest:.0f} mm"
    ]


def _mass(kilograms: float) -> str:
    return f"{kilograms:.3g} kg" if kilograms >= 0.1 else f"{1e3 * kilograms:.3g} g"


def _placed(made: Solid, frame: Frame) -> Array:
    return made.corners @ np.array(frame[0], dtype=float).T + np.array(frame[1], dtype=float)
