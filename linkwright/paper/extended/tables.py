"""The tables that the paper lacks: shapes at their best, materials fairly compared, a design step by step.

All for the paper's arm: Table II's lengths and mass, rigid drives, no tool, every joint free to turn full circle.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import Material
from linkwright.core.optimize.choice.combinations import Choice, Progress, choose
from linkwright.core.optimize.exchange.design import arm_of
from linkwright.core.optimize.exchange.exchange import context_of
from linkwright.core.optimize.limits import limit_on
from linkwright.core.optimize.problem import Problem
from linkwright.core.sections import build
from linkwright.core.sections.section import Section
from linkwright.core.units.quantities import NoAnswer, Relation, format_quantity
from linkwright.paper.corrected import PaperArm, search_of, worst_error
from linkwright.paper.printed import read_paper
from linkwright.paper.rows import Cell, Column, ExtendedTable
from linkwright.results.figures_in_words import figure, mm

from .sensitivity import seam_table, tolerance_table
from .warmth import mass_of, material_table
from .workplace import dual_table, heat_table, rail_table

SHAPES = ("circle", "ellipse", "rectangle", "triangle", "i_section", "tube", "rectangular_tube")
"""The paper's five shapes, and the two tubes that arms are made of."""
STUFFS = ("steel-s355", "cfrp-quasi-isotropic", "titanium-ti-6al-4v")
"""What a link may be made of in the last step, beside the paper's aluminium."""
SIZES, WALLS = (0.02, 0.14), (0.002, 0.01)
"""Bounds of outer dimensions and of walls, m."""
THICK_WALLS = (0.002, 0.06)
"""Bounds of walls where every shape has to reach the mass of a solid bar, m."""
LENGTHS = (0.2, 0.62)
"""Bounds of a link's length, m: none longer than half the reach, so that the arm reaches a whole disc as before."""
STIFFNESS = 60e3
"""An assumed drive, N*m/rad: the paper prints none, and rigid drives have no sensitivity."""
DIMENSIONS = "Dimensions stand as width × height × walls (flange before web), or diameter × wall."
SEAM = ((0.6, 0.5), (-0.6, 0.5))
"""The seam of the table, m."""


