"""Random problems with few designs, each of which is evaluated: what is said by link, by material and by load case.

Two kinds: sections from lists, and shapes and materials whose dimensions stay. Limits lie between the figures of two of
the designs, so that some keep them and some do not, and none is near.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.evaluation import Evaluation, evaluate
from linkwright.core.materials.material import Material
from linkwright.core.optimize.problem import Problem
from linkwright.core.optimize.result import OptimizationResult
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import SHAPES, Section
from linkwright.core.units.quantities import NoAnswer
from tests.optimize.builders import problem_of

WITHIN = 2e-4
"""The exchange's tolerance and the certificates' gaps, relative."""
METALS = ("aluminium-6061-t6", "steel-s355", "titanium-ti-6al-4v")
SHAPES_DRAWN = ("circle", "tube", "rectangular_tube")
SUMS = ("max_error", "mass", "total_mass", "cost")
BEST_MOST = ("first_frequency", "safety_factor", "tip_stiffness")
BEST_LEAST = ("average_error", "aspect", *SUMS)


@dataclass(frozen=True)
class Design:
    """An arm with one section and material for each link, and its evaluation over the workspace and all loads, and
    under each load alone."""

    arm: Arm
    options: tuple[tuple[Section, Material], ...]
    whole: Evaluation
    by_case: tuple[float, ...]

    def figure(self, problem: Problem, name: str) -> float:
        value = problem.figures[name].value(self.whole)
        return math.nan if value is None else value


@dataclass(frozen=True)
class Drawn:
    """A problem, every design that it could have, and those of them that keep its limits."""

    problem: Problem
    designs: tuple[Design, ...]
    keeping: tuple[Design, ...]

    @property
    def best(self) -> float:
        """The least badness of the objective among designs that keep all limits; infinite without one."""
        figure = self.problem.objective
        values = (figure.badness(item.figure(self.problem, figure.name)) for item in self.keeping)
        return min(values, default=math.inf)


def _arm_text(random: np.random.Generator, links: int, *, play: bool) -> str:
    chain = ""
    for _ in range(links):
        low, high = random.uniform(30, 110, 2)
        drive = f"stiffness: {random.uniform(15, 90):.1f} kN*m/rad, mass: {random.uniform(0.5, 3):.1f} kg, cost: 90 EUR"
        lost = f", backlash: {random.uniform(0.3, 2):.2f} arcmin" if play else ""
        chain += f"  - joint: {{range: [{-low:.0f} deg, {high:.0f} deg], {drive}{lost}}}\n"
        section = f"{{shape: tube, diameter: {random.uniform(40, 60):.0f} mm, thickness: 3 mm}}"
        chain += f"    link: {{length: {random.uniform(220, 480):.0f} mm, section: {section}, material: {METALS[0]}}}\n"
    return f"chain:\n{chain}payload: {{mass: {random.uniform(2, 9):.1f} kg}}\n"


def _workspace_text(random: np.random.Generator, folder: Path, links: int) -> str:
    kind = int(random.integers(3))
    if kind == 0:
        return ""
    q = random.uniform(-30, 30, (int(random.integers(2, 6)), links))
    if kind == 1:
        rows = [", ".join(f"{x:.1f}" for x in row) + f", {random.uniform(0.5, 4):.2f}" for row in q]
        heading = ", ".join(f"q{k}_deg" for k in range(1, links + 1))
        (folder / "poses.csv").write_text("\n".join([f"{heading}, weight", *rows]) + "\n", encoding="utf-8")
        return "workspace: {poses: poses.csv}\n"
    listed = ", ".join("[" + ", ".join(f"{x:.1f} deg" for x in row) + "]" for row in q)
    return f"workspace: {{poses: [{listed}]}}\n"


def _chosen(random: np.random.Generator, names: Sequence[str], most: int) -> list[str]:
    return [str(item) for item in random.choice(names, int(random.integers(1, most + 1)), replace=False)]


def _by_link(values: Sequence[str]) -> str:
    """Said by link, or once where all are alike; the last of them as what the others have."""
    if len(set(values)) == 1:
        return values[0]
    last = [number for number, value in enumerate(values, start=1) if value != values[-1]]
    said = [f"{number}: {values[number - 1]}" for number in last]
    return "{" + ", ".join([*said, f"others: {values[-1]}"]) + "}"


def drawn(folder: Path, seed: int, *, listed: bool, links: int = 2, few: bool = False) -> Drawn:
    """A random problem with sections from lists, or with shapes and materials to choose."""
    random = np.random.default_rng([47, seed, listed, links])
    arm = _arm_text(random, links, play=bool(random.random() < 0.5))
    most = 1 if few else 2
    own = [_chosen(random, SHAPES_DRAWN, most) for _ in range(links)]
    shapes = _by_link([f"[{', '.join(item)}]" for item in own])
    stuffs = _by_link([f"[{', '.join(_chosen(random, METALS, 2))}]" for _ in range(links)])
    same = ", same: [material]" if stuffs.startswith("[") and random.random() < 0.3 else ""
    loads = [f"payload: {{mass: {random.uniform(1, 9):.2f} kg}}" for _ in range(int(random.integers(1, 3)))]
    loads = [f"{load}, force: [{random.uniform(-40, 40):.0f} N, 0 N, 0 N]" for load in loads]
    space = _workspace_text(random, folder, links)
    sizes, ranges = "", ""
    if listed:
        values = {
            "diameter": sorted({round(x) for x in (*random.uniform(35, 80, 1 if few else 2), 50)}),
            "width": [round(random.uniform(42, 60))],
            "height": [round(random.uniform(42, 60))],
            "thickness": [3] if few else [2, 4],
        }
        kinds = dict.fromkeys(shape for item in own for shape in item)
        used = dict.fromkeys(
            dimension.name for shape in kinds for dimension in SHAPES[shape].dimensions if dimension.name in values
        )
        told = [f"{name}: [{', '.join(f'{x} mm' for x in values[name])}]" for name in used]
        sizes = f", sizes: {{{', '.join(told)}}}"
        spans = [f"[{random.uniform(20, 40):.0f} mm, {random.uniform(62, 110):.0f} mm]" for _ in range(links)]
        ranges = f"section_size: {_by_link(spans)}"
    else:
        spans, walls = ([f"{x:.1f} mm" for x in random.uniform(*pair, links)] for pair in ((40, 75), (2, 6)))
        ranges = f"section_size: {_by_link([f'[{x}, {x}]' for x in spans])}"
        ranges += f", thickness: {_by_link([f'[{x}, {x}]' for x in walls])}"
    choose = f"choose: {{section: {shapes}, material: {stuffs}{same}{sizes}}}\n"

    def asked(aim: str, limits: Mapping[str, str], cases: Sequence[str]) -> Problem:
        text = "".join(f"  - {{{case}}}\n" for case in cases)
        held = ", ".join([ranges, *(f"{name}: {value}" for name, value in limits.items())])
        return problem_of(folder, arm, f"{aim}\nload_cases:\n{text}{space}{choose}subject_to: {{{held}}}\n")

    # Nothing is looked for under this: it says which designs there are.
    open_problem = asked("maximize: tip_stiffness" if not listed else "minimize: max_error", {}, loads)
    designs = tuple(_designs(open_problem, listed=listed))
    aim = str(random.choice(SUMS if listed else (*BEST_MOST, *BEST_LEAST)))
    limits, by_case = _limits(random, open_problem, designs, aim)
    cases = [
        load if most is None else f"{load}, subject_to: {{max_error: '<= {most:.9f} mm'}}"
        for load, most in zip(loads, by_case, strict=True)
    ]
    verb = "maximize" if aim in BEST_MOST else "minimize"
    problem = asked(f"{verb}: {aim}", limits, cases)
    return Drawn(problem, designs, tuple(design for design in designs if keeps(problem, design)))


def _designs(problem: Problem, *, listed: bool) -> list[Design]:
    """Every design, evaluated."""
    options: list[list[tuple[Section, Material]]] = []
    for link, ranges in enumerate(problem.ranges):
        sections = (
            [size.section for size in problem.sizes[link]]
            if listed and problem.sizes is not None
            else [SHAPES[shape].start(1.0, *ranges.sizes) for shape in problem.shapes_of(link)]
        )
        options.append(list(itertools.product(sections, problem.materials_of(link))))
    designs: list[Design] = []
    for pick in itertools.product(*options):
        if "material" in problem.same and len({material.name for _, material in pick}) > 1:
            continue
        parts = zip(problem.arm.links, pick, strict=True)
        links = tuple(
            replace(link, section=section, material=material, section_name=None) for link, (section, material) in parts
        )
        arm = problem.arm.with_links(links)
        whole = evaluate(arm, problem.workspace, problem.load_cases)
        alone = [evaluate(arm, problem.workspace, (case,)).max_error for case in problem.load_cases]
        designs.append(Design(arm, pick, whole, tuple(alone)))
    return designs


def _between(random: np.random.Generator, values: Sequence[float], *, above: bool) -> float | None:
    """A value between two of some that differ, so that from half to all but one of them keep it."""
    known = sorted(x for x in values if math.isfinite(x) and x > 0.0)
    gaps = [0.5 * (a + b) for a, b in itertools.pairwise(known) if b > a * (1.0 + 2e-3)]
    if not gaps:
        return None
    at = int(random.integers(len(gaps) // 2, len(gaps)))
    return gaps[-1 - at] if above else gaps[at]


def _limits(
    random: np.random.Generator, problem: Problem, designs: Sequence[Design], aim: str
) -> tuple[dict[str, str], list[float | None]]:
    limits: dict[str, str] = {"local_buckling": "off"}

    def of(name: str) -> list[float]:
        return [design.figure(problem, name) for design in designs]

    for name, unit, share in (
        ("mass", "kg", 0.5),
        ("cost", "EUR", 0.3),
        ("max_error", "mm", 0.4),
        ("average_error", "mm", 0.4),
    ):
        most = _between(random, of(name), above=False)
        if name != aim and most is not None and random.random() < share:
            limits[name] = f"'<= {most * problem.figures[name].factor:.9f} {unit}'"
    least = _between(random, of("first_frequency"), above=True)
    if random.random() < 0.3 and least is not None and aim != "first_frequency":
        limits["first_frequency"] = f"'>= {least:.9f} Hz'"
    if random.random() < 0.6 and aim != "safety_factor":
        limits |= _safety(random, problem, designs)
    if random.random() < 0.5:
        sections = ([design.options[link][0] for design in designs] for link in range(problem.arm.size))
        widths = [[float(section.inner_diameter or 0.0) for section in item] for item in sections]
        rooms = [_between(random, width, above=True) or 0.5 * min(width) for width in widths]
        if all(rooms):
            limits["inner_size"] = _by_link([f"'>= {1e3 * room:.6f} mm'" for room in rooms])
    by_case = [
        _between(random, [design.by_case[k] for design in designs], above=False) if random.random() < 0.4 else None
        for k in range(len(problem.load_cases))
    ]
    costly = {"max_error", "average_error", "safety_factor", "first_frequency"}
    if not costly & set(limits) and aim in ("mass", "total_mass", "cost", "aspect"):
        most = _between(random, of("max_error"), above=False)
        limits["max_error"] = f"'<= {1e3 * (most or 1.0):.9f} mm'"
    return limits, [None if item is None else 1e3 * item for item in by_case]


def _safety(random: np.random.Generator, problem: Problem, designs: Sequence[Design]) -> dict[str, str]:
    """A limit on the safety factor, once, by link or by material."""
    factors = np.array([[float(x or 0.0) for x in design.whole.strength.safety_factor] for design in designs])
    kind = int(random.integers(3))
    if kind == 0:
        least = _between(random, factors.min(axis=1).tolist(), above=True)
        return {} if least is None else {"safety_factor": f"'>= {least:.9f}'"}
    if kind == 1:
        by_link = [_between(random, factors[:, k].tolist(), above=True) for k in range(problem.arm.size)]
        said = [f"'>= {item or 1e-3:.9f}'" for item in by_link]
        return {"safety_factor": _by_link(said)}
    made_of = np.array([[material.name for _, material in design.options] for design in designs])
    names = sorted(set(made_of.ravel().tolist()))
    said = [
        f"{name}: '>= {_between(random, factors[made_of == name].tolist(), above=True) or 1e-3:.9f}'"
        for name in names[1:]
    ]
    rest = _between(random, factors[made_of == names[0]].tolist(), above=True) or 1e-3
    return {"safety_factor": "{" + ", ".join([*said, f"others: '>= {rest:.9f}'"]) + "}" if said else f"'>= {rest:.9f}'"}


def keeps(problem: Problem, design: Design) -> bool:
    """Whether a design keeps all limits of a problem, each read off the evaluation by its own rule."""
    factors = design.whole.strength.safety_factor
    for limit in problem.limits:
        if limit.aim:
            continue
        if limit.name.startswith("max_error of load case "):
            kept = design.by_case[int(limit.name.rpartition(" ")[2]) - 1] <= limit.value
        elif limit.name == "safety_factor":
            kept = all(
                float(own or 0.0) >= _due(limit.demands, limit.value, link, material)
                for link, (own, (_, material)) in enumerate(zip(factors, design.options, strict=True))
            )
        elif limit.name == "inner_size":
            kept = all(
                float(section.inner_diameter or 0.0) >= _due(limit.demands, limit.value, link, material)
                for link, (section, material) in enumerate(design.options)
            )
        else:
            value = design.figure(problem, limit.name)
            kept = value <= limit.value if limit.relation == "<=" else value >= limit.value
        if not kept:
            return False
    return True


def _due(demands: object, value: float, link: int, material: Material) -> float:
    """What a limit asks of a link, by what it says of links and materials."""
    if demands is None:
        return value
    if demands.links:  # type: ignore[attr-defined]
        return demands.links[link]  # type: ignore[attr-defined,no-any-return]
    return dict(demands.materials).get(material.name, value)  # type: ignore[attr-defined,no-any-return]


def held(case: Drawn) -> OptimizationResult | None:
    """Hold the tool's answer against all designs; None where there is none, as none keeps the limits."""
    try:
        result = optimise(case.problem)
    except NoAnswer:
        assert not case.keeping
        return None
    figure, best = case.problem.objective, case.best
    assert result.doubts == ()
    assert case.keeping
    found = figure.badness(result.objective)
    bound = figure.badness(result.lower_bound) if result.lower_bound else 0.0
    # Designs of the lists alone count; what a bound says of them holds.
    assert found >= best * (1.0 - WITHIN)
    assert bound <= best * (1.0 + WITHIN)
    gap = 0.0 if result.gap is None else result.gap
    if result.optimum == "global" or not result.listed:
        assert found <= best * (1.0 + WITHIN + gap)
    elif result.gap is not None:
        assert found <= best * (1.0 + WITHIN) / (1.0 - gap)
    return result
