"""Problems whose answers are held against every choice singly, and what they choose from."""

from __future__ import annotations

import itertools
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np
from scipy.optimize import brentq

from benchmarks.results.row import Row, at_most
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.optimize.problem import Problem, read_problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array

from .beams import Chain, Joint, Link, Load, Metal, Section, grid, tube

METALS = ("aluminium-6061-t6", "steel-s355", "titanium-ti-6al-4v")
LENGTHS = (0.4, 0.3)
RANGES = ((-60.0, 60.0), (-120.0, 120.0))
POSES: Array = grid(*RANGES)
STIFFNESS = 60e3
WITHIN = 0.2
"""%; the best of all, on a grid of poses, may be off by this."""
RODS = "section_size: [10 mm, 150 mm], local_buckling: off"
ALIKE = "choose: {section: [circle], material: [aluminium-6061-t6, steel-s355], same: [section, material, size]}\n"


@dataclass(frozen=True)
class Plane:
    """A planar arm of two links as a file: further keys of its joints, links and of the whole."""

    joint: str = ""
    links: tuple[str, str] = ("", "")
    payload: str = "mass: 2 kg"
    rest: str = ""

    @property
    def text(self) -> str:
        """The arm file."""
        rows = ""
        for (low, high), length, link in zip(RANGES, LENGTHS, self.links, strict=True):
            drive = f"range: [{low} deg, {high} deg], stiffness: 60 kN*m/rad, mass: 1 kg{self.joint}"
            own = link or "section: {shape: circle, diameter: 50 mm}, material: aluminium-6061-t6"
            rows += f"  - joint: {{{drive}}}\n    link: {{length: {1e3 * length} mm, {own}}}\n"
        return f"chain:\n{rows}payload: {{{self.payload}}}\nleave_out: [shear_deformation]\n{self.rest}"


def metal(name: str) -> Metal:
    """What the catalogue says of a material."""
    values = load_catalogue(user=False).find(name).at(293.15)
    needed = ("elastic_modulus", "shear_modulus", "density", "thermal_expansion")
    return Metal(*(values.need(item) for item in needed))


def chain(sections: Sequence[Section], metals: Sequence[str], backlash: float = 0.0, **more: object) -> Chain:
    """The same arm by hand."""
    joints = (Joint(compliance=1.0 / STIFFNESS, mass=1.0, backlash=backlash),) * 2
    links = tuple(
        Link(length, section, metal(name)) for length, section, name in zip(LENGTHS, sections, metals, strict=True)
    )
    return Chain(joints, links, **more)  # type: ignore[arg-type]


def rods(diameter: float, name: str, backlash: float = 0.0, **more: object) -> Chain:
    """The arm of two rods that are alike."""
    return chain([tube(diameter, 0.5 * diameter)] * 2, [name] * 2, backlash, **more)


Figure = Callable[[float, str], float]
"""Of rods by their diameter (m) and their metal."""


def of_rods(diameter: float, name: str) -> float:
    """The mass of two rods that are alike, kg."""
    return rods(diameter, name).mass


def combinations_of(values: Sequence[Section], metals: Sequence[str], count: int = 2) -> Iterator[Chain]:
    """Every arm of some sections and metals."""
    for sections in itertools.product(values, repeat=count):
        for names in itertools.product(metals, repeat=count):
            yield chain(sections, names)


def problem_of(arm: str, text: str, files: Mapping[str, str] = MappingProxyType({})) -> Problem:
    """The problem that the texts describe; `files` are further ones beside them."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in {"arm.yaml": arm, "problem.yaml": f"arm: arm.yaml\n{text}", **files}.items():
            (Path(folder) / name).write_text(content, encoding="utf-8")
        return read_problem(Path(folder) / "problem.yaml")


@dataclass(frozen=True)
class Asked:
    """A question: its row's name, the texts, and the best of all choices singly (SI), with what these are."""

    what: str
    arm: str
    text: str
    best: Callable[[], float]
    choices: str
    files: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    def row(self) -> Row:
        """By how much the answer is off the best of all."""
        problem = problem_of(self.arm, self.text, self.files)
        began = time.process_time()
        result = optimise(problem)
        seconds = time.process_time() - began
        figure = problem.objective
        note = f"{figure.factor * result.objective:.4g} {figure.unit} in {seconds:.1f} s; {self.choices}"
        return off(self.what, result.objective, self.best(), note)


def lightest_rods(
    what: str,
    limit: str,
    figure: Figure,
    most: float,
    arm: str = "",
    text: str = "",
    mass: Figure = of_rods,
) -> Asked:
    """The question for the lightest rods that keep a figure within a limit."""

    def best() -> float:
        each = [(thinnest(lambda d, m=name: figure(d, m) - most), name) for name in METALS[:2]]
        return min(mass(d, name) for d, name in each if d is not None)

    limits = f"subject_to: {{{', '.join(item for item in (limit, RODS) if item)}}}\n"
    asked = f"minimize: mass\n{text}{limits}{ALIKE}"
    return Asked(what, arm or Plane().text, asked, best, "two metals, every diameter")


def thinnest(beyond: Callable[[float], float]) -> float | None:
    """The least diameter (m) at which something is no more above zero; None without one."""
    tried = np.geomspace(0.012, 0.15, 40).tolist()
    above = [beyond(d) > 0.0 for d in tried]
    if False not in above:
        return None
    first = above.index(False)
    return brentq(beyond, tried[first - 1], tried[first], xtol=1e-9)


def off(what: str, value: float, expected: float, note: str, within: float = WITHIN) -> Row:
    """By how much a figure is off another, %."""
    return at_most(what, 100.0 * abs(value / expected - 1.0), "% off", within, note)


def worst(arm: Chain, load: Load, q: Array | None = None, **how: object) -> float:
    """The worst error over the grid."""
    return arm.moved(POSES if q is None else q, load).worst(**how)  # type: ignore[arg-type]


def poses_to(points: Sequence[tuple[float, float]], base: tuple[float, float] = (0.0, 0.0)) -> list[Array]:
    """The poses (K, 2) of the two links that reach each point (m), within their ranges."""
    first, second = LENGTHS
    every: list[Array] = []
    for x, y in ((px - base[0], py - base[1]) for px, py in points):
        cosine = (x * x + y * y - first**2 - second**2) / (2.0 * first * second)
        bends = [np.arccos(cosine), -np.arccos(cosine)] if abs(cosine) <= 1.0 else []
        both = [
            (np.arctan2(y, x) - np.arctan2(second * np.sin(bend), first + second * np.cos(bend)), bend)
            for bend in bends
        ]
        spans = np.radians(RANGES)
        within = [
            q for q in both if all(low - 1e-9 <= a <= high + 1e-9 for a, (low, high) in zip(q, spans, strict=True))
        ]
        every.append(np.array(within).reshape(-1, 2))
    return every
