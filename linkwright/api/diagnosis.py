"""Diagnosis: what recordings of a real arm say that its model lacks, what changed, and what to do against it."""

from collections.abc import Collection, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from linkwright.api.signature import (
    Argument,
    ArmFile,
    File,
    Option,
    ProblemFile,
    ProblemOption,
    Progress,
    Quantity,
    file_option,
    named,
)

if TYPE_CHECKING:
    import pandas as pd

    from linkwright.face.compensation import Compensation
    from linkwright.face.design import Redesign
    from linkwright.face.diagnosis import Diagnosis
    from linkwright.face.motion.comparison import MotionComparison
    from linkwright.face.motion.diagnosis import MotionDiagnosis
    from linkwright.face.motion.log import Log
    from linkwright.face.motion.prediction import MotionPrediction
    from linkwright.face.planning.comparison import Comparison
    from linkwright.face.planning.watch import Watch
    from linkwright.face.prediction import Prediction
    from linkwright.face.recording import Recording

One = Annotated["Recording | Log | File | pd.DataFrame", Argument(metavar="RECORDING", kind=Path)]
Without = Annotated[Collection[str], Option("--without-effect", "ID", kind=str, many=True)]
Settings = Annotated[File | None, file_option("FILE", "--recording-yaml")]
SettingsOfEach = Annotated[File | Sequence[File] | None, file_option("FILE", "--recording-yaml", many=True)]
Nuisance = Literal["known", "free"]


def diagnose(
    arm: ArmFile,
    recording: Annotated[
        "Recording | Log | File | pd.DataFrame | Sequence[Recording | Log | File | pd.DataFrame]",
        Argument(metavar="RECORDING", kind=Path, many=True),
    ],
    *,
    thorough: Annotated[bool, Option()] = False,
    without: Without = (),
    settings: SettingsOfEach = None,
    units: Annotated[bool, Option()] = False,
    problem: ProblemOption = None,
    rollout: Annotated[bool, Option()] = False,
    progress: Progress | None = None,
) -> "Diagnosis | MotionDiagnosis":
    """What the model of an arm lacks, by recordings of the real one: where, what, how sure, and what to do.

    A motion log (a clock, joint coordinates, torques, currents or voltages) says what the drives' torques lack.

    Example: linkwright diagnose arm.yaml recording.csv --out result
    Example: linkwright diagnose robot.urdf log.csv --out result

    Several at once share the physics: linkwright diagnose arm.yaml may.csv august.csv

    Args:
        arm: The arm file, a URDF or an MJCF. In Python also an `Arm`.
        recording: The recording (.csv, .xlsx, .parquet) or motion log (also .mcap, a ROS 2 bag), or several. In Python
            also a `Recording`, a `Log` or a data frame, or a list: frame, tool and noise are each one's own,
            `found.recordings` tells what comes of each, and `differences` what is not the same in all (a zero that
            moved, a drive that softened). Of motion logs a `MotionDiagnosis` comes.
        thorough: Make every test with six times as many draws; takes longer.
        without: Leave this effect out of the candidates; may be repeated.
        settings: What the columns mean; by default the file beside the recording. Of several recordings: once for all,
            or once for each, in their order.
        units: The recordings are of several arms of one type: anything may differ.
        problem: Solve this design problem with what was found, too. In Python also a `Problem`.
        rollout: Simulate motion logs under their torques with MuJoCo, by the arm as given and as corrected.
        progress: Hears of the steps; a bar by default, where somebody looks.

    Raises `InputError`, and `MissingProperty` where the model lacks a figure.

    >>> import linkwright as lw
    >>> dia = lw.diagnose("examples/hidden-backlash/arm.yaml", "examples/hidden-backlash/recording.csv")
    >>> dia.verdict
    'named'
    >>> dia
    <Diagnosis: backlash at joint 2, 97 % of 0.122 mm explained>
    """
    from dataclasses import replace

    from linkwright.core.diagnose.options import Options
    from linkwright.core.units.quantities import InputError
    from linkwright.face.arm import arm_of, catalogue_of
    from linkwright.face.motion.log import logs_of, of_tips_alone
    from linkwright.face.plain_input import known_effects
    from linkwright.face.progress import reporting

    options = Options(thorough=thorough, without=known_effects(without), rollout=rollout)
    given = arm_of(arm, tips="first", unknown_origins=True)
    if logs := logs_of(recording, given, settings):
        from linkwright.core.diagnose.motion.rollout.simulator import installed
        from linkwright.face.motion.diagnosis import diagnosed_motion

        of_tips_alone(units=units, problem=problem is not None)
        if rollout:
            installed()
        with reporting(progress) as tell:
            return diagnosed_motion(given, logs, options, tell)
    if rollout:
        raise InputError("", "rollout", "goes with motion logs; a recording of the tip has no torques over time")
    from linkwright.core.diagnose.steps.diagnosis import diagnose as diagnosed
    from linkwright.face.diagnosis import Diagnosis, recordings_of
    from linkwright.face.problem import problem_of
    from linkwright.output.diagnosis_folder import with_written

    read = recordings_of(recording, given, settings, units=units)
    asked = None if problem is None else problem_of(problem)
    with reporting(progress) as tell:
        diagnosis = diagnosed(given.model, read.found, options, tell)
        answer = Diagnosis(given, read, with_written(diagnosis, catalogue_of(given.catalogue)))
        return answer if asked is None else replace(answer, redesign=redesign(asked, answer, progress=tell))


