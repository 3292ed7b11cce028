"""`linkwright inverse`: the joint coordinates that put the tip at a point."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any

import typer

import linkwright as lw
from linkwright.output.files import check_target, write_result
from linkwright.results.figures_in_words import MINUS, coordinate, figure

from .options import CatalogueFile, JsonFile, Tip, as_options

if TYPE_CHECKING:
    from linkwright.core.arm.chain.chain import Arm
    from linkwright.core.arm.worst.inverse import InversePose

HELP = """The joint coordinates within the joint ranges that put the tip at a point, every branch.

Example: linkwright inverse arm.yaml "800 mm" "-200 mm" --inclination "30 deg"
"""
SETTINGS: Mapping[str, Any] = MappingProxyType({"ignore_unknown_options": True})
"""A length may be negative, and `-200 mm` is no option."""


def inverse(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    x: Annotated[str, typer.Argument(metavar="X", help="A length with its unit, in the base frame: '800 mm'.")],
    y: Annotated[str, typer.Argument(metavar="Y", help="Another.")],
    z: Annotated[str | None, typer.Argument(metavar="[Z]", help="Another; 0 without it.")] = None,
    inclination: Annotated[
        str | None,
        typer.Option("--inclination", metavar="ANGLE", help="The last link's angle from the x axis; planar arms."),
    ] = None,
    most: Annotated[int, typer.Option("--most", min=1, max=1000, help="Poses to show at most.")] = 16,
    tip: Tip = None,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.screen.console import console
    from linkwright.screen.progress import waiting

    check_target(json, arm, catalogue)
    with as_options(x="X", y="Y", z="Z"), waiting("looking for poses"):
        given = lw.read_arm(arm, catalogue=catalogue, tip=tip)
        found = lw.inverse(given, x, y, z, inclination=inclination, most=most)
    write_result(json, found.to_json())
    screen = console()
    poses = found.found
    place = ", ".join(figure(1e3 * value) for value in found.point)
    count = "1 pose" if len(poses) == 1 else f"{len(poses)} poses"
    screen.print(f"{found.arm.name}: {count} at ({place}) mm, within the joint ranges", style="bold")
    screen.print(_table(found.arm.model, poses))
    if not all(pose.isolated or pose.singular for pose in poses):
        screen.print("samples of a family: the joints can move on while the tip stays", soft_wrap=True)
    if found.arm.model.branches:
        screen.print(f"the tip is {found.arm.model.tip}'s; the other arms' joints stand in mid-range", soft_wrap=True)
    if json is not None:
        screen.print(f"written: {json}", soft_wrap=True)


def _table(arm: Arm, found: tuple[InversePose, ...]) -> Any:
    from linkwright.json.inverse import at_limit
    from linkwright.screen.console import table

    headings = [
        f"joint {index + 1} ({coordinate(arm, index, low)} to {coordinate(arm, index, high)})"
        for index, (low, high) in enumerate(joint.range for joint in arm.joints)
    ]
    shown = table(*headings, "", numbers=tuple(range(arm.size)))
    for pose in found:
        words = ["singular"] if pose.singular else []
        words += [f"joint {index + 1} at its limit" for index in at_limit(arm, pose)]
        shown.add_row(
            *(_coordinate(arm, index, value) for index, value in enumerate(arm.whole_pose(pose.q))), ", ".join(words)
        )
    return shown


def _coordinate(arm: Arm, index: int, value: float) -> str:
    """Fine enough that the tip comes within a hundredth of a millimetre of the point: 0.001 degrees, 0.001 mm."""
    shown = math.degrees(value) if arm.joints[index].revolute else 1e3 * value
    return f"{round(shown, 3) + 0.0:.3f}{'°' if arm.joints[index].revolute else ' mm'}".replace("-", MINUS)
