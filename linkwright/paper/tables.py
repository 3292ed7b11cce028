"""Tables III to VII of the paper beside the truth, and its four conclusions, judged by figures computed here."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Literal

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.worst.reach import ring_of
from linkwright.core.arm.worst.seam import SeamCheck, check_seam
from linkwright.core.sections import build
from linkwright.paper.conventions import Conventions, Reading, printed_second_moment, squared
from linkwright.paper.corrected import DEFORMATION, PaperArm, least_deformation, material, worst_error, worst_signed
from linkwright.paper.printed import Paper, Row, Table, read_paper, words
from linkwright.results.figures_in_words import figure, mm


@dataclass(frozen=True)
class Book:
    """All tables of the paper and what they were computed from."""

    paper: Paper
    tables: tuple[Table, ...]

    def table(self, key: str) -> Table:
        """The table of a key; raises KeyError."""
        return next(table for table in self.tables if table.key == key)


def make_tables() -> Book:
    """Compute Tables III to VII. Takes some seconds."""
    return _Maker(read_paper()).book()


def joints_label(joints: Sequence[int]) -> str:
    """The joints (from 1) as words."""
    numbers = [str(joint) for joint in sorted(joints)]
    if not numbers:
        return "none"
    return f"joint {numbers[0]}" if len(numbers) == 1 else f"joints {', '.join(numbers[:-1])} and {numbers[-1]}"


def _note(*names: str, **values: str) -> str:
    """Sentences on a row, by their names in `words.yaml`."""
    return " ".join(words()["notes"][name].format(**values) for name in names)


def _squares(distances: Iterable[float]) -> tuple[float, ...]:
    """What the paper prints for distances (m), mm^2."""
    return tuple(map(squared, distances))


@dataclass(frozen=True)
class _Maker:
    paper: Paper

    @cached_property
    def printed(self) -> Reading:
        return Conventions(self.paper).printed

    @cached_property
    def as_read(self) -> Reading:
        return Conventions(self.paper).as_read

    @cached_property
    def arms(self) -> PaperArm:
        return PaperArm(self.paper)

    @cached_property
    def remarks(self) -> tuple[str, ...]:
        paper = self.paper
        values = {
            "weight": mm(paper.weight_sag, 5),
            "tool": mm(paper.tool_sag),
            "sag": mm(self.as_read.sag, 3),
            "used": mm(self.printed.sag, 3),
            "clearance": mm(paper.clearance_size),
            "backlash": figure(paper.backlash_size),
        }
        return tuple(remark.format(**values) for remark in words()["remarks"])

    def book(self) -> Book:
        rows = {
            "clearance": self.played("clearance"),
            "backlash": self.played("backlash"),
            "backlash_direction": self.direction(),
            "material": self.material(),
            "shape": self.shape(),
        }
        return Book(self.paper, tuple(self._table(key, tuple(made)) for key, made in rows.items()))

    def _table(self, key: str, rows: tuple[Row, ...]) -> Table:
        head = words()["tables"][key]
        remarks = (head["remark"], *self.remarks)
        return Table(key, head["number"], head["title"], tuple(head["columns"]), rows, remarks)

    def played(self, which: Literal["clearance", "backlash"]) -> Iterator[Row]:
        backlash = which == "backlash"
        for row in self.paper.backlash if backlash else self.paper.clearance:
            arm = partial(self.arms.arm, **{which: row.joints})
            printed = self.printed.play(row.joints, backlash=backlash)
            read = self.as_read.play(row.joints, backlash=backlash)
            corrected = (worst_error(arm(leave_out=DEFORMATION)), worst_error(arm()))
            made = Row(joints_label(row.joints), row.printed, _squares(printed), read, corrected, "", len(row.printed))
            yield replace(made, note=self._play_note(made, row.joints, backlash=backlash))

    def _play_note(self, made: Row, joints: Sequence[int], *, backlash: bool) -> str:
        added = mm(made.corrected[1] - made.corrected[0], 3)
        if not joints:
            return _note("sag", sag=mm(self.printed.sag, 3), added=added)
        names = [] if made.agrees[1] else ["stopped_early"]
        names.append("disc" if not backlash else "nothing_follows" if tuple(joints) == (3,) else "beyond_turns")
        return _note(*names, "adds", swing=mm(made.corrected[0]), read=mm(made.as_read[0]), added=added)

    def direction(self) -> Iterator[Row]:
        arms = [self.arms.arm(backlash=(1, 2, 3), leave_out=leave) for leave in (DEFORMATION, frozenset[str]())]
        for row in self.paper.direction:
            corrected = tuple(worst_signed(arm, row.signs) for arm in arms)
            label = " ".join("+" if sign > 0 else "−" for sign in row.signs)
            squares, read = _squares(self.printed.direction(row.signs)), self.as_read.direction(row.signs)
            made = Row(label, row.printed, squares, read, corrected, "", 2)
            name = "equal_signs" if made.agrees[1] else "mixed_signs"
            yield replace(made, note=_note(name, printed=made.printed[1], ours=made.reproduced_printed[1]))

    def material(self) -> Iterator[Row]:
        for row in self.paper.material:
            ends = list(zip(row.elastic_modulus, row.density, strict=True))
            corrected = [worst_error(self.arms.arm(made_of=material(*end, row.poisson_ratio))) for end in ends]
            made = Row(
                row.name,
                row.printed,
                _squares(self.printed.material(*end) for end in ends),
                tuple(self.as_read.material(*end) for end in ends),
                tuple(corrected),
                "",
                1 if row.one_figure else 2,
            )
            yield replace(made, note=self._material_note(made))

    def _material_note(self, made: Row) -> str:
        if not all(made.agrees):
            reach = mm(sum(self.paper.parameters.lengths))
            ours, moved = made.reproduced_printed[0], mm(made.corrected[0], 3)
            return _note("digit_dropped", ours=ours, printed=made.printed[0], moved=moved, reach=reach)
        if made.label == "aluminium":
            return _note("of_table_ii")
        roots = dict.fromkeys(mm(1e-3 * math.sqrt(float(text)), 2) for text in dict.fromkeys(made.printed))
        return _note("roots", roots=" and ".join(roots))

    def shape(self) -> Iterator[Row]:
        for row in self.paper.shape:
            misprinted = printed_second_moment(row.shape, row.dimensions, misprint=True)
            wrong = figure(squared(self.printed.shape(misprinted)), 2)
            yield Row(
                row.name,
                row.printed,
                _squares((self.printed.shape(printed_second_moment(row.shape, row.dimensions)),)),
                (self.as_read.shape(misprinted),),
                (worst_error(self.arms.arm(section=build(row.shape, dict(row.dimensions)))),),
                _note(row.shape, misprinted=wrong),
                1,
            )


@dataclass(frozen=True)
class Verdict:
    """One conclusion of the paper: its number, what it says in short, the judgement, the reason with our figures."""

    number: int
    claim: str
    judgement: Literal["holds", "holds in part", "does not hold"]
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
    clearance, backlash, sag = all_joints.corrected[0], book.table("backlash").rows[-1].corrected[0], none.corrected[1]
    roots = [math.sqrt(value) for row in (none, all_joints) for value in row.reproduced]
    rises = [float(row.printed[1]) - float(row.printed[0]) for row in (none, all_joints)]
    added = [row.corrected[1] - row.corrected[0] for row in book.table("clearance").rows]
    steady = "steady" if max(added) - min(added) < 1e-9 else "varies"
    shapes = {row.label: row.corrected[0] for row in book.table("shape").rows}
    materials = [value for row in book.table("material").rows[:-1] for value in row.corrected]
    values = {
        "least_sag": mm(least_deformation(arms), 2),
        "sag": mm(sag),
        "sag3": mm(sag, 3),
        "clearance": mm(clearance),
        "backlash": mm(backlash),
        "total": mm(clearance + backlash + sag),
        "together": mm(worst_error(arms.arm(clearance=(1, 2, 3), backlash=(1, 2, 3)))),
        "play_root": figure(roots[2], 4),
        "sag_root": figure(roots[1], 3),
        "both_root": figure(roots[3], 4),
        "rise_without": figure(rises[0], 2),
        "rise_with": figure(rises[1], 2),
        "steady": _note(steady, sag=mm(sag), least=mm(min(added)), most=mm(max(added))),
        "least_material": mm(min(materials), 3),
        "most_material": mm(max(materials), 3),
        "ellipse": mm(shapes["ellipse"], 3),
        "triangle": mm(shapes["triangle"], 3),
    }
    return tuple(
        Verdict(number, said["claim"], said["judgement"], said["reason"].format(**values))
        for number, said in enumerate(words()["verdicts"], start=1)
    )


def proofs(book: Book) -> tuple[Proof, ...]:
    """What the paper proved about reach and straight seams, and what it did not."""
    lengths, long_first = book.paper.parameters.lengths, (1.0, 0.3, 0.2)
    ring = ring_of(lengths)
    folds = (math.pi, math.radians(60.0), math.radians(60.0))
    seams = {
        "free": check_seam(_planar(lengths), (0.8, 0.3), (-0.8, 0.3)),
        "hole": check_seam(_planar(long_first), (0.8, 0.3), (-0.8, 0.3)),
        "bent": check_seam(_planar(lengths, folds), (0.9, 0.3), (-0.9, 0.3)),
    }
    values = {
        "lengths": ", ".join(mm(length) for length in lengths),
        "inner": mm(ring.inner),
        "outer": mm(ring.outer),
        "hole_inner": mm(ring_of(long_first).inner),
        "missing": mm(seams["bent"].missing, 3),
        **{name: _point(seam) for name, seam in seams.items()},
    }
    made: list[Proof] = []
    for said in words()["reach"]:
        seam = seams.get(said.get("seam", ""))
        holds = seam is not None and seam.verdict == "reachable"
        made.append(Proof(said["statement"], holds, said["shown_by"].format(**values), seam))
    return tuple(made)


def _planar(lengths: tuple[float, ...], limits: tuple[float, ...] = (math.pi, math.pi, math.pi)) -> Arm:
    joints = tuple(Joint(range=(-limit, limit)) for limit in limits)
    return Arm("planar arm", joints, tuple(Link(length) for length in lengths))


def _point(check: SeamCheck) -> str:
    if check.first_unreachable is None:
        return "none"
    return f"({', '.join(figure(1e3 * value, 5) for value in check.first_unreachable)}) mm"
