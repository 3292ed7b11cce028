"""Design: what an arm can do, the best design within limits, and the error to expect before anything is built."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal

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
    pose_or_file,
)

if TYPE_CHECKING:
    from linkwright.core.executors import Executor
    from linkwright.core.optimize.result import Iteration
    from linkwright.face.design import Optimization
    from linkwright.face.evaluation import Evaluation
    from linkwright.face.inverse import Inverse
    from linkwright.face.planning.budget import Budget
    from linkwright.face.tradeoff import Tradeoff


def evaluate(
    arm: ArmFile,
    problem: ProblemOption = None,
    *,
    pose: Annotated[
        "Sequence[Quantity] | Sequence[Sequence[Quantity]] | File | None",
        Option(metavar="Q", kind=str, read=pose_or_file),
    ] = None,
    motion: Annotated[File | None, file_option("FILE")] = None,
) -> "Evaluation":
    """The worst position error over the workspace, where it is, what each effect adds, and the arm's figures.

    Example: linkwright evaluate arm.yaml --pose "20 deg, -30 deg, 10 deg" --json result.json
    Example: linkwright evaluate arm.yaml --pose poses.csv
    Example: linkwright evaluate arm.yaml --motion motion.csv

    Args:
        arm: The arm file. In Python also an `Arm`.
        problem: Take workspace, loads and what is uncertain from this problem file. With `maximize: payload` the arm
            carries the largest payload that keeps the limits. In Python also a `Problem`; without
            one they are the joint ranges and the arm's own payload.
        pose: Print the tip's error there: its vector, length and rotation, and each effect's share; with one pose also
            mm/N. In quotes, with units or in degrees (mm for slides), or a CSV of poses (q1_deg, q2_deg ...). In Python
            also quantities (n,) or (N, n): text, or rad and m; mm/N is that of the worst pose by default.
        motion: A motion (CSV: t_s, q1_rad, q2_rad ..., of slides q3_m): what it asks of the drives is told too.

    Raises `InputError`, `MissingProperty` where the arm lacks a figure, `NoAnswer` where the workspace cannot be
    reached.

    >>> import linkwright as lw
    >>> found = lw.evaluate(lw.read_arm("examples/welding-arm/arm.yaml"))
    >>> round(found.max_error_mm, 4)
    0.1939
    >>> list(found.by_effect.columns)
    ['effect', 'title', 'error_mm']
    """
    from linkwright.core.arm.errors.at_pose import errors_at
    from linkwright.core.arm.evaluation import evaluate as evaluated
    from linkwright.core.arm.figures import FIGURES, PAYLOAD
    from linkwright.core.optimize.payload import largest_payload_of, with_payload
    from linkwright.core.optimize.robust.search import robust_figure
    from linkwright.face.arm import arm_of
    from linkwright.face.evaluation import Evaluation, along, poses_of
    from linkwright.face.problem import cases_at, for_joints_of, problem_of

    given = arm_of(arm, tips="every")
    poses = None if pose is None else poses_of(given.model, pose)
    one = None if poses is None or len(poses) != 1 else poses[0]
    asked = None if problem is None else problem_of(problem).model
    if asked is None:
        evaluation = evaluated(given.model, pose=one)
    else:
        for_joints_of(given, asked)
        cases = cases_at(asked, given)
        if asked.minimize == PAYLOAD.name:
            cases = with_payload(cases, largest_payload_of(asked, given.model) or 0.0)
        evaluation = evaluated(given.model, asked.workspace, cases, pose=one)
    moving = evaluation.in_motion if motion is None else along(given.model, motion)
    robust = None if asked is None or asked.uncertain is None else robust_figure(given.model, asked)
    at = () if poses is None else errors_at(given.model, evaluation.load_cases, poses)
    known = FIGURES if asked is None else asked.figures
    return Evaluation(given, evaluation, robust, moving, at, known)


def optimize(
    problem: ProblemFile,
    *,
    round_to: Annotated[str | None, Option("--round", "SIZES")] = None,
    round_length: Annotated["Quantity | None", Option(metavar="STEP", kind=str)] = None,
    progress: Progress | None = None,
    log: "Callable[[Iteration], None] | None" = None,
    out_of_reach: Callable[[str], None] | None = None,
    begun: "Callable[[Evaluation], None] | None" = None,
    workers: int | None = None,
    executor: "Executor | None" = None,
) -> "Optimization":
    """The best design within a problem's limits: what changes, how sure it is, what binds and what that costs.

    Example: linkwright optimize problem.yaml --out result
    Example: linkwright optimize problem.yaml --round stock --out result

    Args:
        problem: The problem file. In Python also a `Problem`.
        round_to: Also the best design of stock sizes ('stock') or of a grid ('0.5 mm'). In Python: where no such design
            keeps the limits, `found.not_rounded` says why and which comes nearest.
        round_length: With --round: the grid of link lengths, 1 mm by default.
        progress: Hears of combinations tried; a bar by default, where somebody looks.
        log: Hears of every round.
        out_of_reach: Hears at once of a limit that no design can keep.
        begun: Hears of the arm as given, before the first round.
        workers: Processes of this machine for what takes long; one for each core by default.
        executor: Who does it instead: `lw.Processes`, `lw.Cluster`.

    Ctrl-C ends it with the best design so far, marked `interrupted`. Raises `InputError`, `MissingProperty`, and
    `NoAnswer`, whose `infeasible` says what each limit would have to be.

    >>> import linkwright as lw
    >>> problem = lw.Problem(
    ...     arm="examples/welding-arm/arm.yaml",
    ...     workspace={"path": [["600 mm", "300 mm"], ["700 mm", "300 mm"]]},
    ...     subject_to={"mass": "<= 30 kg", "section_size": ["20 mm", "150 mm"]},
    ...     choose={"section": ["circle"], "same": ["size"]},
    ... )
    >>> best = lw.optimize(problem)
    >>> best.found.after.max_error < best.found.before.max_error, best.interrupted
    (True, False)
    >>> list(best.links.columns)
    ['link', 'length_mm', 'section', 'material', 'mass_kg']
    """
    from linkwright.face.design import optimized, rounding_of
    from linkwright.face.problem import problem_of
    from linkwright.face.progress import at_work

    rounding = rounding_of(round_to, round_length)
    asked = problem_of(problem)
    with at_work(executor, workers) as crew:
        return optimized(asked, rounding, progress, log, out_of_reach, begun, crew)


def tradeoff(
    problem: ProblemFile,
    *,
    x: Annotated[str, Option(metavar="FIGURE")] = "mass",
    y: Annotated[str, Option(metavar="FIGURE")] = "max_error",
    by: Annotated[Literal["material", "shape"] | None, Option()] = None,
    reach: Annotated[Literal["long", "short"], Option()] = "long",
    accuracy: Annotated[float, Option(least=1e-4, most=0.5)] = 0.01,
    progress: Progress | None = None,
) -> "Tradeoff":
    """The trade-off between two figures: no design of the front can be beaten in both.

    Any two figures: max_error, average_error, mass, total_mass, cost, reach, safety_factor, first_frequency,
    wall_slenderness, aspect, section_height, section_width, tip_stiffness, sideways_stiffness, orientation_error,
    repeatability, peak_torque, rms_torque. Where the problem names a direction, error_along and
    tip_stiffness_along too.

    Example: linkwright tradeoff problem.yaml --x mass --y max_error --by material --out front

    Args:
        problem: The problem file. In Python also a `Problem`.
        x: The figure to the right.
        y: The figure upwards.
        by: A front for each material, or shape, that all links then share.
        reach: Which reach is the better one.
        accuracy: Relative error that straight lines between points may have.
        progress: Hears of each point; the share is that of the first points, then an estimate.

    Ctrl-C ends it with the points so far, marked `interrupted`. Raises `InputError`, and `NoAnswer` where no design
    keeps the limits.

    >>> import linkwright as lw
    >>> problem = lw.Problem(
    ...     arm="examples/welding-arm/arm.yaml",
    ...     workspace={"path": [["600 mm", "300 mm"], ["700 mm", "300 mm"]]},
    ...     subject_to={"mass": "<= 15 kg", "max_error": "<= 0.3 mm", "section_size": ["40 mm", "120 mm"]},
    ...     choose={"section": ["circle"], "same": ["size"]},
    ... )
    >>> front = lw.tradeoff(problem, x="mass", y="max_error", accuracy=0.2)
    >>> heavier = front.table["mass_kg"].is_monotonic_increasing
    >>> bool(heavier), front.designs[0].arm
    (True, <Arm: cathode-bus welding arm, 3 joints, reach 1240 mm>)
    """
    from linkwright.core.optimize.tradeoff.question import question
    from linkwright.face.problem import problem_of
    from linkwright.face.tradeoff import traced

    given = problem_of(problem)
    return traced(given, question(given.model, x, y, by=by, reach=reach), accuracy, progress)


def inverse(
    arm: ArmFile,
    x: Annotated["Quantity", Argument(metavar="X", kind=str)],
    y: Annotated["Quantity", Argument(metavar="Y", kind=str)],
    z: Annotated["Quantity | None", Argument(metavar="[Z]", kind=str)] = None,
    *,
    inclination: Annotated["Quantity | None", Option(metavar="ANGLE", kind=str)] = None,
    most: Annotated[int, Option(least=1, most=1000)] = 16,
) -> "Inverse":
    """The joint coordinates within the joint ranges that put the tip at a point, every branch.

    Example: linkwright inverse arm.yaml "800 mm" "-200 mm" --inclination "30 deg"

    Args:
        arm: The arm file. In Python also an `Arm`.
        x: A length with its unit, in the base frame: '800 mm'.
        y: Another.
        z: Another; 0 without it.
        inclination: The last link's angle from the x axis; planar arms.
        most: Poses to show at most. In Python: an arm with more joints than is asked for has a continuum of poses, of
            which samples are given.

    Of several arms on one torso it is the tip that the arm was read for (`read_arm(..., tip=)`); the joints of the
    others stand in the middle of their ranges. Raises `InputError`, and `NoAnswer` with what is missing where none
    reaches it.

    >>> import linkwright as lw
    >>> arm = lw.Arm(
    ...     chain=[
    ...         (lw.Joint(), lw.Link(length="400 mm", rigid=True, mass="1 kg")),
    ...         (lw.Joint(), lw.Link(length="300 mm", rigid=True, mass="1 kg")),
    ...     ]
    ... )
    >>> lw.inverse(arm, "400 mm", "300 mm")
    <Inverse: 2 poses at (400, 300) mm>
    """
    from linkwright.core.arm.worst.inverse import inverse as inverse_poses
    from linkwright.face.arm import arm_of
    from linkwright.face.inverse import Inverse, inclined
    from linkwright.face.plain_input import in_si

    named = (("x", x), ("y", y)) if z is None else (("x", x), ("y", y), ("z", z))
    point = tuple(in_si(value, "length", name) for name, value in named)
    given = arm_of(arm, tips="one")
    turned = None if inclination is None else inclined(given, inclination)
    return Inverse(given, point, inverse_poses(given.model, point, turned, most=most))


def budget(
    arm: ArmFile,
    *,
    sheet: Annotated["File | Mapping[str, Any] | None", file_option("FILE")] = None,
    problem: ProblemOption = None,
    progress: Progress | None = None,
) -> "Budget":
    """The error to expect, by cause, from data sheets and tolerances; and which part to buy better first.

    Example: linkwright budget arm.yaml --sheet sheet.yaml --out budget

    Args:
        arm: The arm file. In Python also an `Arm`.
        sheet: Tolerances, repeatability, temperature, better parts, prices. In Python also its keys as a mapping
            (docs/how-to/workshop.md).
        problem: Take workspace and loads from this problem file. In Python also a `Problem`.
        progress: Hears of the steps; a bar by default, where somebody looks.

    Of several arms on one torso the worst of all tips counts, or that which the arm was read for (`read_arm(...,
    tip=)`). Seeded, so the same again. Raises `InputError`, `MissingProperty`, `NoAnswer`.

    >>> import linkwright as lw
    >>> arm = lw.read_arm("examples/welding-arm/arm.yaml")
    >>> found = lw.budget(arm, sheet={"tolerances": [{"effect": "link_length", "length": "0.3 mm"}]})
    >>> list(found.causes.columns)
    ['cause', 'at_worst_mm', 'average_mm', 'share']
    """
    from linkwright.core.arm.avoid.poses import NoRoom
    from linkwright.core.optimize.budget.result import budget as budgeted
    from linkwright.core.units.quantities import InputError
    from linkwright.face.arm import arm_of
    from linkwright.face.planning.budget import Budget, sheet_of
    from linkwright.face.problem import cases_at, problem_of
    from linkwright.face.progress import reporting

    given = arm_of(arm, tips="every")
    asked = sheet_of(given, sheet)
    space, loads, avoid = None, (), ()
    if problem is not None:
        stated = problem_of(problem).model
        if stated.arm.size != given.model.size:
            message = f"is for {stated.arm.size} joints; {given.name} has {given.model.size}"
            raise InputError(stated.file, "arm", message)
        space, loads, avoid = stated.workspace, cases_at(stated, given), stated.avoid
    with reporting(progress) as hear:
        try:
            return Budget(given, budgeted(given.model, asked, space, loads, avoid=avoid, progress=hear))
        except NoRoom as error:
            raise InputError("", "avoid", str(error)) from None