def compare(
    arm: ArmFile,
    before: Annotated["Recording | Log | File | pd.DataFrame", Argument(metavar="A", kind=Path)],
    after: Annotated["Recording | Log | File | pd.DataFrame", Argument(metavar="B", kind=Path)],
    *,
    thorough: Annotated[bool, Option()] = False,
    without: Without = (),
    settings: Settings = None,
    progress: Progress | None = None,
) -> "Comparison | MotionComparison":
    """What changed between two recordings of one arm: parameters with intervals, noise, figures of the standards.

    Of two motion logs: the sizes of what is missing in the torques, in each.

    Example: linkwright compare arm.yaml before.csv after.csv --json changes.json

    Args:
        arm: The arm file. In Python also an `Arm`.
        before: The earlier recording or motion log. In Python also a `Recording`, a `Log` or a data frame.
        after: The later recording. In Python alike.
        thorough: Make every test with six times as many draws; takes longer.
        without: Leave this effect out of the candidates; may be repeated.
        settings: What the columns mean; by default the file beside it.
        progress: Hears of the steps; a bar by default, where somebody looks.

    Both are diagnosed, then fitted with one common model. Raises what `diagnose` raises.

    >>> import linkwright as lw
    >>> folder = "examples/hidden-backlash"
    >>> changed = lw.compare(f"{folder}/arm.yaml", f"{folder}/recording.csv", f"{folder}/after-service.csv")
    >>> list(changed.changes["effect"])
    ['backlash']
    """
    from linkwright.core.diagnose.options import Options
    from linkwright.face.arm import arm_of
    from linkwright.face.diagnosis import recording_of
    from linkwright.face.motion.log import logs_of
    from linkwright.face.plain_input import known_effects
    from linkwright.face.planning.comparison import compared
    from linkwright.face.progress import reporting

    options = Options(thorough=thorough, without=known_effects(without))
    given = arm_of(arm, tips="first")
    if logs := logs_of([before, after], given, settings):
        from linkwright.face.motion.comparison import compared_motion

        with reporting(progress) as tell:
            return compared_motion(given, logs, options, tell)
    both = [recording_of(item, given, settings) for item in (before, after)]
    with reporting(progress) as tell:
        return compared(given, both, options, tell)


