"""Tables that the paper lacks: shapes and materials at their best, and at equal size and mass, with rows added."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, TypeAlias

import linkwright as lw
from linkwright.core.units.names import nearest
from linkwright.face.plain_input import File
from linkwright.paper.printed import Paper, words
from linkwright.results.figures_in_words import shape_words

SHAPES = ("circle", "ellipse", "rectangle", "triangle", "i_section", "tube", "rectangular_tube")
"""The paper's five shapes, and the two tubes that arms are made of."""
MATERIALS = ("aluminium-6061-t6", "magnesium-az31b", "titanium-ti-6al-4v", "steel-s355", "cfrp-quasi-isotropic")
"""Of the catalogue, beside what the paper compares."""
SIZES, WALLS = (0.02, 0.14), [0.002, 0.01]
"""Bounds of outer dimensions and of walls, m."""
BEST_OF_MATERIALS = "tube"
"""The shape at whose best proportions materials are compared."""

SectionName: TypeAlias = "str | lw.Shape"
"""A shape (`"tube"`), a shape with its sizes (`"tube: diameter=80 mm, thickness=3 mm"`), a stock size (`"IPE 80"`), or
a section of `lw.shapes`."""


@dataclass(frozen=True)
class Extended:
    """One of these tables: a row for each shape or material by the keys of `columns`, whose values are headings; None
    where a row has no such figure."""

    key: str
    title: str
    columns: Mapping[str, str]
    rows: Sequence[Mapping[str, Any]]
    note: str

    def to_json(self) -> dict[str, Any]:
        """The table as JSON holds it."""
        return {"key": self.key, "title": self.title, "rows": list(self.rows), "note": self.note}


def _table(key: str, rows: Iterable[Mapping[str, Any]], by: str) -> Extended:
    head = words()["extended"][key]
    kept = [{name: row[name] for name in head["columns"]} for row in rows]
    return Extended(key, head["title"], head["columns"], sorted(kept, key=lambda row: row[by]), head["note"])


@dataclass(frozen=True)
class Request:
    """What the user adds to the tables, checked. `sections` are labels with shape and section, None without sizes."""

    paper: Paper
    sections: Sequence[tuple[str, str, lw.Shape | None]] = ()
    materials: Sequence[str] = ()
    catalogue: File | None = None

    def tables(self, tell: Callable[[str, float], None]) -> tuple[Extended, ...]:
        """Both tables; `tell` hears of each step, with the share done."""
        given = {row.shape: _section(row.shape, row.dimensions) for row in self.paper.shape}
        rows = [(name, name, given.get(name)) for name in SHAPES]
        rows += [item for item in self.sections if item[2] is not None or item[1] not in SHAPES]
        names = tuple(dict.fromkeys((*MATERIALS, *self.materials)))
        asked = [("shape", shape, "") for shape in dict.fromkeys(shape for _, shape, _ in rows)]
        asked += [("material", BEST_OF_MATERIALS, name) for name in names]
        best: dict[str, dict[str, float | None]] = {}
        for number, (kind, shape, material) in enumerate(asked):
            name = material or shape
            tell(f"the best proportions of the {kind} {name.replace('_', ' ')}", 0.1 + 0.9 * number / len(asked))
            best[name] = self._best(shape, material)
        sized = [(label, section, self._metal) for label, _, section in rows if section is not None]
        made = self._at_equal_mass([*sized, *((name, self._bar, name) for name in names)])
        shapes = [{"label": label, **best[shape], **made.get(label, _UNSIZED)} for label, shape, _ in rows]
        materials = [{"label": name, **best[name], **made[name]} for name in names]
        by_mass = _table("materials_compared", materials, "equal_mass_mm")
        return _table("shapes_at_their_best", shapes, "error_mm"), by_mass

    @cached_property
    def _bar(self) -> lw.Shape:
        return lw.shapes.Circle(diameter=self.paper.parameters.diameter)

    @cached_property
    def _metal(self) -> Mapping[str, float]:
        parameters, aluminium = self.paper.parameters, self.paper.material[0]
        ratio = aluminium.poisson_ratio
        return {"elastic_modulus": parameters.elastic_modulus, "density": parameters.density, "poisson_ratio": ratio}

    @cached_property
    def _mass(self) -> float:
        ((_, mass),) = self._swept([("", self._bar, self._metal)])
        return mass

    def _arm(self, material: str = "") -> lw.Arm:
        """The paper's arm, of another material."""
        parts = {"section": self._bar, "material": material or self._metal}
        joint = lw.Joint(range=[-math.pi, math.pi])
        chain = [(joint, lw.Link(length=length, **parts)) for length in self.paper.parameters.lengths]
        return lw.Arm(chain, name="the paper's arm", catalogue=self.catalogue)

    def _best(self, shape: str, material: str) -> dict[str, float | None]:
        """The least worst error of links of one shape that weigh no more than the paper's, with their mass; for a shape
        also within the paper's own size."""
        free, within = self._least(shape, material, SIZES[1]), None
        if not material:
            within, _ = self._least(shape, material, self.paper.parameters.diameter)
        return {"error_mm": free[0], "mass_kg": free[1], "within_mm": within}

    def _least(self, shape: str, material: str, most: float) -> tuple[float, float | None]:
        problem = lw.Problem(
            arm=self._arm(material),
            subject_to={"mass": f"<= {self._mass!r} kg", "section_size": [SIZES[0], most], "thickness": WALLS},
            choose={"section": [shape]},
        )
        best = lw.optimize(problem, progress=_unheard)
        return best.max_error_mm, best.mass_kg

    def _at_equal_mass(self, rows: Sequence[tuple[str, lw.Shape, Any]]) -> dict[str, Mapping[str, float | None]]:
        """For each label, with the section and material of its links: worst error and mass as they are, and with the
        section scaled until they weigh what the paper's do."""
        given = self._swept(rows)
        factors = [math.sqrt(self._mass / mass) for _, mass in given]
        scaled = [
            (label, section.scaled(k), made_of) for (label, section, made_of), k in zip(rows, factors, strict=True)
        ]
        size = 1e3 * self.paper.parameters.diameter
        pairs = zip(rows, given, self._swept(scaled), factors, strict=True)
        return {
            label: dict(zip(_UNSIZED, (error, mass, heavy, size * factor), strict=True))
            for (label, _, _), (error, mass), (heavy, _), factor in pairs
        }

    def _swept(self, rows: Sequence[tuple[str, lw.Shape, Any]]) -> list[list[float]]:
        """Worst error (mm) and mass (kg) of each."""
        of_rows = {"section": [section for _, section, _ in rows], "material": [made_of for _, _, made_of in rows]}
        links = range(1, len(self.paper.parameters.lengths) + 1)
        values = {f"chain[{link}].link.{key}": listed for link in links for key, listed in of_rows.items()}
        table = lw.sweep(self._arm(), values, figures=["max_error", "mass"], zipped=True, progress=_unheard)
        return table[["max_error_mm", "mass_kg"]].to_numpy().tolist()