@dataclass(frozen=True)
class Extended:
    """Makes the extended tables; `progress` hears of each table begun."""

    arms: PaperArm
    progress: Progress | None = None

    @cached_property
    def played(self) -> Arm:
        """The paper's arm with clearance and backlash in every joint."""
        return self.arms.arm(clearance=(1, 2, 3), backlash=(1, 2, 3))

    @cached_property
    def mass(self) -> float:
        """The mass of the paper's links, kg: what every design may have."""
        return mass_of(self.played)

    def tables(self) -> tuple[ExtendedTable, ...]:
        """All of them, in the order of the page. Takes about half a minute."""
        makers = (
            self.shapes,
            self.materials,
            self.steps,
            self.tolerances,
            self.seam,
            self.heat,
            self.rail,
            self.dual_arm,
        )
        made: list[ExtendedTable] = []
        for number, maker in enumerate(makers):
            if self.progress is not None:
                self.progress(number, len(makers), f"the extended table of {maker.__name__.replace('_', ' ')}")
            made.append(maker())
        return tuple(made)

    # ---- shapes

    def shapes(self, shapes: Sequence[str] = SHAPES) -> ExtendedTable:
        """Each shape at its own best proportions at the mass of the paper's arm, one section for all and one each."""
        arm = self.arms.arm()
        rows: list[tuple[Cell, ...]] = []
        printed = {row.shape: build(row.shape, dict(row.dimensions)) for row in self.arms.paper.shape}
        for shape in shapes:
            given = printed.get(shape)
            start = arm if given is None else self.arms.arm(section=given)
            alike = _arm_of(self._choice(arm, shapes=(shape,), same="size", relation="==", walls=THICK_WALLS))
            own = _arm_of(self._choice(arm, shapes=(shape,), same="section"))
            as_printed = None if given is None else 1e3 * worst_error(start)
            section = alike.links[0].section
            rows.append(
                (
                    shape.replace("_", " "),
                    as_printed,
                    1e3 * worst_error(alike),
                    "–" if section is None else _dimensions(section),
                    1e3 * worst_error(own),
                    mass_of(own),
                )
            )
        rows.sort(key=lambda row: float(row[2] or 0.0))
        lengths = ", ".join(figure(1e3 * length) for length in self.arms.paper.parameters.lengths)
        note = (
            f"Deformation alone, links of {lengths} mm. First the paper's proportions (Table VII); then the best ones "
            f"with the same section in all links that weigh {figure(self.mass)} kg together, as the paper's do (outer "
            f"dimensions {_span(SIZES)}, walls {_span(THICK_WALLS)}); then the best with a section of its own for each "
            f"link that weigh no more (walls {_span(WALLS)}). Without a tool a link carries only links: its sag "
            "depends on how far from the middle its material lies and not on how much of it there is, so that the "
            f"last may end far below the mass allowed. {DIMENSIONS}"
        )
        columns = (
            Column("shape"),
            Column("as printed", "mm"),
            Column("same for all", "mm"),
            Column("dimensions"),
            Column("own for each", "mm"),
            Column("its mass", "kg"),
        )
        return ExtendedTable("shapes_at_their_best", "Shapes at their best proportions", columns, tuple(rows), note)

    def _choice(
        self,
        arm: Arm,
        *,
        shapes: tuple[str, ...] | None = None,
        materials: tuple[Material, ...] | None = None,
        same: str | None = None,
        lengths: bool = False,
        relation: Relation = "<=",
        walls: tuple[float, float] = WALLS,
    ) -> Choice:
        limits = [limit_on("mass", relation, self.mass)]
        if lengths:
            limits.append(limit_on("reach", "==", sum(self.arms.paper.parameters.lengths)))
        problem = Problem(
            file="the paper's arm",
            arm=arm,
            minimize="max_error",
            workspace=search_of(arm)[0].workspace,
            load_cases=(arm.payload,),
            limits=tuple(limits),
            link_length=LENGTHS if lengths else None,
            section_size=SIZES,
            thickness=walls,
            shapes=shapes,
            materials=materials,
            same=frozenset() if same is None else frozenset({same}),
        )
        found = choose(context_of(problem))
        if found is None:
            raise NoAnswer(f"{arm.name}: no design keeps the bounds of the extended tables")
        return found

    def materials(self) -> ExtendedTable:
        """The paper's and the catalogue's materials at equal size and equal mass, at 20 and at 50 degC."""
        return material_table(self.arms)

    # ---- step by step

    def steps(
        self, shapes: Sequence[str] = SHAPES, stuffs: Sequence[str] = STUFFS, finalists: int = 3
    ) -> ExtendedTable:
        """What each freedom is worth: diameters, lengths, shape, a shape for each link, a material for each link.

        Each step starts from what the one before left free. A shape for each link is sought among the `finalists` best
        of the shapes that serve all links, with the materials of the step before, and a material for the best shapes.
        """
        given = self.played
        catalogue = load_catalogue(user=False)
        common = self._choice(given, shapes=tuple(shapes), same="section", lengths=True)
        best = tuple(str(each.shapes[0]) for each in common.candidates[:finalists])
        own = self._choice(given, shapes=best, lengths=True)
        stuff = (self.arms.material, *(catalogue.find(name) for name in stuffs))
        made = self._choice(_arm_of(own), materials=stuff, lengths=True)
        ladder = (
            ("as given", given),
            ("best diameters", _arm_of(self._choice(given))),
            ("best lengths too", _arm_of(self._choice(given, lengths=True))),
            ("best shape for all", _arm_of(common)),
            ("own shape per link", _arm_of(own)),
            ("own material per link", _arm_of(made)),
        )
        rows: list[tuple[Cell, ...]] = []
        before: float | None = None
        for step, arm in ladder:
            worst, still = worst_error(arm), worst_error(_without_play(arm))
            # What lies below a nanometre is the certificate's gap.
            gain = None if before is None else round(1e3 * (before - worst), 6) + 0.0
            rows.append((step, 1e3 * worst, gain, 1e3 * still, mass_of(arm), _links(arm, self.arms.material)))
            before = worst
        tried = ", ".join(shape.replace("_", " ") for shape in shapes)
        note = (
            f"The worst error with play (clearance {mm(given.joints[0].clearance)}, backlash "
            f"±{figure(0.5 * given.joints[0].backlash)} rad in every joint) and deformation; the links weigh "
            f"{figure(self.mass)} kg together or less and reach {mm(sum(given.lengths))}. Lengths {_span(LENGTHS)}: no "
            "link is longer than half the reach, so that the arm still reaches a whole disc. Outer dimensions "
            f"{_span(SIZES)}, walls {_span(WALLS)}. Shapes tried for all links: {tried}; for each link: "
            f"{', '.join(shape.replace('_', ' ') for shape in best)}, the best of them. Materials tried: aluminium "
            f"as in Table II, {', '.join(stuffs)}. No section changes what play does: "
            f"the lost motion of joint 1 swings the whole reach. {DIMENSIONS}"
        )
        columns = (
            Column("step"),
            Column("worst error", "mm"),
            Column("worth", "mm"),
            Column("deformation alone", "mm"),
            Column("mass", "kg"),
            Column("links"),
        )
        return ExtendedTable("step_by_step", "What each step of a design is worth", columns, tuple(rows), note)

    # ---- tolerances, seam and workplace

    def tolerances(self) -> ExtendedTable:
        """The sensitivity of the worst error to every clearance, backlash, stiffness and length."""
        arm = replace(self.played, joints=tuple(replace(joint, stiffness=STIFFNESS) for joint in self.played.joints))
        note = (
            f"The paper's arm with play in every joint, and with drives of {figure(STIFFNESS / 1e3)} kN·m/rad, an "
            "assumed figure: the paper takes its drives for rigid, and rigid drives have no sensitivity. Such drives "
            f"alone bring the worst error from {mm(worst_error(self.played))} to {mm(worst_error(arm))}."
        )
        return tolerance_table(arm, note)

    def heat(self) -> ExtendedTable:
        """Growth at 50 degC beside the elastic error, and what 125 gauss leaves."""
        return heat_table(self.arms)

    def rail(self) -> ExtendedTable:
        """What the sliding rail adds."""
        return rail_table(self.arms)

    def dual_arm(self) -> ExtendedTable:
        """How far the tips of two arms on one rail can part."""
        return dual_table(self.arms)

    def seam(self, *, points: int = 9, postures: int = 1024) -> ExtendedTable:
        """The error along a seam and across it, with play in every joint."""
        return seam_table(self.played, *SEAM, points=points, postures=postures)


