"""The paper's tables and figures, and the seams that it speaks of."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

from linkwright.api.signature import ArmFile, File, Option, Progress, Quantity, file_option, listed, named

if TYPE_CHECKING:
    from linkwright.paper.extended import SectionName
    from linkwright.paper.face import Figures, Tables
    from linkwright.paper.seam import Seam

Point = Sequence[Quantity]


def paper_tables(
    *,
    sections: Annotated["Sequence[SectionName]", Option("--section", "NAME[:SIZES]", kind=str, many=True)] = (),
    materials: Annotated[Sequence[str], Option("--material", "NAME", kind=str, many=True)] = (),
    catalogue: Annotated["File | None", file_option("FILE")] = None,
    quick: Annotated[bool, Option()] = False,
    progress: Progress | None = None,
) -> "Tables":
    """The paper's Tables III to VII: printed, reproduced by its conventions, as its equations read, and corrected.

    Two that the paper lacks follow: shapes and materials at their best proportions, at equal size and at equal mass.

    Example: linkwright tables --markdown tables.md --json tables.json
    Example: linkwright tables --section "tube: diameter=80 mm, thickness=3 mm" --section "IPE 80" --material invar-36

    Args:
        sections: A row more: a shape, with its sizes after a colon, or a stock size. In Python also a section.
        materials: A row more: a material of the catalogue.
        catalogue: Materials that add to the shipped ones. Each has a row where --material names none.
        quick: Leave out the tables that the paper lacks.
        progress: Hears of it; a bar by default, where somebody looks.

    >>> import linkwright as lw
    >>> paper = lw.paper_tables(quick=True)
    >>> list(paper["clearance"].columns)[:3]
    ['label', 'paper_1', 'paper_2']
    """
    from linkwright.face.progress import reporting
    from linkwright.paper.extended import request
    from linkwright.paper.face import Tables
    from linkwright.paper.printed import read_paper
    from linkwright.paper.tables import make_tables, proofs, verdicts

    asked = request(read_paper(), sections, materials, catalogue)
    with reporting(progress) as tell:
        tell("the paper's tables", 0.0)
        book = make_tables()
        further = () if quick else asked.tables(tell)
    return Tables(book, verdicts(book), proofs(book), further)


def paper_figures(
    *, formats: Annotated[Sequence[str], Option("--format", "svg,pdf", kind=str, read=named)] = ()
) -> "Figures":
    """The paper's Figures 5 to 9: what it plots by its own conventions, and the truth beside it.

    Example: linkwright figures --out figures --format svg,pdf

    Args:
        formats: Draw each for print too, 180 mm wide: svg, pdf (by Chromium, Chrome or Edge). Needs --out.

    >>> import linkwright as lw
    >>> drawn = lw.paper_figures()
    >>> list(drawn[7].columns)[:2]
    ['clearance_mm', 'corrected_clearance_mm']
    """
    from linkwright.core.units.quantities import InputError
    from linkwright.paper.face import FORMATS, Figures
    from linkwright.paper.output.figures import make_figures
    from linkwright.report.page import need_browser

    unknown = [kind for kind in formats if kind not in FORMATS]
    if unknown:
        raise InputError("", "formats", f"knows {' and '.join(FORMATS)}, not '{unknown[0]}'")
    if "pdf" in formats:
        need_browser()
    return Figures(make_figures(), tuple(formats))


def seam(
    arm: ArmFile,
    start: Annotated[Point, Option("--from", "POINT", kind=str, read=listed)],
    end: Annotated[Point, Option("--to", "POINT", kind=str, read=listed)],
    *,
    points: Annotated[int, Option(least=2, most=1000)] = 9,
) -> "Seam":
    """Whether a planar arm can follow a straight seam, and its worst error along the seam, tangential and normal.

    Example: linkwright seam arm.yaml --from "600 mm, 500 mm" --to "-600 mm, 500 mm"

    Args:
        arm: The arm file. In Python also an `Arm`.
        start: Where it starts: 'X, Y' with units. In Python two lengths.
        end: Where it ends: 'X, Y' with units. In Python two lengths.
        points: Points looked at along it.

    Every posture counts at each point. Of several arms on one torso it is the tip that the arm was read for, whatever
    the others do meanwhile. Raises `InputError`, and `NoAnswer` with the first point that cannot be reached.

    >>> import linkwright as lw
    >>> lw.seam("examples/welding-arm/arm.yaml", ["600 mm", "500 mm"], ["-600 mm", "500 mm"], points=3)
    <Seam: cathode-bus welding arm: every point can be reached, proved>
    """
    from linkwright.core.units.quantities import InputError
    from linkwright.face.arm import arm_of
    from linkwright.paper.seam import point_of, seam_of

    given = arm_of(arm, tips="one")
    first, last = point_of(start, "start"), point_of(end, "end")
    if first == last:
        raise InputError("", "end", "is the same point as the start; a seam has a length")
    if points < 2:
        raise InputError("", "points", f"needs 2 or more, not {points}")
    return seam_of(given, first, last, points)
