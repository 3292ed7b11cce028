"""The paper's four conclusions and its proof about straight seams, judged by figures computed here."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.worst.reach import ring_of
from linkwright.core.arm.worst.seam import SeamCheck, check_seam
from linkwright.results.figures_in_words import figure, mm

from .corrected import PaperArm, least_deformation, worst_error
from .tables import Book

Judgement = Literal["holds", "holds in part", "does not hold"]


@dataclass(frozen=True)
class Verdict:
    """One conclusion of the paper: its number, what it says in short, the judgement, the reason with our figures."""

    number: int
    claim: str
    judgement: Judgement
    reason: str


@dataclass(frozen=True)
class Proof:
    """A statement about reach that the paper makes or needs: whether it holds, and the example that shows it.

    `seam` is the check behind it, where there is one.
    """

    statement: str
    holds: bool
    shown_by: str
    seam: SeamCheck | None = None


def verdicts(book: Book) -> tuple[Verdict, ...]:
    """The four conclusions, judged from the tables and a few figures more."""
    arms = PaperArm(book.paper)
    none, *_, all_joints = book.table("clearance").rows
    backlash = book.table("backlash").rows[-1]
    sag = none.corrected[1]
    least = least_deformation(arms)
    together = worst_error(arms.arm(clearance=(1, 2, 3), backlash=(1, 2, 3)))
    total = all_joints.corrected[0] + backlash.corrected[0] + sag
    roots = [math.sqrt(value) for row in (none, all_joints) for value in row.reproduced]
    rises = [float(row.printed[1]) - float(row.printed[0]) for row in (none, all_joints)]
    added = [row.corrected[1] - row.corrected[0] for row in book.table("clearance").rows]
    same = max(added) - min(added) < 1e-9
    steady = f"it adds {mm(sag)} in every row" if same else f"it adds {mm(min(added))} to {mm(max(added))}"
    shapes = {row.label: row.corrected[0] for row in book.table("shape").rows}
    materials = [value for row in book.table("material").rows[:-1] for value in row.corrected]
    return (
        Verdict(
            1,
            "in different poses the error is different, since deformation is",
            "holds",
            f"Deformation alone moves the tip by {mm(least, 2)} (standing or hanging) to {mm(sag, 3)} (held straight "
            "out). The paper leaves out that backlash depends on the pose as well, since in a serial arm it turns "
            "all that follows.",
        ),
        Verdict(
            2,
            "the error under all factors is not the sum of the errors under each",
            "holds in part",
            "At a pose with given signs the directions differ, so the sum is only a bound. The maxima, which the "
            f"paper tabulates, do add up: clearance {mm(all_joints.corrected[0])}, backlash "
            f"{mm(backlash.corrected[0])} and deformation {mm(sag)} give {mm(total)}, and the worst pose with all "
            f"three has {mm(together)}. Its own figures add up too, once the roots are taken: {figure(roots[2], 4)} "
            f"+ {figure(roots[1], 3)} = {figure(roots[3], 4)} mm in Table III.",
        ),
        Verdict(
            3,
            "the worse the error, the bigger the impact of deformation",
            "does not hold",
            "An artefact of the squaring: (a + d)² − a² = 2ad + d² grows with a where d does not. Printed, "
            f"deformation adds {figure(rises[0], 2)} without and {figure(rises[1], 2)} with three clearances; in "
            f"truth {steady}.",
        ),
        Verdict(
            4,
            "clearance, backlash, lengths, material and shape change the largest error, and design should consider "
            "them all",
            "holds in part",
            "They do, but not alike, and the paper's own ranking misleads. Backlash makes "
            f"{mm(backlash.corrected[0])} of {mm(together)}, deformation {mm(sag, 3)}, clearance "
            f"{mm(all_joints.corrected[0])}. The metals of Table VI span only {mm(min(materials), 3)} to "
            f"{mm(max(materials), 3)}; its shapes span {mm(shapes['ellipse'], 3)} to {mm(shapes['triangle'], 3)}, "
            "which is the proportions picked for each and not the shape.",
        ),
    )


def proofs(book: Book) -> tuple[Proof, ...]:
    """What the paper proved about reach and straight seams, and what it did not."""
    lengths = book.paper.parameters.lengths
    ring = ring_of(lengths)
    own = check_seam(_free(lengths), (0.8, 0.3), (-0.8, 0.3))
    long_first = (1.0, 0.3, 0.2)
    hole = check_seam(_free(long_first), (0.8, 0.3), (-0.8, 0.3))
    bent = check_seam(_free(lengths, (math.pi, math.radians(60.0), math.radians(60.0))), (0.9, 0.3), (-0.9, 0.3))
    shown = ", ".join(mm(length) for length in lengths)
    return (
        Proof(
            "A planar 3R arm reaches a ring of inner radius L1 − L2 − L3 (printed as its diameter).",
            False,
            f"Only where link 1 is as long as the others together; for its own {shown} that is negative. The inner "
            f"radius is max(0, 2 max(L) − ΣL), here {mm(ring.inner)}: a full disc of {mm(ring.outer)}.",
        ),
        Proof(
            "A segment between two reachable points lies between the circles through its ends (14).",
            False,
            "Its middle can come nearer to the base than either end: from (800, 300) to (−800, 300) mm the ends lie "
            "at 854 mm, the middle at 300 mm.",
        ),
        Proof(
            "Segments between reachable points are reachable for its lengths, without joint limits.",
            own.verdict == "reachable",
            "The ring has no hole, a disc is convex; the paper's argument is not needed.",
            own,
        ),
        Proof(
            "The same for any planar 3R arm.",
            hole.verdict == "reachable",
            f"Links of 1000, 300 and 200 mm leave a hole of {mm(ring_of(long_first).inner)}: from (800, 300) to "
            f"(−800, 300) mm the first point out of reach is {_point(hole)}.",
            hole,
        ),
        Proof(
            "The same for its lengths with joint limits.",
            bent.verdict == "reachable",
            "With joints 2 and 3 within ±60° the arm cannot fold: from (900, 300) to (−900, 300) mm both ends are "
            f"reachable, the first point out of reach is {_point(bent)}, and the tip stays up to "
            f"{mm(bent.missing, 3)} away from the seam.",
            bent,
        ),
    )


def _free(lengths: tuple[float, ...], limits: tuple[float, ...] = (math.pi, math.pi, math.pi)) -> Arm:
    joints = tuple(Joint(range=(-limit, limit)) for limit in limits)
    return Arm("planar arm", joints, tuple(Link(length) for length in lengths))


def _point(check: SeamCheck) -> str:
    if check.first_unreachable is None:
        return "none"
    return f"({', '.join(figure(1e3 * value, 5) for value in check.first_unreachable)}) mm"
