"""The links laid out in line, to scale and with dimensions: lengths, outer sizes, walls, joints' numbers, payload.

Each is drawn as its side is seen with all joints at zero (`arm.placed.views.sides`), so that what stands upright in the
arm stands upright here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from linkwright.core.arm.chain.chain import Arm, Link, LoadCase
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.arm.placed.heights import HeightPoints, heights
from linkwright.core.arm.placed.views import Side, sides
from linkwright.core.sections.numeric import Array
from linkwright.report.pictures.svg import Levels, width_of
from linkwright.results.figures_in_words import figure, with_unit

from .svg import drawing, element, label, line, path, text

_WIDTH, _MARGIN, _SIZE = 460.0, 26.0, 11.5
_ROW = 1.25 * _SIZE
_TALLEST = 0.4 * _WIDTH
_BALLOON = 8.0
_FEW_EDGES = 8
"""A section with edges at more heights is round, or rounded; its side view shows but its walls."""


def side_view(arm: Arm, cases: Sequence[LoadCase]) -> str:
    """The picture, with what is said of it below; links as high as their sections."""
    steps = _Steps(arm)
    words = "All links laid out in line, whatever the pose: lengths, height × width (⌀ where round) and walls, in mm. "
    words += "Each is drawn from its side as it stands with all joints at zero, and it is said where its height points."
    if steps.offsets:
        words += " Thin lines are offsets between joints, and the tool."
    about = f"{arm.name} laid out in line, with dimensions"
    left, top, height, parts = _drawn(arm, max(case.mass for case in cases), steps)
    picture = drawing(left, top, _WIDTH, height, about, *parts)
    return element("div", element("figure", picture, element("figcaption", text(words))), class_="dimensioned")


class _Steps:
    """Where links begin and end along the line, and where offsets run (mm). Beside a slide, the sum of lengths is no
    reach, and is not drawn (`in_line`)."""

    def __init__(self, arm: Arm) -> None:
        middle = [0.5 * (low + high) for low, high in (joint.range for joint in arm.joints)]
        here, self.links, self.offsets = 0.0, list[tuple[float, float]](), list[tuple[float, float]]()
        for link, frame in zip(arm.links, place(arm, middle).joints, strict=True):
            here = self._offset(here, frame.lead)
            self.links.append((here, here + 1e3 * link.length))
            here += 1e3 * link.length
        self.end = self._offset(here, arm.tool)
        self.in_line = all(joint.revolute for joint in arm.joints)

    def _offset(self, here: float, step: Sequence[object]) -> float:
        long = 1e3 * float(np.linalg.norm(np.array(step, dtype=float)))
        if long > 1e-6:
            self.offsets.append((here, here + long))
        return here + long


def _drawn(arm: Arm, payload: float, steps: _Steps) -> tuple[float, float, float, list[str]]:
    drawn = [_seen(side, link) for side, link in zip(sides(arm), arm.links, strict=True)]
    tallest = max((2.0 * abs(edge) for item in drawn for end in item.ends for edge in end), default=0.0)
    scale = min((_WIDTH - 2 * _MARGIN) / max(steps.end, 1e-9), _TALLEST / max(tallest, 1e-9))
    half = max(0.5 * scale * tallest, _BALLOON)
    room = (-_MARGIN, _WIDTH - _MARGIN)
    parts = [line((scale * a, 0.0), (scale * b, 0.0), "lead", 1.5) for a, b in steps.offsets]
    for each, (start, end) in zip(drawn, steps.links, strict=True):
        parts += _link(each, (scale * start, scale * end), scale)
    parts.append(element("circle", cx=scale * steps.end, cy=0.0, r=4.0, class_="tip"))
    above, top = _sizes(arm, drawn, payload, steps, scale, half, room)
    below, bottom = _lengths(steps, scale, half, room)
    parts += [*above, *below, *_joints(steps, scale)]
    return room[0], top, bottom - top, parts


@dataclass(frozen=True)
class _Seen:
    """A link's side: how far (mm) its foot and its top are off its axis at both ends, and edges between them that are
    hidden; nothing where it has no section."""

    ends: tuple[tuple[float, float], ...]
    edges: tuple[float, ...]

    @property
    def top(self) -> float:
        """How far its top is off the axis at the middle of its length, mm."""
        return 0.5 * (self.ends[0][1] + self.ends[-1][1]) if self.ends else 0.0


def _seen(side: Side, link: Link) -> _Seen:
    if link.section is None:
        return _Seen((), ())
    near, *far = link.section.ends
    rings = [1e3 * side.section(np.asarray(ring))[:, 1] for ring in near.outline()]
    ends = [(float(rings[0].min()), float(rings[0].max()))]
    for section in far:
        edge = 1e3 * side.section(np.asarray(section.outline()[0]))[:, 1]
        ends.append((float(edge.min()), float(edge.max())))
    return _Seen(tuple(ends), tuple(_edges(rings)))


def _link(drawn: _Seen, span: tuple[float, float], scale: float) -> list[str]:
    start, end = span
    if not drawn.ends:
        return [line((start, 0.0), (end, 0.0), "lead", 4.0)]
    (foot, top), (far_foot, far_top) = drawn.ends[0], drawn.ends[-1]
    places = [(start, -top), (end, -far_top), (end, -far_foot), (start, -foot)]
    parts = [path([[(x, scale * y) for x, y in places]], "link after")]
    for edge in drawn.edges:
        far = far_foot + (edge - foot) / (top - foot) * (far_top - far_foot)
        parts.append(line((start, -scale * edge), (end, -scale * far), "hidden", 0.8))
    return parts


def _joints(steps: _Steps, scale: float) -> list[str]:
    parts: list[str] = []
    taken = Levels()
    for number, (start, _) in enumerate(steps.links, start=1):
        x = scale * start
        y = -2.2 * _BALLOON * taken.placed(x - _BALLOON, x + _BALLOON)
        parts.append(element("circle", cx=x, cy=y, r=_BALLOON, class_="joint", stroke_width=1.4))
        parts.append(label(x, y + 4.0, _SIZE, str(number), class_="figures"))
    return parts


def _sizes(
    arm: Arm,
    drawn: Sequence[_Seen],
    payload: float,
    steps: _Steps,
    scale: float,
    half: float,
    room: tuple[float, float],
) -> tuple[list[str], float]:
    """What stands above the links, each in the lowest row where it is free, and how far up that goes."""
    notes = [
        (0.5 * scale * (start + end), -scale * item.top, _words(number, link, height))
        for number, (link, item, height, (start, end)) in enumerate(
            zip(arm.links, drawn, heights(arm), steps.links, strict=True), start=1
        )
    ]
    notes.append((scale * steps.end, 0.0, [f"payload {with_unit(payload, 'kg')}"]))
    rows, placed = Levels(), list[tuple[float, float, float, int, list[str]]]()
    for x, begin, shown in notes:
        wide = max(width_of(item, _SIZE) for item in shown)
        middle = min(max(x, room[0] + 0.5 * wide + 2.0), room[1] - 0.5 * wide - 2.0)
        placed.append((x, begin, middle, rows.placed(middle - 0.5 * wide - 4.0, middle + 0.5 * wide + 4.0), shown))
    tall = [max(len(shown) for *_, row, shown in placed if row == k) * _ROW + 6.0 for k in range(len(rows.rows))]
    foot = [-half - 12.0 - sum(tall[:k]) for k in range(len(tall))]
    parts: list[str] = []
    for x, begin, middle, row, shown in placed:
        parts.append(line((x, begin), (x, foot[row] + 2.0), "axis", 1.0))
        parts += [
            label(middle, foot[row] - 3.0 - (len(shown) - 1 - k) * _ROW, _SIZE, item, class_="figures")
            for k, item in enumerate(shown)
        ]
    # The words stand over the lines that lead to those above them.
    parts.sort(key=lambda part: not part.startswith("<line"))
    return parts, foot[-1] - tall[-1] - 2.0


def _lengths(steps: _Steps, scale: float, half: float, room: tuple[float, float]) -> tuple[list[str], float]:
    """Dimension lines below the links, each in the first row where it is free, and how far down that goes."""
    spans = [(a, b) for a, b in sorted([*steps.links, *steps.offsets]) if b - a > 1e-6]
    if len(spans) > 1 and steps.in_line:
        spans.append((0.0, steps.end))
    rows = Levels()
    parts: list[str] = []
    deepest = half
    for a, b in spans:
        start, end, words = scale * a, scale * b, figure(b - a, 5)
        wide = width_of(words, _SIZE)
        middle = min(max(0.5 * (start + end), room[0] + 0.5 * wide), room[1] - 0.5 * wide)
        row = rows.placed(min(start, middle - 0.5 * wide) + 0.5, max(end, middle + 0.5 * wide) - 0.5)
        y = half + 24.0 + 19.0 * row
        deepest = max(deepest, y)
        parts += [line((x, 0.0), (x, y + 3.0), "axis", 0.8) for x in (start, end)]
        parts.append(line((start, y), (end, y), "rule", 1.0))
        parts += [line((x - 3.0, y + 3.0), (x + 3.0, y - 3.0), "rule", 1.0) for x in (start, end)]
        parts.append(label(middle, y - 3.5, _SIZE, words, class_="figures"))
    parts.sort(key=lambda part: 'class="axis"' not in part)
    return parts, deepest + 10.0


def _words(number: int, link: Link, height: HeightPoints | None) -> list[str]:
    section = link.section
    if section is None:
        return [f"link {number}", "rigid" if link.compliance is None else "by a matrix"]
    given = section.given()
    walls = [_figures(value) for name, value in given.items() if "thickness" in name]
    sizes = [item for item in (_figures(value) for name, value in given.items() if name == "diameter") if item]
    near = 1e3 * np.asarray(section.ends[0].outline()[0])
    across, high = (figure(float(np.ptp(near[:, k])), 4) for k in (0, 1))
    outer = f"⌀ {sizes[0]}" if sizes else f"{high} × {across}"
    lines = [f"link {number}", outer, *([] if height is None else [f"height {height.words}"])]
    return [*lines, f"walls {', '.join(walls)}" if len(walls) > 1 else f"wall {walls[0]}"] if walls else lines


def _figures(value: object) -> str:
    ends = value if isinstance(value, tuple) else (value,)
    return " to ".join(figure(1e3 * float(end), 4) for end in ends if isinstance(end, float | int))


def _edges(rings: Sequence[Array]) -> list[float]:
    """Heights (mm, from the axis) at which a section has edges between its top and its foot; of each of its rings the
    places (mm) up the page."""
    low, high = float(rings[0].min()), float(rings[0].max())
    result: set[float] = set()
    for k, ring in enumerate(rings):
        edges = np.unique(np.round(ring, 3))
        if len(edges) > _FEW_EDGES:
            edges = edges[[0, -1]] if k else edges[:0]
        result |= {float(edge) for edge in edges}
    return sorted(edge for edge in result if low + 0.01 < edge < high - 0.01)
