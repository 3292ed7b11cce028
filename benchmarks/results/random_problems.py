"""Whether a scan ever finds a worse pose than an answer's bound allows: python -m benchmarks.results --only scans

Random planar arms of one to three links with backlash, clearance, drives and load cases, each optimised for the least
worst error within a mass; then the error of the answer is scanned over a full grid ten times as fine as that of
`benchmarks.exchange_against_grid`, and over as many random poses: by the error model itself, and by no part of the
search or its certificate. The bound is that of the first-order error, which is what is certified.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.exchange_against_grid import EACH
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.optimize.problem import Problem, read_problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import NoAnswer

FINER = 10
_BLOCK = 200_000


@dataclass(frozen=True)
class Scanned:
    """An answer's bound and the worst pose of the scan (mm); `tight` is the second over the first."""

    seed: int
    links: int
    bound: float | None
    worst: float
    poses: int

    @property
    def tight(self) -> float:
        """The share of the bound that the scan reaches."""
        return float("nan") if self.bound is None else self.worst / self.bound


def random_problem(folder: Path, seed: int) -> Problem:
    """A problem of one to three round or hollow links."""
    generator = np.random.default_rng(seed)
    count = int(generator.integers(1, 4))
    chain = ""
    for _ in range(count):
        low, high = generator.uniform(-150, 0), generator.uniform(10, 150)
        play = f"backlash: {generator.uniform(0.1, 2):.2f} arcmin, " if generator.random() < 0.5 else ""
        play += f"clearance: {generator.uniform(0.01, 0.05):.3f} mm, " if generator.random() < 0.3 else ""
        drive = f"stiffness: {generator.uniform(30, 300):.0f} kN*m/rad, mass: {generator.uniform(1, 5):.1f} kg"
        chain += f"  - joint: {{range: [{low:.0f} deg, {high:.0f} deg], {play}{drive}}}\n"
        size = f"section: {{shape: circle, diameter: {generator.uniform(40, 80):.0f} mm}}"
        chain += f"    link: {{length: {generator.uniform(250, 600):.0f} mm, {size}, material: aluminium-6061-t6}}\n"
    cases = [
        f"{{payload: {{mass: {generator.uniform(0, 4):.1f} kg}}, "
        f"force: [{generator.uniform(-60, 60):.0f} N, {generator.uniform(-60, 60):.0f} N, 0 N]}}"
        for _ in range(int(generator.integers(1, 4)))
    ]
    shape = ("circle", "tube", "rectangle")[int(generator.integers(3))]
    limits = f"mass: '<= {3.0 * count + generator.uniform(0, 8):.1f} kg'"
    sizes = "section_size: [10 mm, 150 mm], thickness: [1 mm, 10 mm]"
    (folder / "arm.yaml").write_text(f"chain:\n{chain}", encoding="utf-8")
    text = f"arm: arm.yaml\nload_cases: [{', '.join(cases)}]\nchoose: {{section: [{shape}]}}\n"
    (folder / "problem.yaml").write_text(f"{text}subject_to: {{{limits}, {sizes}}}\n", encoding="utf-8")
    return read_problem(folder / "problem.yaml")


def scanned(arm: Arm, cases: tuple[LoadCase, ...], seed: int) -> tuple[float, int]:
    """The worst error (m) over the grid and as many random poses, and how many those are."""
    ranges = np.array([joint.range for joint in arm.joints])
    each = FINER * EACH
    model, p = error_model(arm, cases), beam_values(beams_of(arm, cases))
    generator = np.random.default_rng(seed)
    total, worst = each**arm.size, 0.0
    axes = [np.linspace(*pair, each) for pair in ranges]
    for start in range(0, total, _BLOCK):
        numbers = np.unravel_index(np.arange(start, min(start + _BLOCK, total)), (each,) * arm.size)
        grid = np.stack([axis[number] for axis, number in zip(axes, numbers, strict=True)], axis=1)
        random = generator.uniform(ranges[:, 0], ranges[:, 1], grid.shape)
        worst = max(worst, _worst(model.cases, arm, np.vstack([grid, random]), p))
    return worst, 2 * total


def _worst(cases: tuple, arm: Arm, q: Array, p: Array) -> float:  # type: ignore[type-arg]
    results = [played(case.arrays(q, p), case.radii, arm.play, planar=True).error.max() for case in cases]
    return float(max(results))


def run(seed: int) -> Scanned | None:
    """One problem; None where no design keeps its limits."""
    with tempfile.TemporaryDirectory() as folder:
        problem = random_problem(Path(folder), seed)
        try:
            result = optimise(problem)
        except NoAnswer:
            return None
    worst, poses = scanned(result.arm, problem.load_cases, seed)
    bound = result.after.worst.upper_bound
    return Scanned(seed, problem.arm.size, None if bound is None else 1e3 * bound, 1e3 * worst, poses)
