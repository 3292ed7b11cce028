"""`linkwright plan`: which poses, payloads and sides are worth recording."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

import linkwright as lw
from linkwright.commands.options import (
    Anchor,
    Bar,
    Camera,
    CatalogueFile,
    Direction,
    JsonFile,
    MarkdownFile,
    TiltLink,
    Tip,
    Torques,
    as_options,
    asked_of,
    not_lost,
    tell,
)
from linkwright.commands.simulate import listed, numbers, refuse_others_settings
from linkwright.core.units.quantities import InputError, shown
from linkwright.output.files import OUTPUT, check_target, write_result

HELP = """Which poses, payloads and sides are worth recording, in which order, and what they will show.

Example: linkwright plan arm.yaml --poses 30 --for joint_compliance,backlash --out plan.csv
"""


def plan(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    poses: Annotated[int, typer.Option("--poses", metavar="N", help="How many visits: a pose, a payload, sides.")],
    effects: Annotated[
        str,
        typer.Option("--for", metavar="EFFECTS", help="What to see: 'backlash, joint_compliance:2'; else everything."),
    ] = "",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="The plan: a recording whose tip is still blank.")
    ] = None,
    instrument: Annotated[
        str,
        typer.Option(
            "--instrument",
            help="tracker, x, y, z, xy, xz, yz, along, distance, tilt, camera, same_point, plane or bar.",
        ),
    ] = "tracker",
    direction: Direction = None,
    anchor: Anchor = None,
    anchor_free: Annotated[
        bool, typer.Option("--anchor-free", help="The anchor is about there: the recording has to tell where.")
    ] = False,
    tilt_link: TiltLink = None,
    camera: Camera = None,
    bar: Bar = None,
    bars: Annotated[
        int | None,
        typer.Option("--bars", metavar="N", help="In how many places the bar lies; 1: it is fixed."),
    ] = None,
    sigma: Annotated[
        str | None,
        typer.Option("--sigma", metavar="LENGTH", help="What each component scatters by; 15 um (a tilt: 15 urad)."),
    ] = None,
    sigma_depth: Annotated[
        str | None, typer.Option("--sigma-depth", metavar="LENGTH", help="Of a camera's depths; five times sigma.")
    ] = None,
    torques: Torques = None,
    sigma_angle: Annotated[
        str | None, typer.Option("--sigma-angle", metavar="ANGLE", help="Of a camera's turns; sigma over 0.1 m.")
    ] = None,
    repeats: Annotated[int, typer.Option("--repeats", metavar="N", help="Readings in a row at each visit.")] = 3,
    payload: Annotated[
        list[str] | None,
        typer.Option("--payload", metavar="MASS", help="May be repeated; else without and with the arm's own."),
    ] = None,
    frame: Annotated[str, typer.Option("--frame", help="Where the instrument stands: known, or free.")] = "known",
    tool: Annotated[str, typer.Option("--tool", help="Where the target sits on the tool: known, or free.")] = "known",
    avoid: Annotated[
        list[str] | None,
        typer.Option(
            "--avoid",
            metavar="REGION",
            help="'0.5 m, -1 m, 0 m to 2 m, 1 m, 0.4 m', 'below z 0 mm' or 'above z 2 m'; may be repeated.",
        ),
    ] = None,
    after: Annotated[
        list[Path] | None,
        typer.Option(
            "--after",
            metavar="RECORDING",
            help="Go on from it (may be repeated): what it could not tell is asked.",
        ),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="The same seed gives the same plan.")] = 1,
    tip: Tip = None,
    json: JsonFile = None,
    markdown: MarkdownFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.results.planning import describe
    from linkwright.screen.console import console
    from linkwright.screen.progress import waiting

    for target in (out, json, markdown):
        check_target(target, arm, *(after or []), catalogue)
    if out == OUTPUT:
        raise InputError("", "--out", "needs the name of a file; --json - writes to standard output")
    with waiting("reading") as told, asked_of(arm), as_options(for_="--for", payloads="--payload"):
        given = lw.read_arm(arm, catalogue=catalogue, tip=tip)
        found = lw.plan(
            given,
            poses=poses,
            for_=[each for each in effects.split(",") if each.strip()],
            instrument=instrument,
            sigma=sigma,
            repeats=repeats,
            payloads=payload,
            frame=frame,  # pyright: ignore[reportArgumentType] - what it can be is checked there
            tool=tool,  # pyright: ignore[reportArgumentType]
            avoid=[_region(text) for text in avoid or []],
            after=after[0] if after and len(after) == 1 else after,
            direction=None if direction is None else numbers(direction),
            anchor=listed(anchor),
            anchor_free=anchor_free,
            tilt_link=tilt_link,
            camera=camera,  # pyright: ignore[reportArgumentType]
            bar=listed(bar),
            bars=bars,
            sigma_depth=sigma_depth,
            sigma_angle=sigma_angle,
            torques=listed(torques),
            seed=seed,
            progress=told,
        )
    described = describe(found.found)
    beside = None if out is None or found.settings is None else out.with_suffix(".yaml")
    with not_lost(described):
        if out is not None and beside is not None:
            check_target(beside, arm, catalogue, json)
            refuse_others_settings(beside, out)
        write_result(json, found.to_json())
        if out is not None:
            found.save(out)
    tell(described, markdown, out, beside, json)
    if found.interrupted:
        console(errors=True).print("stopped: this is the best plan so far", soft_wrap=True)
        raise KeyboardInterrupt


def _region(text: str) -> dict[str, Any] | tuple[list[str], list[str]]:
    """A half-space, or a box by two corners, as `--avoid` has them."""
    words = text.split(maxsplit=2)
    if len(words) == 3 and words[0] in ("below", "above"):
        return {words[0]: {words[1]: words[2]}}
    low, to, high = text.partition(" to ")
    if not to:
        would_do = "two corners, '0.5 m, -1 m, 0 m to 2 m, 1 m, 0.4 m', or a side, 'below z 0 mm'"
        raise InputError("", "--avoid", f"needs {would_do}, not {shown(text)}")
    return [each.strip() for each in low.split(",")], [each.strip() for each in high.split(",")]
