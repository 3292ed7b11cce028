"""Instruments against a tracker, on an arm of the second generator: which causes are found at which size.

    python -m benchmarks.instruments.against [--causes backlash ...] [--sizes 1 2 4 8] [--page docs/recordings.md]

An arm of three joints in space is played by MuJoCo (`benchmarks.multibody`) with one cause at a time, so large that
what frame and geometry leave of it moves the tip by so many times the noise (RMS, against the noise's length). Every
instrument reads the same visits with 20 um (a level: 20 urad; a camera: 100 um in depth and turns to 0.1 mrad; torques
on the joints' side: 0.5 % of how far they spread). A cause counts as `named` where it is a finding at its place,
`listed` where it is among the names that the data cannot tell from a finding; what is named beside it or instead of it
is counted as `wrong`. With `--page` the page's table is written anew: the least size from which the cause is named with
nothing beside it.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.blind.generator.arms import Ranges, arm_file
from benchmarks.blind.generator.mechanics import Arm as DrawnArm
from benchmarks.instruments.page import write_table
from benchmarks.multibody.arms import draw_arm
from benchmarks.multibody.causes import Cause, Stage, draw_cause, possible
from benchmarks.multibody.doses import dosed
from benchmarks.multibody.engine import machine
from benchmarks.multibody.instrument import draw_mount
from benchmarks.multibody.session import Plan, Tips, draw_session, played
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.diagnosis import diagnose
from linkwright.core.diagnose.instruments.instrument import DISTANCE, KINDS, Instrument
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.sections.numeric import Array

NOISE = 20e-6
ANCHOR = (1.1, -0.7, 0.2)
FAMILY, LINKS = "spatial_3r", 3
CAUSES = (
    "joint_compliance", "backlash", "friction_windup", "encoder_offset", "link_length", "payload", "base_tilt",
    "encoder_eccentricity", "axis_misalignment", "joint_coupling",
)  # fmt: skip

DEEP, TURNS = 5.0 * NOISE, 5.0 * NOISE  # m and rad, of a camera
TORQUES = 0.005  # of how far each drive's torque spreads

Values = tuple[Array, tuple[int, ...], dict[str, object]]
"""What is read at each visit without noise (V, W), of which slots, and what else the recording holds; arrays of it go
by visit."""


def tracker(tips: Tips, rng: np.random.Generator) -> Values:
    """The whole place, from somewhere."""
    mount = draw_mount(False, rng)
    return tips.reading.T @ mount.turn.T + mount.shift, (), {"frame": "free"}


def heights(tips: Tips, rng: np.random.Generator) -> Values:
    """z alone, by a height gauge on the base."""
    del rng
    return tips.reading[2:].T, (2,), {}


def wire(tips: Tips, rng: np.random.Generator) -> Values:
    """Distances from an anchor whose place is known."""
    del rng
    instrument = Instrument(("distance",), anchor=ANCHOR)
    return np.linalg.norm(tips.reading.T - ANCHOR, axis=1)[:, None], (DISTANCE,), {"instrument": instrument}


def ballbar(tips: Tips, rng: np.random.Generator) -> Values:
    """The same, from an anchor whose place nobody knows."""
    values, slots, _ = wire(tips, rng)
    return values, slots, {"instrument": Instrument(("distance",))}


def level(tips: Tips, rng: np.random.Generator) -> Values:
    """A level on the last link."""
    del rng
    turns = np.stack([rest.turn for rest in tips.rests])
    values = np.column_stack([turns[:, 2, 1], -turns[:, 2, 0]])
    return values, KINDS["tilt"], {"instrument": Instrument(("tilt",), tilt_link=LINKS)}


def camera(tips: Tips, rng: np.random.Generator, *, on_tool: bool) -> Values:
    """A camera that sees a target, one of both on the tool; where they are nobody knows."""
    fixed, seat = (Rotation.random(rng=rng).as_matrix() for _ in range(2))
    flange = np.stack([rest.turn for rest in tips.rests])
    carried, at = flange @ seat, tips.reading.T + flange @ rng.uniform(-0.1, 0.1, 3)
    away = rng.uniform(-1.5, 1.5, 3) - at
    if on_tool:
        values, turns = np.einsum("nab,na->nb", carried, away), np.transpose(carried, (0, 2, 1)) @ fixed
    else:
        values, turns = -away @ fixed, fixed.T @ carried
    instrument = Instrument(("camera",), camera="on_tool" if on_tool else "fixed")
    free = {"frame": "free", "tool": "free", "seat": "free"}
    return values, KINDS["camera"], {"instrument": instrument, "orientation": turns, **free}


def fixed_camera(tips: Tips, rng: np.random.Generator) -> Values:
    """A camera that stands still, the target on the tool."""
    return camera(tips, rng, on_tool=False)


def carried_camera(tips: Tips, rng: np.random.Generator) -> Values:
    """A camera on the tool, the target anywhere."""
    return camera(tips, rng, on_tool=True)


def torques(tips: Tips, rng: np.random.Generator) -> Values:
    """The tracker, and what each joint holds."""
    values, slots, held = tracker(tips, rng)
    return values, slots, {**held, "torque": np.stack([rest.load for rest in tips.rests])}


INSTRUMENTS: dict[str, Callable[[Tips, np.random.Generator], Values]] = {
    "tracker, frame free": tracker,
    "height gauge: z": heights,
    "wire, known anchor": wire,
    "ballbar, free anchor": ballbar,
    "level on the last link": level,
    "camera, target on the tool": fixed_camera,
    "camera on the tool": carried_camera,
    "tracker and torques": torques,
}


def stage_of(seed: int) -> tuple[Arm, Stage]:
    """The arm as its file has it, read again, and a session of it: two payloads, both sides."""
    rng = np.random.default_rng(seed)
    real, ranges = draw_arm(FAMILY, rng)
    session = draw_session("full", real, ranges, 1, rng)
    body = machine(real)
    return arm_of(real, ranges), Stage(body, session, played(Plan(body, session)))


def arm_of(real: DrawnArm, ranges: Ranges) -> Arm:
    """An arm of the generator as its file has it, read again."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "arm.yaml"
        file.write_text(arm_file(real, ranges), encoding="utf-8")
        return read_arm(file)


