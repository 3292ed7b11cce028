"""`linkwright simulate`: a recording that a model would give, with noise and repeats."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from linkwright.writing import check_target, write_file, write_json
from materials.catalogue import Catalogue
from materials.quantities import InputError, format_quantity, read_quantity
from materials.reading import Mapping, load_yaml, nearest, parse_yaml

from .options import CatalogueFile, JsonFile, asked_of, catalogue_with

if TYPE_CHECKING:
    from arm.chain import Arm
    from diagnose.simulate import Plan, Simulation

HELP = """A recording from a model, for trying things out: poses over the joint ranges, from both sides, with noise.

Example: linkwright simulate arm.yaml --poses 40 --out recording.csv --with '{effect: joint_compliance, at: 2,
compliance: 21 urad/(N*m)}'
"""

_SIDES = ("both", "one", "random")
_MOST_ROWS = 2_000_000


def simulate(
    arm: Annotated[Path, typer.Argument(metavar="ARM", help="The arm file.")],
    poses: Annotated[int, typer.Option("--poses", metavar="N", min=1, max=1_000_000, help="How many poses.")],
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="The recording to write, a CSV file.")],
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
    declare_sigma: Annotated[
        bool, typer.Option("--declare-sigma", help="Write the noise into the settings beside the recording.")
    ] = False,
    json: JsonFile = None,
    catalogue: CatalogueFile = None,
) -> None:
    """Run the command."""
    from linkwright.screen.console import console, waiting

    settings = out.with_suffix(".yaml")
    check_target(out, arm, catalogue)
    check_target(json, arm, catalogue, out)
    check_target(settings, arm, catalogue, json)
    _refuse_others_settings(settings, out)
    with waiting("simulating"):
        from diagnose.recording_files import recording_text, settings_text
        from diagnose.simulate import simulate as simulated

        given = arm_with(arm, effects or [], catalogue_with(catalogue))
        plan = _plan(
            poses, noise, repeats, payloads, sides, temperature, hours, seed, frame_free, outliers,
            joint_side, commands, base_target, orientation,
        )  # fmt: skip
        with asked_of(arm):
            simulation = simulated(given, plan)
        recording = replace(simulation.recording, sigma=plan.noise if declare_sigma and plan.noise > 0.0 else None)
        write_file(out, recording_text(recording, given))
        write_file(settings, settings_text(recording))
    write_json(json, _content(simulation, given, plan))
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


def arm_with(path: Path, entries: list[str], catalogue: Catalogue) -> Arm:
    """The arm of a file with further `effects` entries in YAML's flow form. Raises `InputError`."""
    from arm.files import arm_from, read_arm

    arm = read_arm(path, catalogue)
    if not entries:
        return arm
    parsed = [parse_yaml(text, file="--with") for text in entries]
    for text, entry in zip(entries, parsed, strict=True):
        if not isinstance(entry, dict):
            example = "'{effect: joint_compliance, at: 2, compliance: 21 urad/(N*m)}'"
            raise InputError("", "--with", f"needs an entry such as {example}, not {text!r}")
    content = {**load_yaml(path).content, "effects": parsed}
    added = arm_from(Mapping(content, file="--with"), catalogue)
    return replace(arm, effects=(*arm.effects, *added.effects))


def _refuse_others_settings(settings: Path, out: Path) -> None:
    """Refuse to write over a YAML file beside the recording that is not just a simulated recording's settings."""
    if settings == out:
        raise InputError(out, "", "ends in .yaml; name a CSV file")
    if settings.is_file() and not set(load_yaml(settings).content) <= {"sigma", "frame", "tool"}:
        message = "is there already and holds more than a simulation's settings; name another recording"
        raise InputError(settings, "", message)


def _plan(
    poses: int,
    noise: str,
    repeats: int,
    payloads: str | None,
    sides: str,
    temperature: str | None,
    hours: float | None,
    seed: int,
    frame_free: bool,
    outliers: float,
    joint_side: bool,
    commands: bool,
    base_target: bool,
    orientation: bool,
) -> Plan:
    from diagnose.simulate import Plan

    if sides != "both" and sides != "one" and sides != "random":
        raise InputError("", "--sides", f"{sides!r} is not one of {', '.join(_SIDES)}{nearest(sides, _SIDES)}")
    sigma = read_quantity(noise, "length", file="", key="--noise")
    if sigma < 0.0:
        raise InputError("", "--noise", "cannot be negative")
    masses: tuple[float, ...] = ()
    if payloads is not None:
        masses = tuple(read_quantity(each, "mass", file="", key="--payloads") for each in payloads.split(","))
        if min(masses) < 0.0:
            raise InputError("", "--payloads", "cannot be negative")
    limits = None
    if temperature is not None:
        ends = temperature.split(" to ")
        if len(ends) > 2:
            raise InputError("", "--temperature", f"needs two, e.g. '20 degC to 35 degC', not {temperature!r}")
        low, high = (read_quantity(each, "temperature", file="", key="--temperature") for each in (ends[0], ends[-1]))
        limits = (low, high)
    rows = poses * repeats * max(1, len(masses)) * (2 if sides == "both" else 1)
    if rows > _MOST_ROWS:
        raise InputError("", "--poses", f"would make {rows} rows; at most {_MOST_ROWS} are simulated")
    return Plan(
        poses=poses,
        noise=sigma,
        repeats=repeats,
        payloads=masses,
        sides=sides,
        temperature=limits,
        hours=hours,
        seed=seed,
        free_frame=frame_free,
        outliers=outliers,
        joint_side=joint_side,
        commands=commands,
        base_target=base_target,
        orientation=orientation,
    )


def _content(simulation: Simulation, arm: Arm, plan: Plan) -> dict[str, Any]:
    return {
        "arm": arm.name,
        "rows": simulation.recording.size,
        "poses": plan.poses,
        "seed": plan.seed,
        "noise_mm": 1e3 * plan.noise,
        "rms_error_mm": 1e3 * math.sqrt(float((simulation.error**2).sum(axis=1).mean())),
        "effects": [{"effect": each.effect, "at": list(each.at)} for each in arm.effects],
        "idle": list(simulation.idle),
    }
