"""How fast, and to which proven gap, the best of millions of combinations is found.

`python -m benchmarks.choice_among_millions` prints a row a problem: combinations, seconds, gap between the best design
and the bound on all combinations and sizes, parts of all designs that were looked at.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from materials.catalogue import load_catalogue
from optimize.choice.at_once.branching import Branching
from optimize.choice.chooser import Chooser
from optimize.choice.picks import count
from optimize.exchange.exchange import context_of
from optimize.problem import Problem, read_problem

JOINT = "{type: revolute, range: [-120 deg, 120 deg], stiffness: 60 kN*m/rad, mass: 3 kg}"
LINK = "{length: %g mm, section: {shape: circle, diameter: 60 mm}, material: aluminium-6061-t6}"
ARM = "chain:\n" + "".join(f"  - {{joint: {JOINT}, link: {LINK % length}}}\n" for length in (400, 420, 420))
SHAPES = "circle, ellipse, rectangle, triangle, i_section, tube, rectangular_tube"
SIZES = "section_size: [20 mm, 120 mm], thickness: [2 mm, 10 mm]"
LIMITS = {
    "mass": f"mass: '<= 6 kg', {SIZES}",
    "mass and cost": f"mass: '<= 10 kg', cost: '<= 200 EUR', {SIZES}",
}


def problem(folder: Path, limits: str, number: int = 30) -> Problem:
    """Three links of seven shapes and so many materials each, within limits."""
    known = [m for m in load_catalogue() if all(m.has(x) for x in ("elastic_modulus", "density", "shear_modulus"))]
    priced = [m.name for m in known if m.has("cost") or "cost" not in limits][:number]
    (folder / "arm.yaml").write_text(ARM + "payload: {mass: 3 kg}\n", encoding="utf-8")
    chosen = f"choose: {{section: [{SHAPES}], material: [{', '.join(priced)}]}}\n"
    path = folder / "problem.yaml"
    path.write_text(f"arm: arm.yaml\n{chosen}subject_to: {{{limits}}}\n", encoding="utf-8")
    return read_problem(path)


def main() -> None:
    """Print the rows."""
    print(f"{'limits':16} {'combinations':>12} {'seconds':>8} {'gap':>8} {'parts':>6}")
    for name, limits in LIMITS.items():
        with tempfile.TemporaryDirectory() as folder:
            asked = problem(Path(folder), limits)
            began = time.perf_counter()
            proof = Branching(Chooser(context_of(asked), None, None), 0.01).run(40)
            seconds = time.perf_counter() - began
            found = ("-", "-") if proof is None else (f"{proof.gap:.2%}", proof.parts)
            print(f"{name:16} {count(asked):12,} {seconds:8.2f} {found[0]:>8} {found[1]:>6}")


if __name__ == "__main__":
    main()