def make_extended(progress: Progress | None = None) -> tuple[ExtendedTable, ...]:
    """The extended tables. Takes about half a minute."""
    return Extended(PaperArm(read_paper()), progress).tables()


def _arm_of(choice: Choice) -> Arm:
    return arm_of(choice.space, choice.exchanged.x, choice.combination.materials)


def _without_play(arm: Arm) -> Arm:
    return replace(arm, joints=tuple(replace(joint, clearance=0.0, backlash=0.0) for joint in arm.joints))


def _span(bounds: tuple[float, float]) -> str:
    return " to ".join(format_quantity(value, "length") for value in bounds)


def _dimensions(section: Section) -> str:
    """A section's dimensions in the order of its arm file, to a tenth of a millimetre."""
    return f"{' × '.join(f'{1e3 * float(value):.4g}' for value in section.given().values())} mm"


def _links(arm: Arm, usual: Material) -> str:
    words: list[str] = []
    for link in arm.links:
        section = link.section
        name = "rigid" if section is None else f"{section.shape.replace('_', ' ')} {_dimensions(section)}"
        stuff = "" if link.material is None or link.material.name == usual.name else f", {link.material.name}"
        words.append(f"{figure(1e3 * link.length, 3)} mm of {name}{stuff}")
    return "; ".join(words)