_UNSIZED: Mapping[str, float | None] = MappingProxyType(
    dict.fromkeys(("equal_size_mm", "equal_size_kg", "equal_mass_mm", "diameter_mm"))
)
"""What a row without sizes lacks."""


def _unheard(_text: str, _share: float) -> None:
    """Hears of the steps of one row, which nobody is told of."""


def request(paper: Paper, sections: Iterable[SectionName], materials: Iterable[str], catalogue: File | None) -> Request:
    """What is asked for, checked before anything is computed. Without names of materials each of the `catalogue` file
    has a row. Raises `InputError`."""
    known = lw.materials.with_file(catalogue)
    named = [known[name].name for name in materials]
    if catalogue is not None and not named:
        named = list(known.catalogue.layers[-1].materials)
    return Request(paper, [_named(item) for item in sections], named, catalogue)


def _named(given: SectionName) -> tuple[str, str, lw.Shape | None]:
    if isinstance(given, lw.Shape):
        return shape_words(given.shape, given.given()), given.shape, given
    name, _, sizes = (part.strip() for part in given.partition(":"))
    if sizes:
        pairs = [item.partition("=") for item in sizes.split(",")]
        return _named(_section(name, {key.strip(): value.strip() for key, _, value in pairs}))
    if name in lw.shapes:
        return name, name, None
    try:
        size = lw.sections[name]
    except lw.InputError:
        known = nearest(name, [*lw.shapes, *lw.sections])
        raise lw.InputError("", "sections", f"there is no shape or stock size '{name}'{known}") from None
    return size.name, size.shape, size.section


def _section(shape: str, dimensions: Mapping[str, Any]) -> lw.Shape:
    """A section by its shape in arm files' spelling. Raises `InputError`."""
    if shape not in lw.shapes:
        raise lw.InputError("", "sections", f"there is no shape '{shape}'{nearest(shape, list(lw.shapes))}")
    return getattr(lw.shapes, "".join(part.capitalize() for part in shape.split("_")))(**dimensions)