def redesign(
    problem: ProblemFile, diagnosis: "Diagnosis | MotionDiagnosis", *, progress: Progress | None = None
) -> "Redesign":
    """A design problem solved again with what a diagnosis found: what the old optimum really has, what changes.

    Errors are worst cases over the problem's workspace. Raises `InputError` where the problem is for another arm,
    `NoAnswer` where what motion logs found moves no tip, and what `optimize` raises.

    >>> import linkwright as lw
    >>> bar = {"section": lw.shapes.Circle(diameter="60 mm"), "material": "steel-s355"}
    >>> drive = lw.Joint(range=["-60 deg", "60 deg"], stiffness="50 kN*m/rad")
    >>> arm = lw.Arm([(drive, lw.Link(length=0.4, **bar)), (drive, lw.Link(length=0.3, **bar))], payload={"mass": 5})
    >>> soft = {"effect": "joint_compliance", "at": 1, "compliance": "60 urad/(N*m)"}
    >>> dia = lw.diagnose(arm, lw.simulate(arm, poses=20, with_=[soft]))
    >>> seam = {"path": [["600 mm", "200 mm"]]}
    >>> problem = lw.Problem(arm, workspace=seam, subject_to={"mass": "<= 14 kg"}, choose={"same": ["size"]})
    >>> anew = lw.redesign(problem, dia)
    >>> anew.found.promised < anew.found.has <= anew.found.had
    True
    >>> list(anew.table["design"])
    ['old, promised', 'old, really', 'new']
    """
    from linkwright.face.design import Redesign
    from linkwright.face.problem import problem_of
    from linkwright.face.progress import reporting
    from linkwright.redesigning import redesign as redesigned
    from linkwright.redesigning import refuse_nothing_of_the_tip

    asked = problem_of(problem)
    refuse_nothing_of_the_tip(diagnosis.found.arm, diagnosis.found.corrected)
    with reporting(progress) as tell:
        result = redesigned(asked.model, diagnosis.found.arm, diagnosis.found.corrected, tell)
    return Redesign(asked, result)


def predict(
    arm: ArmFile,
    recording: One,
    *,
    frame: Nuisance | None = None,
    tool: Nuisance | None = None,
    settings: Settings = None,
    progress: Progress | None = None,
) -> "Prediction | MotionPrediction":
    """How far an arm's model is from a recording: nothing is fitted but frame and tool, and those only where free.

    Of a motion log it says what is left of each joint's torque; nothing is fitted.

    Example: linkwright predict result/arm.yaml other.csv --json prediction.json

    Args:
        arm: The arm file; a corrected one, say. In Python also an `Arm`.
        recording: The recording or motion log, CSV, .xlsx or parquet. In Python also a `Recording`, a `Log` or a data
            frame.
        frame: Whether to fit it (`free`) or not (`known`); by default as the recording's settings say.
        tool: The same of the tool.
        settings: What the columns mean; by default the file beside it.
        progress: Hears of the rows; a bar by default, where somebody looks.

    Raises `InputError`, and `MissingProperty` where the model lacks a figure.

    >>> import linkwright as lw
    >>> folder = "examples/hidden-backlash"
    >>> told = lw.predict(f"{folder}/arm.yaml", f"{folder}/after-service.csv")
    >>> told.rows, told.frame, 0.0 < told.rms_mm < told.nominal_rms_mm
    (192, 'known', True)
    """
    from dataclasses import replace

    from linkwright.core.diagnose.judge.predict import predict as predicted
    from linkwright.face.arm import arm_of
    from linkwright.face.diagnosis import recording_of
    from linkwright.face.motion.log import logs_of, of_tips_alone
    from linkwright.face.prediction import Prediction
    from linkwright.face.progress import reporting

    given = arm_of(arm, tips="first")
    if logs := logs_of(recording, given, settings):
        from linkwright.face.motion.prediction import predicted_motion

        of_tips_alone(frame=frame is not None, tool=tool is not None)
        return predicted_motion(given, logs[0])
    read = recording_of(recording, given, settings)
    asked = replace(read.found, frame=frame or read.found.frame, tool=tool or read.found.tool)
    with reporting(progress) as tell:
        return Prediction(given, read, predicted(given.model, asked, given.learned, tell))


def compensate(
    arm: ArmFile,
    *,
    grid: Annotated[int | None, Option(metavar="N", least=2)] = None,
    poses: Annotated["File | Sequence[Sequence[Quantity]] | None", file_option("FILE")] = None,
    payload: Annotated["Quantity | Sequence[Quantity]", Option(metavar="MASS", kind=str, many=True)] = (),
    progress: Progress | None = None,
) -> "Compensation":
    """The error over the workspace as a table: by how much the tip is off, and what to add to each joint against it.

    Example: linkwright compensate arm.yaml --grid 9 --out table.csv

    Args:
        arm: The arm file; a corrected one, say. In Python also an `Arm`.
        grid: Coordinates of each joint, over its range.
        poses: Poses of one's own: CSV with q1_deg, q2_deg ... (slides: mm). In Python also quantities (N, n): text, or
            rad and m.
        payload: Instead of the arm file's, e.g. '2 kg'; may be repeated. In Python one or several: text, or kg.
        progress: Hears of the rows; a bar by default, where somebody looks.

    Raises `InputError`, and `MissingProperty` where the arm lacks a figure.

    >>> import linkwright as lw
    >>> found = lw.compensate("examples/welding-arm/arm.yaml", grid=3)
    >>> found
    <Compensation: 27 poses, payload 0.7747 kg: largest error 0.194 mm>
    """
    from linkwright.face.arm import arm_of
    from linkwright.face.compensation import Compensation, compensated, payloads_of, poses_of

    given = arm_of(arm, tips="one")
    masses = payloads_of(given, payload)
    at = None if poses is None else poses_of(given, poses, grid)
    return Compensation(given, compensated(given, grid, at, masses, progress))


