"""`linkwright simulate`: a recording that a model would give, with noise and repeats."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Annotated, Any, cast

import typer

import linkwright as lw
from linkwright.core.units.quantities import InputError, format_quantity
from linkwright.core.units.reading import load_yaml, parse_yaml
from linkwright.output.files import OUTPUT, check_target, write_result

from .options import (
    Anchor,
    Bar,
    Camera,
    CatalogueFile,
    Direction,
    JsonFile,
    TiltLink,
    Tip,
    Torques,
    as_options,
    asked_of,
)

HELP = """A recording from a model, for trying things out: poses over the joint ranges, from both sides, with noise.

Example: linkwright simulate arm.yaml --poses 40 --out recording.csv --with '{effect: joint_compliance, at: 2,
compliance: 21 urad/(N*m)}'
"""


_SETTINGS = frozenset(
    {
        "sigma", "sigma_angle", "frame", "tool", "orientation", "observes", "direction", "anchor", "tilt_link",
        "camera", "tip",
    }
)  # fmt: skip


def simulate(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The recording to write, a CSV file.")],
    poses: Annotated[
        int | None, typer.Option("--poses", metavar="N", min=1, max=1_000_000, help="How many poses.")
    ] = None,
    at: Annotated[
        Path | None, typer.Option("--at", metavar="PLAN", help="Poses, sides, payloads and times of `linkwright plan`.")
    ] = None,
    effects: Annotated[
        list[str] | None,
        typer.Option("--with", metavar="EFFECT", help="An entry of the arm file's `effects`; may be repeated."),
    ] = None,
    noise: Annotated[str, typer.Option("--noise", help="Standard deviation of each component.")] = "15 um",
    repeats: Annotated[int, typer.Option("--repeats", min=1, max=1000, help="Readings in a row at a pose.")] = 3,
    payloads: Annotated[
        str | None, typer.Option("--payloads", metavar="LIST", help="Masses, each with every pose: '0 kg, 5 kg'.")
    ] = None,
    sides: Annotated[str, typer.Option("--sides", help="Joints arrive from: both, one, random.")] = "both",
    temperature: Annotated[
        str | None, typer.Option("--temperature", metavar="RANGE", help="It wanders: '20 degC to 35 degC'.")
    ] = None,
    hours: Annotated[float | None, typer.Option("--hours", min=0.001, max=10_000.0, help="How long it takes.")] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="The same seed gives the same recording.")] = 1,
    frame_free: Annotated[
        bool, typer.Option("--frame-free", help="The instrument stands anywhere; `frame: free` in the settings.")
    ] = False,
    outliers: Annotated[
        float, typer.Option("--outliers", min=0.0, max=0.5, help="Share of readings that are wrong by far.")
    ] = 0.0,
    joint_side: Annotated[bool, typer.Option("--joint-side", help="Encoders on the joints' own side too.")] = False,
    commands: Annotated[bool, typer.Option("--commands", help="Commanded coordinates too.")] = False,
    base_target: Annotated[bool, typer.Option("--base-target", help="A target on the base too.")] = False,
    orientation: Annotated[bool, typer.Option("--orientation", help="How the tool is turned too.")] = False,
    observe: Annotated[
        str,
        typer.Option(
            "--observe",
            help="position, some of x, y, z (xy), along, distance, same_point, plane, tilt, bar or camera.",
        ),
    ] = "position",
    direction: Direction = None,
    anchor: Anchor = None,
    anchor_free: Annotated[
        bool, typer.Option("--anchor-free", help="The settings do not tell where the anchor is.")
    ] = False,
    tilt_link: TiltLink = None,
    bar: Bar = None,
    camera: Camera = None,
    torques: Torques = None,
    declare_sigma: Annotated[
        bool, typer.Option("--declare-sigma", help="Write the noise into the settings beside the recording.")
    ] = False,
    tip: Tip = None,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.face.recording import with_effects
    from linkwright.screen.console import console
    from linkwright.screen.progress import waiting

    if (poses is None) == (at is None):
        message = "is missing; say how many, or name a plan with --at" if at is None else "goes without --at; drop one"
        raise InputError("", "--poses", message)
    check_target(out, arm, catalogue, at)
    if out == OUTPUT:
        raise InputError("", "--out", "needs the name of a file; the settings are written beside it")
    settings = out.with_suffix(".yaml")
    check_target(json, arm, catalogue, out)
    check_target(settings, arm, catalogue, json)
    refuse_others_settings(settings, out)
    with waiting("simulating"):
        given = lw.read_arm(arm, catalogue=catalogue, tip=tip)
        with asked_of(arm), as_options():
            entries = read_entries(effects or [])
            with_effects(given, entries, as_in_files=True)
            made = lw.simulate(
                given,
                poses=1 if poses is None else poses,
                with_=entries,
                noise=noise,
                repeats=repeats,
                payloads=() if payloads is None else payloads.split(","),
                sides=sides,  # pyright: ignore[reportArgumentType] - what it can be is checked there
                temperature=None if temperature is None else _span(temperature),
                hours=hours,
                seed=seed,
                frame_free=frame_free,
                outliers=outliers,
                joint_side=joint_side,
                commands=commands,
                base_target=base_target,
                orientation=orientation,
                declare_sigma=declare_sigma,
                observe=observe,
                direction=None if direction is None else numbers(direction),
                anchor=listed(anchor),
                anchor_free=anchor_free,
                tilt_link=tilt_link,
                bar=listed(bar),
                camera=camera,  # pyright: ignore[reportArgumentType] - what it can be is checked there
                torques=listed(torques),
                at=at,
            )
        made.save(out)
    write_result(json, made.to_json())
    simulation, plan, recording = made.made, made.plan, made.found
    screen = console()
    rms = format_quantity(math.sqrt(float((simulation.error**2).sum(axis=1).mean())), "length", digits=3)
    scatter = format_quantity(plan.noise, "length", digits=3)
    what = f"the model moves the tip by {rms} RMS, noise {scatter} a component"
    screen.print(f"{given.name}: {recording.size} readings of {plan.poses} poses; {what}", soft_wrap=True)
    for name in dict.fromkeys(simulation.idle):
        screen.print(f"note: {name} moves nothing that this recording holds (linkwright effects show {name})")
    for path in (out, settings, json):
        if path is not None:
            screen.print(f"written: {path}", soft_wrap=True)


def read_entries(texts: list[str]) -> list[dict[str, Any]]:
    """Entries of an arm file's `effects` in YAML's flow form. Raises `InputError`."""
    entries: list[dict[str, Any]] = []
    for text in texts:
        entry = parse_yaml(text, file="--with")
        if not isinstance(entry, dict):
            example = "'{effect: joint_compliance, at: 2, compliance: 21 urad/(N*m)}'"
            raise InputError("", "--with", f"needs an entry such as {example}, not {text!r}")
        entries.append(cast(dict[str, Any], entry))
    return entries


def listed(text: str | None) -> list[str] | None:
    """The parts of a list as text, None where there is none."""
    return None if text is None else [each.strip() for each in text.split(",")]


def numbers(text: str) -> list[float]:
    """The numbers of a direction. Raises `InputError`."""
    try:
        return [float(each) for each in text.split(",")]
    except ValueError:
        raise InputError("", "--direction", f"needs three numbers such as '0, 0, 1', not {text!r}") from None


def _span(text: str) -> tuple[str, str]:
    ends = text.split(" to ")
    if len(ends) > 2:
        raise InputError("", "--temperature", f"needs two, e.g. '20 degC to 35 degC', not {text!r}")
    return ends[0], ends[-1]


def refuse_others_settings(settings: Path, out: Path) -> None:
    """Refuse to write over a YAML file beside the recording that is not just a simulated recording's settings."""
    if settings == out:
        raise InputError(out, "", "ends in .yaml; name a CSV file")
    if os.path.isfile(settings) and not set(load_yaml(settings).content) <= _SETTINGS:
        message = "is there already and holds more than a simulation's settings; name another recording"
        raise InputError(settings, "", message)
