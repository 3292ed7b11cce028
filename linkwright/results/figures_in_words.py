"""Figures, poses, sections and load cases in words, the same on the screen and in reports."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, cast

from linkwright.core.units.temperature import ZERO_CELSIUS

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm, Calibrated, Link, LoadCase
    from linkwright.core.arm.worst.workspace import Workspace
    from linkwright.core.optimize.robust.result import RobustFigure

MINUS = "−"
_NOTHING = 1e-8


def figure(value: float | None, digits: int = 4) -> str:
    """A number in so many significant digits, without exponent where that stays readable; a dash where unknown."""
    if value is None or math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else f"{MINUS}∞"
    if value == 0.0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if size < -5 or size >= 7:
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}".replace("-", MINUS)
    text = f"{value:.{max(0, digits - 1 - size)}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return text.replace("-", MINUS) if text not in ("-0", "0") else "0"


def unless_nothing(value: float, largest: float) -> float:
    """A value, zero where it is what rounding, and the search for a pose, leave of nothing beside the largest."""
    return 0.0 if abs(value) < _NOTHING * largest else value


def from_to(before: str, after: str) -> str:
    """Two quantities as a change, with their unit once where both have the same."""
    size, _, unit = before.rpartition(" ")
    return f"{size if after.endswith(f' {unit}') else before} → {after}"


def percent(value: float, digits: int = 2) -> str:
    """A ratio as a percentage."""
    return "–" if math.isnan(value) else f"{figure(100.0 * value, digits)} %"


def mm(metres: float | None, digits: int = 4) -> str:
    """A length with its unit, millimetres."""
    return "–" if metres is None else f"{figure(1e3 * metres, digits)} mm"


def with_unit(value: float | None, unit: str, digits: int = 4) -> str:
    """A figure with its unit, a dash where it is not known."""
    return "–" if value is None else f"{figure(value, digits)} {unit}"


def lasted(seconds: float, before: str = " in ") -> str:
    """How long something took, behind such words; nothing where SOURCE_DATE_EPOCH is set, for whoever sets it wants
    the same bytes each time."""
    return "" if os.environ.get("SOURCE_DATE_EPOCH") else f"{before}{with_unit(seconds, 's', 3)}"


def coordinate(arm: Arm, index: int, value: float) -> str:
    """One joint coordinate: degrees for a joint that turns, millimetres for one that slides."""
    if arm.joints[index].revolute:
        shown = round(math.degrees(value), 2) + 0.0
        return f"{shown:g}°".replace("-", MINUS)
    return f"{round(1e3 * value, 2) + 0.0:g} mm".replace("-", MINUS)


def pose(arm: Arm, q: Sequence[float]) -> str:
    """A pose as its joint coordinates, from the base out."""
    return ", ".join(coordinate(arm, index, value) for index, value in enumerate(arm.whole_pose(q)))


def shape_words(shape: str | None, dimensions: Mapping[str, float]) -> str:
    """A section as its shape and its dimensions (m), one after another."""
    if shape is None:
        return "rigid"
    parts = [
        f"{name.replace('_', ' ')} {' to '.join(figure(1e3 * end, 5) for end in ends)}"
        for name, value in dimensions.items()
        if (ends := _ends(value))
    ]
    return f"{shape.replace('_', ' ')}: {', '.join(parts)} mm" if parts else shape.replace("_", " ")


def _ends(value: object) -> tuple[float, ...]:
    """One length, or those at both ends of a taper; none for the points of a polygon."""
    ends = cast(tuple[object, ...], value) if isinstance(value, tuple) else (value,)
    return tuple(float(end) for end in ends if isinstance(end, float | int))


def section_words(link: Link) -> str:
    """A link's section: its stock name or its shape, with dimensions."""
    if link.section is None:
        return "rigid" if link.compliance is None else "by its stiffness matrix"
    words = shape_words(link.section.shape, link.section.given())
    return f"{link.section_name} ({words})" if link.section_name else words


def material_words(link: Link) -> str:
    """The name of a link's material."""
    return "–" if link.material is None else link.material.name