def watch(
    arm: ArmFile,
    recordings: Annotated[
        "Iterable[Recording | Log | File | pd.DataFrame]", Argument(metavar="RECORDING", kind=Path, many=True)
    ],
    *,
    for_: Annotated[Collection[str] | None, Option("--for", "EFFECTS", kind=str, read=named)] = None,
    search: Annotated[bool, Option("--no-search")] = True,
    without: Without = (),
    settings: SettingsOfEach = None,
    progress: Progress | None = None,
) -> "Watch":
    """What moved in an arm and when, by dated recordings of it: steps, drifts, and what is only noise.

    Example: linkwright watch arm.yaml week-*.csv --out watched

    Each recording.yaml has a date: 2026-05-16; all are of one arm.

    Args:
        arm: The arm file. In Python also an `Arm`.
        recordings: Three recordings or motion logs or more (.csv, .xlsx, .parquet), in any order. In Python also each a
            `Recording`, a `Log` or a data frame.
        for_: Watch these effects beside what is found: a,b,c; by default zeros, drives' compliance and backlash. In
            Python their ids.
        search: Watch what --for names alone; no diagnosis says what else there is. In Python: unless it is False, a
            diagnosis of some of the recordings together says what there is to watch.
        without: Leave this effect out of the candidates; may be repeated.
        settings: What the columns mean; by default the file beside the recording. Of several recordings: once for all,
            or once for each, in their order.
        progress: Hears of the steps; a bar by default, where somebody looks.

    Each recording is fitted by itself, frame and tool its own where they are free. Alarms are false once in a hundred
    series of 50 quiet recordings. Raises `InputError` and `MissingProperty`.

    >>> import linkwright as lw
    >>> arm = lw.read_arm("examples/hidden-backlash/arm.yaml")
    >>> rec = lw.read_recording("examples/hidden-backlash/recording.csv", arm)
    >>> try:
    ...     lw.watch(arm, [rec, rec, rec])
    ... except lw.InputError as error:
    ...     print(error.key, error.message)
    date is missing; a watch needs to know when it was made, e.g. `date: 2026-05-16`
    """
    from linkwright.core.diagnose.options import Options
    from linkwright.core.diagnose.watch.watch import basics
    from linkwright.core.diagnose.watch.watch import watch as watched
    from linkwright.core.units.quantities import InputError
    from linkwright.face.arm import arm_of
    from linkwright.face.motion.log import logs_of, of_tips_alone
    from linkwright.face.plain_input import known_effects
    from linkwright.face.planning.watch import Watch, read_dated, read_dated_logs
    from linkwright.face.progress import reporting

    asked = basics() if for_ is None else tuple(for_)
    known_effects(asked, "for_")
    options = Options(without=known_effects(without))
    if isinstance(recordings, str | Path) or hasattr(recordings, "columns"):
        raise InputError("", "recordings", "is a list of recordings here; name three or more")
    given = arm_of(arm, tips="first")
    several = list(recordings)
    if logs := logs_of(several, given, settings):
        from linkwright.core.diagnose.watch.motion import watch_motion

        of_tips_alone(for_=for_ is not None, search=not search)
        read_dated_logs(logs)
        with reporting(progress) as tell:
            return Watch(given, watch_motion(given.model, [log.found for log in logs], options, tell), logs)
    read = read_dated(several, given, settings)
    with reporting(progress) as tell:
        held = [item.found for item in read]
        result = watched(given.model, held, asked, options, tell, search=search)
    return Watch(given, result, tuple(read))
