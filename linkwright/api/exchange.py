"""Arms from and for other programs."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from linkwright.api.signature import Argument, ArmFile, File, Option, Progress, file_option

if TYPE_CHECKING:
    from linkwright.face.exchange import Export, Import


def import_arm(
    file: Annotated[File, Argument(metavar="FILE", kind=Path)],
    *,
    tip: Annotated[str | Sequence[str] | None, Option(metavar="LINK", kind=str, many=True)] = None,
    base: Annotated[str | None, Option(metavar="LINK")] = None,
) -> "Import":
    """An arm file from a URDF or MJCF: frames, limits and weights; with lists of what is doubtful and what is lacking.

    Example: linkwright import robot.urdf --tip tool0 --out arm.yaml
    Example: linkwright import robot.xml --out arm.yaml

    Args:
        file: The URDF or MJCF file; STL meshes beside it are opened for volumes.
        tip: The link (of an MJCF body or site) at whose origin the tip is; repeated: arms on one torso. In Python one
            or several; by default the only end.
        base: The link on which the arm stands; the root.

    Raises `InputError` for what is neither, for a tip that is ambiguous (the line lists them), and for joints on the
    way that an arm cannot have.

    >>> import linkwright as lw
    >>> found = lw.import_arm("examples/urdf/tabletop.urdf", tip="tip")
    >>> found
    <Import: 3 joints from base to tip, 2.5 kg that move>
    >>> list(found.lacking["what"][:2])
    ['stiffness of the drives', 'backlash']
    """
    from linkwright.core.arm.descriptions.imported import import_robot
    from linkwright.face.exchange import Import

    return Import(import_robot(file, base=base, tip=tip))


def export_arm(
    arm: ArmFile,
    *,
    to: Annotated[str | None, Option(metavar="FORMAT")] = None,
    into: Annotated[File | None, file_option("FILE")] = None,
    progress: Progress | None = None,
) -> "Export":
    """The arm for other programs: URDF, MJCF (with all that gives), DXF (to scale), STEP (solid bodies), parts; what a
    diagnosis found, for controllers (ros2-offsets, klipper, csv).

    What the format cannot hold is told. --into writes what a diagnosis found into your own URDF, MJCF or calibration of
    a UR robot: a few numbers, and every other byte as it was.

    Example: linkwright export arm.yaml --to mjcf --out arm.xml
    Example: linkwright export arm.yaml --to dxf
    Example: linkwright export arm.yaml --to step --out arm.step
    Example: linkwright export corrected.yaml --into robot.urdf --out robot-corrected.urdf
    Example: linkwright export corrected.yaml --into my_robot_calibration.yaml
    Example: linkwright export corrected.yaml --to ros2-offsets

    Args:
        arm: The arm file; a corrected one, say. In Python also an `Arm`.
        to: urdf, mjcf, dxf, step, or bom: a list of parts. What was found: ros2-offsets, klipper, csv.
        into: Your own URDF, MJCF or UR calibration (.yaml), for what was found. In Python in place of `to`: its text
            with what `effects` say of zeros, lengths and axes (and in MJCF of drives' stiffness).
        progress: Hears of the bodies as they are made.

    Raises `InputError` for another format, for an arm with absolute angles, which no simulator's format knows, and for
    `step` without build123d; `MissingProperty` for parts of unknown mass.

    >>> import linkwright as lw
    >>> found = lw.export_arm("examples/welding-arm/arm.yaml", to="mjcf")
    >>> found
    <Export: MJCF, nothing missing>
    """
    from linkwright.core.arm.corrections.ur_kinematics import into_kinematics, is_kinematics
    from linkwright.core.arm.descriptions.into import into_file
    from linkwright.face.arm import arm_of
    from linkwright.face.exchange import Export, format_of, written_as

    format_ = format_of(to, into)
    given = arm_of(arm, tips="every")
    if into is not None:
        written = into_kinematics if is_kinematics(into) else into_file
        return Export(given, written(given.model, into), into)
    return Export(given, written_as(given, str(format_), progress))