def load_case_words(case: LoadCase) -> str:
    """What acts at the tip in a load case."""
    parts = [f"payload {with_unit(case.mass, 'kg')}"]
    if any(case.force):
        parts.append(f"force ({', '.join(figure(value) for value in case.force)}) N")
    if any(case.moment):
        parts.append(f"moment ({', '.join(figure(value) for value in case.moment)}) N·m")
    if any(case.acceleration):
        parts.append(f"base accelerated by ({', '.join(figure(value) for value in case.acceleration)}) m/s²")
    if case.moving is not None:
        parts.append(f"moving, at {with_unit(case.moving.time, 's')}")
    return f"{f'tip {case.tip}: ' if case.tip else ''}{', '.join(parts)}"


def calibrated_words(state: Calibrated) -> str:
    """The state that an arm was calibrated in, as a phrase."""
    load = "each load case's own payload" if state.payload is None else load_case_words(state.payload)
    if state.temperature is None:
        return f"{load}, at the temperature of work"
    return f"{load}, at {figure(state.temperature - ZERO_CELSIUS)} degC"


def workspace_words(arm: Arm, workspace: Workspace, cases: Sequence[LoadCase] = ()) -> str:
    """Where the arm works, as a phrase; `cases` are what it bears there."""
    if workspace.kind == "joints":
        ranges = workspace.ranges or tuple(joint.range for joint in arm.joints)
        spans = [
            f"joint {index + 1} {coordinate(arm, index, low)} to {coordinate(arm, index, high)}"
            for index, (low, high) in enumerate(ranges)
        ]
        return f"all poses within the joint ranges: {'; '.join(spans)}"
    if workspace.kind == "poses" and any(case.moving is not None for case in cases):
        return f"the {len(workspace.poses)} instants of the motion at which the tip errs or a link bears most"
    if workspace.kind == "poses":
        return f"{len(workspace.poses)} poses that the problem lists"
    used = 2 if workspace.in_plane else 3
    points = [f"({', '.join(figure(1e3 * value) for value in point[:used])})" for point in workspace.points]
    if workspace.kind == "box":
        return f"all poses whose tip lies in the box from {points[0]} mm to {points[1]} mm"
    if workspace.apart:
        return f"all poses whose tip stands at {', '.join(points)} mm"
    return f"all poses whose tip lies on the path {' – '.join(points)} mm"


def effect_title(effect: str) -> str:
    """An effect's title, as its file gives it."""
    from linkwright.core.arm.effects import EFFECTS

    return EFFECTS[effect].title if effect in EFFECTS else effect.replace("_", " ")


def robust_words(result: RobustFigure) -> str:
    """The error over what is uncertain, with what it rests on."""
    widths = {name: sorted({round(x, 9) for x in spread if x > 0.0}) for name, spread in result.widths.items()}
    spans = [
        f"{name.replace('_', ' ')} ± {' or '.join(_width(name, width) for width in each)}"
        for name, each in widths.items()
        if each
    ]
    over = f"{mm(result.nominal)} as it is; {', '.join(spans)}"
    if result.share == 1.0:
        singles = [f", {name.removeprefix('max_error ')} {mm(error)}" for name, error in result.singles.items()]
        worst = f"worst error {mm(result.value)}{''.join(singles)} over what is uncertain"
        return f"{worst} ({over}; {result.looked_at} scenarios compared)"
    upper = "" if result.upper is None else f", below {mm(result.upper)} with 95 % confidence"
    rests_on = f"sampled: {result.looked_at} fresh scenarios"
    return f"worst error {mm(result.value)} in {percent(result.share)} of what is uncertain{upper} ({over}; {rests_on})"


def _width(name: str, width: float) -> str:
    """How far a figure may be off, in its unit."""
    from linkwright.core.optimize.uncertain import KINDS
    from linkwright.core.units.quantities import format_quantity

    kind = KINDS.get(name, "dimensionless")
    return percent(width) if kind == "dimensionless" else format_quantity(width, kind, digits=4)


def factor_words(before: float, after: float) -> str:
    """How many times smaller or larger something became."""
    if before <= 0.0 or after <= 0.0:
        return ""
    ratio = before / after
    if abs(ratio - 1.0) < 5e-4:
        return "unchanged"
    if abs(ratio - 1.0) < 5e-3:
        return f"{percent(1.0 - 1.0 / ratio)} smaller" if ratio > 1.0 else f"{percent(1.0 / ratio - 1.0)} larger"
    return f"{figure(ratio, 3)} times smaller" if ratio > 1.0 else f"{figure(1.0 / ratio, 3)} times larger"
