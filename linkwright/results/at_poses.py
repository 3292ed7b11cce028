"""The tip's error at poses that were asked for, described: a table of poses, and what each effect has of the error."""

from __future__ import annotations

from collections.abc import Sequence

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.at_pose import PoseError

from .document import Cell, Column, Item, Paragraph, amount, count, length, section, share, table
from .figures_in_words import effect_title, mm, pose, unless_nothing

_SHOWN = 12
"""Poses that a screen shows."""
_LEAD = "Displacement and rotation of the tip in the base frame, with play where the arm's `play` puts it."


def at_poses(arm: Arm, errors: Sequence[PoseError]) -> list[Item]:
    """The section; none where no pose was asked for."""
    if not errors:
        return []
    several = len({error.load_case for error in errors}) > 1
    headings = ["pose", *(["load case"] if several else []), "error", "x", "y", "z", "rotation"]
    details = [Column(f"about {axis}", detail=True) for axis in "xyz"]
    rows = [_row(arm, error, several=several) for error in errors]
    items: list[Item] = [table((*headings, *details), rows, first=_SHOWN, rest=f"{len(rows) - _SHOWN} more")]
    items += [_effects(arm, error, alone=len(errors) == 1, several=several) for error in errors]
    items += [Paragraph(line, "warning") for line in _beyond_range(arm, errors)]
    largest = [error.beyond for error in errors if error.beyond is not None]
    if largest:
        items.append(Paragraph(f"Linearisation error at most {mm(max(largest), 2)} at these poses.", "under"))
    return [section("Error at the pose" if len(errors) == 1 else "Error at the poses", *items, lead=_LEAD)]


def _row(arm: Arm, error: PoseError, *, several: bool) -> list[Cell]:
    case = [count(error.load_case + 1)] if several else []
    shift = [length(unless_nothing(x, error.error)) for x in error.vector]
    turn = [amount(1e3 * unless_nothing(x, error.orientation), "mrad") for x in error.rotation]
    whole = [length(error.error), *shift, amount(1e3 * error.orientation, "mrad")]
    return [pose(arm, error.q), *case, *whole, *turn]


def _effects(arm: Arm, error: PoseError, *, alone: bool, several: bool) -> Item:
    """What each effect has of the error at a pose; of several poses for page and Markdown alone."""
    rows: list[list[Cell]] = [
        [
            effect_title(part.effect),
            share(part.share) if part.share is not None else "",
            *(length(unless_nothing(x, error.error)) for x in part.vector),
            *(amount(1e3 * unless_nothing(x, error.orientation), "mrad") for x in part.rotation),
        ]
        for part in error.by_effect
    ]
    turns = [Column(f"about {axis}", detail=True) for axis in "xyz"]
    case = f", load case {error.load_case + 1}" if several else ""
    title = "" if alone else f"at {pose(arm, error.q)}{case}"
    return table(("effect", "share", "x", "y", "z", *turns), rows, title=title, detail=not alone, folded=not alone)


def _beyond_range(arm: Arm, errors: Sequence[PoseError]) -> list[str]:
    """A line for each pose that a joint's range does not hold."""
    lines = (
        f"At {pose(arm, error.q)} joint {', '.join(map(str, error.outside))} is outside its range."
        for error in errors
        if error.outside
    )
    return list(dict.fromkeys(lines))
