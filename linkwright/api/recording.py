"""Recordings: which are worth making, and those that a model would give."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from linkwright.api.signature import (
    Argument,
    ArmFile,
    File,
    Listed,
    Numbered,
    Option,
    Progress,
    Quantity,
    file_option,
    named,
    numbers,
    region,
    span,
)

if TYPE_CHECKING:
    from linkwright.face.arm import Arm
    from linkwright.face.diagnosis import Diagnosis
    from linkwright.face.motion.diagnosis import MotionDiagnosis
    from linkwright.face.motion.log import Log
    from linkwright.face.motion.plan import MotionPlan
    from linkwright.face.motion.simulation import MotionSimulation
    from linkwright.face.planning.plan import Plan
    from linkwright.face.recording import Columns, Recording, Simulation

Direction = Annotated[Sequence[float] | None, Option(metavar="LIST", kind=str, read=numbers)]
Lengths = Listed[Sequence[Quantity] | None]
TiltLink = Annotated[str | int | None, Option(metavar="LINK", kind=str)]
Camera = Annotated[Literal["fixed", "on_tool"] | None, Option(metavar="WHERE", kind=str)]
InstrumentSettings = Annotated[
    Mapping[str, Any] | Sequence[str], Option("--reads", metavar="KEY=VALUE", kind=str, many=True)
]
Torques = Listed[Quantity | Sequence[Quantity] | None]
Nuisance = Annotated[Literal["known", "free"], Option(kind=str)]
MOTION = "motion"
"""The instrument of motion logs: what drives give while the arm moves."""
Region = Mapping[str, Any] | tuple[Sequence[Quantity], Sequence[Quantity]]


def columns(
    file: Annotated[File, Argument(metavar="FILE", kind=Path)],
    arm: Annotated["Arm | File | None", Option(metavar="ARM", reads="arm", kind=Path)] = None,
    check: Annotated[bool, Option()] = False,
) -> "Columns":
    """What the columns of another program's file may mean, and the recording.yaml that says so.

    Recordings of a tip and motion logs alike: .csv, .xlsx, .parquet (LeRobot's too), MCAP, ROS bags. The file is read
    with the proposal, and what is wrong with it is told.

    Example: linkwright columns log.csv --arm arm.yaml --out recording.yaml
    Example: linkwright columns log.csv --arm arm.yaml --check

    Args:
        file: The file.
        arm: The arm file: its joints' names, ranges and kinds tell what columns are of, and in which unit. In Python
            also an `Arm`.
        check: Say all that is doubtful of the recording, a line each, without a diagnosis; needs the arm.

    Raises `InputError` where the file is no table.

    >>> import linkwright as lw
    >>> found = lw.columns("examples/motion-log/log.csv", "examples/motion-log/robot.urdf")
    >>> found
    <Columns: log.csv: a motion log, 2500 samples in 24.99 s; 9 of 9 columns tell of an arm>
    >>> print(found.settings.splitlines()[1])
    observes: motion
    """
    from linkwright.core.diagnose.columns.proposed_file import propose
    from linkwright.core.units.quantities import InputError
    from linkwright.face.arm import arm_of
    from linkwright.face.recording import Columns

    given = None if arm is None else arm_of(arm, tips="first", unknown_origins=True).model
    if check and given is None:
        raise InputError("", "--check", "needs the arm that was recorded; give --arm ARM")
    return Columns(propose(Path(file), given, check=check))


def plan(
    arm: ArmFile,
    *,
    poses: Annotated[int | None, Option(metavar="N")] = None,
    for_: Annotated[Sequence[str], Option("--for", "EFFECTS", kind=str, read=named)] = (),
    instrument: Annotated[str, Option()] = "tracker",
    sigma: Annotated[Quantity | None, Option(metavar="LENGTH", kind=str)] = None,
    repeats: Numbered[int] = 3,
    payloads: Annotated[Sequence[Quantity] | None, Option("--payload", "MASS", kind=str, many=True)] = None,
    frame: Nuisance = "known",
    tool: Nuisance = "known",
    avoid: Annotated[Sequence[Region], Option(metavar="REGION", kind=str, many=True, read=region)] = (),
    after: Annotated[
        "Recording | Diagnosis | Log | MotionDiagnosis | File | Sequence[Recording | Log | File] | None",
        file_option("RECORDING", many=True),
    ] = None,
    direction: Direction = None,
    anchor: Lengths = None,
    anchor_free: Annotated[bool, Option()] = False,
    tilt_link: TiltLink = None,
    camera: Camera = None,
    bar: Lengths = None,
    reads: InstrumentSettings = (),
    bars: Numbered[int | None] = None,
    sigma_depth: Annotated[Quantity | None, Option(metavar="LENGTH", kind=str)] = None,
    sigma_angle: Annotated[Quantity | None, Option(metavar="ANGLE", kind=str)] = None,
    torques: Torques = None,
    at: Annotated[File | None, file_option("LOG")] = None,
    seconds: Annotated[float, Option(metavar="S", least=4.0, most=600.0)] = 20.0,
    seed: Annotated[int, Option(least=0)] = 1,
    progress: Progress | None = None,
) -> "Plan | MotionPlan":
    """Which poses, payloads and sides are worth recording, in which order, and what they will show.

    For a motion log it is a motion that tells causes apart.

    Example: linkwright plan arm.yaml --poses 30 --for joint_compliance,backlash --out plan.csv
    Example: linkwright plan arm.yaml --instrument motion --for friction_load,friction_place --out plan.csv

    Args:
        arm: The arm file. In Python also an `Arm`.
        poses: How many visits: a pose, a payload, sides. In Python 30 by default.
        for_: What to see: 'backlash, joint_compliance:2'; else everything. In Python a list.
        instrument: motion, or tracker, x, y, z, xy, xz, yz, along, distance, tilt, camera, same_point, plane, bar,
            laser_line, draw_wire, or one that a package brings. In Python: places, some of their coordinates, the
            height `along` a `direction`, the `distance` from an `anchor`, the `tilt` of a level on a `tilt_link`, where
            a `camera` sees a target; or a `same_point` (a ball in a socket), a `plane`, places along a `bar`, that are
            touched again in several postures; nobody need know just where.
        sigma: What each component scatters by; 15 um (a tilt: 15 urad). In Python also m, or rad; after a recording
            what that scatters by.
        repeats: Readings in a row at each visit.
        payloads: May be repeated; else without and with the arm's own. In Python a list.
        frame: Where the instrument stands: known, or free.
        tool: Where the target sits on the tool: known, or free.
        avoid: '0.5 m, -1 m, 0 m to 2 m, 1 m, 0.4 m', 'below z 0 mm' or 'above z 2 m'; may be repeated. In Python as an
            arm file has them (`{"below": {"z": "0 mm"}}`), or boxes by two corners, in the base frame; where nobody
            says any, a plan `after` a recording stays in the box in which that has the joints and the tip.
        after: Go on from it (may be repeated): what it could not tell is asked. In Python also a `Recording`, several,
            or their `Diagnosis`; frame and tool are free where they were.
        direction: Of a height, for along: '0, 0, 1'. In Python three numbers.
        anchor: Of distances: '1 m, 0 m, 0.3 m'. In Python three lengths.
        anchor_free: The anchor is about there: the recording has to tell where.
        tilt_link: Where a level stands, for tilt: base, or 2.
        camera: Of a camera: fixed, or on_tool.
        bar: Places along a bar that are touched: '0 mm, 500 mm'. In Python a list of lengths.
        reads: A setting of another instrument, 'beam=1, 0, 0'; may be repeated. In Python a mapping.
        bars: In how many places the bar lies; 1: it is fixed. In Python: one for every six visits by default.
        sigma_depth: Of a camera's depths; five times sigma.
        sigma_angle: Of a camera's turns; sigma over 0.1 m.
        torques: Drives' torques too, which scatter by so much: '0.5 N*m'. In Python one for all joints that turn, or
            one for each joint; what they will tell of weights and friction is planned for beside the causes.
        at: For the instrument motion: how far this log tells each name, before a diagnosis; no motion is chosen.
        seconds: How long a motion lasts, for the instrument motion.
        seed: The same seed gives the same plan.
        progress: Hears of the steps; a bar by default, where somebody looks.

    Ctrl-C, once there are as many visits as asked for, ends the choice with the best so far, marked `interrupted`. Of
    several arms on one torso it is for the tip that the arm was read for (`read_arm(..., tip=)`), with poses of the
    others chosen too. Raises `InputError`, `MissingProperty`, and `NoAnswer` where nothing of what is asked for can be
    seen.

    >>> import linkwright as lw
    >>> found = lw.plan("examples/welding-arm/arm.yaml", poses=10, for_=["backlash:2"], repeats=2)
    >>> len(found.visits), list(found.shown["effect"])
    (10, ['backlash'])
    """
    from linkwright.core.units.quantities import InputError
    from linkwright.face.arm import arm_of
    from linkwright.face.planning.plan import Plan
    from linkwright.face.planning.request import Reads, Request, planned_for
    from linkwright.face.recording import settings_of, torque_noise

    given = arm_of(arm, tips="one")
    if instrument == MOTION:
        from linkwright.face.motion.plan import planned_motion

        return planned_motion(given, for_, avoid, after, at, seconds, seed, progress)
    if at is not None:
        raise InputError("", "--at", "is for motion logs; add --instrument motion")
    asked_reads = Reads(instrument, direction, anchor, anchor_free, tilt_link, camera, bar, settings_of(reads))
    noise = torque_noise(torques, given)
    request = Request(
        30 if poses is None else poses,
        for_,
        asked_reads,
        sigma,
        sigma_depth,
        sigma_angle,
        repeats,
        payloads,
        frame,
        tool,
        avoid,
        bars,
        noise,
        seed,
    )
    return Plan(given, planned_for(given, request, after, progress))


def simulate(
    arm: ArmFile,
    *,
    poses: Annotated[int | None, Option(metavar="N", least=1, most=1_000_000)] = None,
    with_: Annotated[Sequence[Mapping[str, Any] | str], Option("--with", "EFFECT", kind=str, many=True)] = (),
    noise: Annotated[Quantity, Option(kind=str)] = "15 um",
    repeats: Annotated[int, Option(least=1, most=1000)] = 3,
    payloads: Listed[Sequence[Quantity]] = (),
    sides: Annotated[Literal["both", "one", "random"], Option(kind=str)] = "both",
    temperature: Annotated[tuple[Quantity, Quantity] | None, Option(metavar="RANGE", kind=str, read=span)] = None,
    hours: Annotated[float | None, Option(least=0.001, most=10_000.0)] = None,
    seed: Annotated[int, Option(least=0)] = 1,
    frame_free: Annotated[bool, Option()] = False,
    outliers: Annotated[float, Option(least=0.0, most=0.5)] = 0.0,
    joint_side: Annotated[bool, Option()] = False,
    commands: Annotated[bool, Option()] = False,
    base_target: Annotated[bool, Option()] = False,
    orientation: Annotated[bool, Option()] = False,
    declare_sigma: Annotated[bool, Option()] = False,
    observe: Annotated[str, Option()] = "position",
    direction: Direction = None,
    anchor: Lengths = None,
    anchor_free: Annotated[bool, Option()] = False,
    tilt_link: TiltLink = None,
    bar: Lengths = None,
    camera: Camera = None,
    reads: InstrumentSettings = (),
    torques: Torques = None,
    at: Annotated[File | None, file_option("PLAN")] = None,
    motion: Annotated[File | None, Option(metavar="MOTION", kind=str)] = None,
) -> "Simulation | MotionSimulation":
    """A recording from a model, for trying things out: poses over the joint ranges, from both sides, with noise.

    Example: linkwright simulate arm.yaml --poses 40 --out recording.csv --with '{effect: joint_compliance, at: 2,
    compliance: 21 urad/(N*m)}'
    Example: linkwright simulate arm.yaml --motion plan.csv --out log.csv --with '{effect: friction_coulomb, at: 2,
    torque: 9 N*m}'

    Args:
        arm: The arm file. In Python also an `Arm`.
        poses: How many poses; 40 by default.
        with_: An entry of the arm file's `effects`; may be repeated. In Python a list of mappings, or of text as a file
            has it.
        noise: Standard deviation of each component.
        repeats: Readings in a row at a pose.
        payloads: Masses, each with every pose: '0 kg, 5 kg'. In Python a list.
        sides: Joints arrive from: both, one, random.
        temperature: It wanders: '20 degC to 35 degC'. In Python a pair: text, or K.
        hours: How long it takes.
        seed: The same seed gives the same recording.
        frame_free: The instrument stands anywhere; `frame: free` in the settings.
        outliers: Share of readings that are wrong by far.
        joint_side: Encoders on the joints' own side too.
        commands: Commanded coordinates too.
        base_target: A target on the base too.
        orientation: How the tool is turned too.
        declare_sigma: Write the noise into the settings beside the recording.
        observe: position, some of x, y, z (xy), along, distance, same_point, plane, tilt, bar, camera, laser_line,
            draw_wire, or one that a package brings.
        direction: Of a height, for along: '0, 0, 1'. In Python three numbers.
        anchor: Of distances: '1 m, 0 m, 0.3 m'. In Python three lengths.
        anchor_free: The settings do not tell where the anchor is.
        tilt_link: Where a level stands, for tilt: base, or 2. In Python: its noise counts in a metre, 15 um are
            15 urad.
        bar: Places along a bar that are touched: '0 mm, 500 mm'. In Python a list of lengths.
        camera: Of a camera: fixed, or on_tool. In Python: depths are five times noisier, turns by the noise over 0.1 m.
        reads: A setting of another instrument, 'beam=1, 0, 0'; may be repeated. In Python a mapping.
        torques: Drives' torques too, which scatter by so much: '0.5 N*m'. In Python one for all joints that turn, or
            one for each joint: what each holds at rest is written then, without friction.
        motion: A motion log in place of poses: the file of `plan --instrument motion`, or how long a motion drawn at
            random lasts, '20 s'; `torques` is what it scatters by, 1 % by default.
        at: Poses, sides, payloads and times of `linkwright plan`. In Python also of a recording; taken in place of
            `repeats`, `payloads`, `sides`, `temperature` and `hours` too.

    Raises `InputError`, and `MissingProperty` where the arm lacks a figure.

    >>> import linkwright as lw
    >>> lw.simulate(
    ...     "examples/welding-arm/arm.yaml",
    ...     poses=5,
    ...     with_=[{"effect": "encoder_offset", "at": 2, "offset": "0.05 deg"}],
    ... )
    <Simulation: made by a model, 30 readings, frame known, tool known>
    """
    from linkwright.core.units.quantities import InputError
    from linkwright.face.arm import arm_of
    from linkwright.face.recording import (
        instrument_of,
        masses_of,
        plan_of,
        settings_of,
        simulated_by,
        torque_noise,
        with_effects,
    )

    if poses is not None and at is not None:
        raise InputError("", "poses", "goes without `at`, whose poses are taken; drop one")
    given = with_effects(arm_of(arm, tips="one"), with_)
    if motion is not None:
        from linkwright.face.motion.simulation import simulated_motion

        if poses is not None or at is not None:
            raise InputError("", "motion", "goes without poses and `at`; a motion log has no poses")
        return simulated_motion(given, motion, torques, seed)
    of_kind = settings_of(reads)
    asked_reads = instrument_of(given, at, observe, direction, anchor, anchor_free, tilt_link, bar, camera, of_kind)
    asked = plan_of(
        given,
        asked_reads,
        poses=40 if poses is None else poses,
        noise=noise,
        repeats=repeats,
        payloads=masses_of(payloads),
        sides=sides,
        temperature=temperature,
        hours=hours,
        seed=seed,
        free_frame=frame_free,
        outliers=outliers,
        joint_side=joint_side,
        commands=commands,
        base_target=base_target,
        orientation=orientation,
        torque_noise=torque_noise(torques, given),
    )
    return simulated_by(given, asked, declare_sigma=declare_sigma)