def recorded(stage: Stage, tips: Tips, instrument: str, seed: int) -> Recording:
    """What an instrument reads of a session."""
    rng, session = np.random.default_rng(seed), stage.session
    rows = np.repeat(np.arange(session.visits), session.repeats)
    values, slots, held = INSTRUMENTS[instrument](tips, rng)
    read = values[rows] + NOISE * rng.standard_normal((len(rows), values.shape[1]))
    if slots == KINDS["camera"]:
        read[:, 2] += np.sqrt(DEEP**2 - NOISE**2) * rng.standard_normal(len(rows))
        shaken = Rotation.from_rotvec(TURNS * rng.standard_normal((len(rows), 3))).as_matrix()
        held["orientation"] = shaken @ np.asarray(held["orientation"])[rows]
    if "torque" in held:
        load = -np.asarray(held["torque"])[:, list(stage.machine.drive)]
        held["torque"] = (load + TORQUES * np.std(load, axis=0) * rng.standard_normal(load.shape))[rows]
    return Recording(
        instrument,
        session.q.T[rows],
        read,
        np.arange(1, len(rows) + 1),
        time=session.time[rows] + 4.0 * np.tile(np.arange(session.repeats), session.visits),
        sides=session.side.T[rows],
        payload_mass=session.payload[rows],
        slots=np.tile(slots, (len(rows), 1)) if slots else None,
        **held,  # type: ignore[arg-type]
    )


def outcome(found: Diagnosis, cause: Cause) -> str:
    """`named`, `listed` or `-`, and ` +` with what is named beside it."""
    right = (cause.effect, cause.at)
    named = [(each.effect, each.at) == right for each in found.findings]
    listed = [any((other.effect, other.at) == right for other in each.alternatives) for each in found.findings]
    wrong = sum(not (one or other) for one, other in zip(named, listed, strict=True))
    return ("named" if any(named) else "listed" if any(listed) else "-") + (f" +{wrong} wrong" if wrong else "")


def least(found: Sequence[tuple[float, str]]) -> str:
    """The least size from which a cause is named with nothing beside it, whatever the sizes beyond, and the least from
    which it is named or listed so where that is less."""

    def since(good: Callable[[str], bool]) -> float | None:
        last = next((place for place, (_, how) in reversed(list(enumerate(found))) if not good(how)), -1)
        return found[last + 1][0] if last + 1 < len(found) else None

    named, listed = since(lambda how: how == "named"), since(lambda how: how in ("named", "listed"))
    told = "-" if named is None else f"{named:g}"
    return told if listed is None or listed == named else f"{told} (listed at {listed:g})"


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a table: each cause and size by each instrument."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--causes", nargs="+", choices=CAUSES, default=CAUSES)
    parser.add_argument("--instruments", nargs="+", choices=INSTRUMENTS, default=list(INSTRUMENTS))
    parser.add_argument("--sizes", type=float, nargs="+", default=[1.0, 2.0, 4.0, 8.0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--page", type=Path, help="the page whose table is written anew, of all causes")
    asked = parser.parse_args(arguments)
    if asked.page is not None and (len(asked.causes), len(asked.instruments)) != (len(CAUSES), len(INSTRUMENTS)):
        parser.error("--page: the page has all causes and instruments, of one run")
    arm, stage = stage_of(asked.seed)
    print(f"| cause | times the noise | {' | '.join(asked.instruments)} |")
    print(f"|---|---|{'---|' * len(asked.instruments)}", flush=True)
    rows: list[Sequence[str]] = []
    for number, effect in enumerate(CAUSES):
        if effect not in asked.causes or not possible(effect, stage):
            continue
        drawn = draw_cause(effect, stage, np.random.default_rng((asked.seed, number)))
        found: list[tuple[float, list[str]]] = []
        for size in asked.sizes:
            came = dosed(drawn, stage, size * NOISE * np.sqrt(3.0), frame_free=True, tool_free=False)
            if came is None:
                continue
            plan = Plan(stage.machine, stage.session)
            came[0].write(plan)
            tips = played(plan)
            each = [outcome(diagnose(arm, recorded(stage, tips, one, number)), came[0]) for one in asked.instruments]
            found.append((size, each))
            print(f"| {effect} {list(came[0].at) or ''} | {size:g} | {' | '.join(each)} |", flush=True)
        by_instrument = [least([(size, each[k]) for size, each in found]) for k in range(len(asked.instruments))]
        rows.append((titled(drawn), *by_instrument))
    if asked.page is not None:
        write_table(asked.page, ("cause", *asked.instruments), rows)


def titled(cause: Cause) -> str:
    """A cause and where it is, in words."""
    title = EFFECTS[cause.effect].title
    return f"{title} ({EFFECTS[cause.effect].place} {', '.join(map(str, cause.at))})" if cause.at else title


if __name__ == "__main__":
    main()
