"""Where the heights of the links' sections point: up against gravity, level, or leaning."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm, FloatVector
from linkwright.core.arm.chain.kinematics import section_directions
from linkwright.core.arm.chain.vectors import snap_vector
from linkwright.core.arm.placed.views import Stand, stands
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.section import Section

from .views import upwards

_UPRIGHT = 1e-6
"""Below this sine of the angle between a link and the vertical no side of it is up."""
_ROUND = 0.99
"""From this share of its greatest radius on an edge is that of a circle, drawn by its chords."""
_SAME = 1e-6
"""Sizes and second moments that differ by less, of their sum, are alike."""


@dataclass(frozen=True)
class HeightPoints:
    """Where a section's height points with all joints at zero: the unit vector in the base frame, and the angle (rad)
    about the link from up to it; None where the link stands upright or nothing is up, for want of gravity."""

    direction: FloatVector
    from_up: float | None
    level: bool

    @property
    def words(self) -> str:
        """That as words: `up`, `down`, `level (along y)`, `35 deg from up`, `along y`."""
        along = f"along {_axis(self.direction)}"
        angle = None if self.from_up is None else round(math.degrees(self.from_up))
        if angle in (0, 180):
            return "down" if angle else "up"
        if self.level:
            return f"level ({along})"
        return along if angle is None else f"{angle} deg from up"


def heights(arm: Arm) -> tuple[HeightPoints | None, ...]:
    """Where the height of each link's section points; None for a link without one, and for a round one, whose height
    points anywhere."""
    up = upwards(arm) if any(arm.gravity) else None
    return tuple(
        None if link.section is None or _round(link.section) else _points(body, link.section, up)
        for link, body in zip(arm.links, stands(arm), strict=True)
    )


def height_up(arm: Arm, index: int) -> FloatVector | None:
    """The direction in a link's frame (from 0) that is up, across the link, with all joints at zero; None where the
    link stands upright there, or the arm has no gravity."""
    if not any(arm.gravity):
        return None
    body = stands(arm)[index]
    across = _across(body, upwards(arm))
    if across is None:
        return None
    link = arm.links[index]
    axes = np.array([link.direction, *section_directions(link, arm.joints[index])], dtype=float)
    placed = np.array([body.along, body.height, body.width])
    x, y, z = (float(item) for item in axes.T @ (placed @ across))
    return snap_vector((x, y, z))


def height_sentences(arm: Arm) -> list[str]:
    """One line for all links whose section bends otherwise along its width than along its height, which is not up:
    what the word suggests and the file neither holds nor says otherwise."""
    by_words: dict[str, list[str]] = {}
    for number, (link, height) in enumerate(zip(arm.links, heights(arm), strict=True), start=1):
        if height is None or height.from_up is None or link.section is None or _bends_alike(link.section):
            continue
        if link.height_direction is not None:
            continue
        if height.words != "up":
            by_words.setdefault(height.words, []).append(str(number))
    if not by_words:
        return []
    text = " and ".join(
        f"{words} in link{'s' if len(numbers) > 1 else ''} {', '.join(numbers)}" for words, numbers in by_words.items()
    )
    return [
        f"with all joints at zero the height of the section points {text}, not up as the word suggests. "
        "`height_direction: up` at a link makes it vertical"
    ]


def _points(body: Stand, section: Section, up: Array | None) -> HeightPoints:
    x, y, z = (float(item) for item in body.height)
    across = None if up is None else _across(body, up)
    level = up is not None and abs(float(body.height @ up)) < _SAME
    if across is None:
        return HeightPoints((x, y, z), None, level)
    angle = math.acos(float(np.clip(body.height @ across, -1.0, 1.0)))
    return HeightPoints((x, y, z), math.pi - angle if angle > math.pi / 2 and _turns(section) else angle, level)


def _across(body: Stand, up: Array) -> Array | None:
    """The unit vector across a link that is nearest to up; None where the link stands upright."""
    across = up - (up @ body.along) * body.along
    size = float(np.linalg.norm(across))
    return None if size < _UPRIGHT else across / size


def _edge(section: Section) -> Array:
    return np.asarray(section.outline()[0], dtype=float)


def _round(section: Section) -> bool:
    """Whether a section is the same whichever way it is turned about the link, as far as drawn edges tell."""
    edge = _edge(section)
    middles = np.linalg.norm(0.5 * (edge + np.roll(edge, 1, axis=0)), axis=1)
    return float(middles.min()) > _ROUND * float(np.linalg.norm(edge, axis=1).max())


def _turns(section: Section) -> bool:
    """Whether a section turned by half a turn is the same, so that its height points down as much as up."""
    edge = _edge(section)
    apart = np.linalg.norm(edge[:, None, :] + edge[None, :, :], axis=2).min(axis=1)
    return float(apart.max()) < _SAME * float(np.abs(edge).max())


def _bends_alike(section: Section) -> bool:
    """Whether a section bends alike in all directions."""
    properties = section.properties(0.3)
    one, other = float(properties.second_moment_y), float(properties.second_moment_z)
    return abs(one - other) < _SAME * (one + other) and abs(float(properties.product_moment_yz)) < _SAME * (one + other)


def _axis(direction: FloatVector) -> str:
    """A direction in the base frame: an axis where it is one."""
    rounded = [round(item, 3) + 0.0 for item in direction]
    if sorted(map(abs, rounded)) == [0.0, 0.0, 1.0]:
        number = [abs(item) for item in rounded].index(1.0)
        return f"{'-' if rounded[number] < 0.0 else ''}{'xyz'[number]}"
    return f"[{', '.join(f'{item:g}' for item in rounded)}]"
