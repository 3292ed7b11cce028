"""Problems of millions of combinations, and what the command comes to on one of them."""

from __future__ import annotations

import json
import math
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.materials.material import PropertyName
from linkwright.core.optimize.problem import Problem, read_problem

JOINT = "{type: revolute, range: [-120 deg, 120 deg], stiffness: 60 kN*m/rad, mass: 3 kg}"
LINK = "{length: %g mm, section: {shape: circle, diameter: 60 mm}, material: aluminium-6061-t6}"
ARM = "chain:\n" + "".join(f"  - {{joint: {JOINT}, link: {LINK % length}}}\n" for length in (400, 420, 420))
SHAPES = "circle, ellipse, rectangle, triangle, i_section, tube, rectangular_tube"
SIZES = "section_size: [20 mm, 120 mm], thickness: [2 mm, 10 mm]"
LIMITS = {
    "mass": f"mass: '<= 6 kg', {SIZES}",
    "mass and cost": f"mass: '<= 10 kg', cost: '<= 200 EUR', {SIZES}",
}
_ALWAYS: tuple[PropertyName, ...] = ("elastic_modulus", "density", "shear_modulus")
_ASKED: dict[str, PropertyName] = {"cost": "cost", "safety_factor": "yield_strength"}
"""Properties that materials need, and those that limits ask for."""
_ALL = f"mass: '<= 10 kg', cost: '<= 200 EUR', safety_factor: '>= 2', first_frequency: '>= %g Hz', {SIZES}"
COMMANDS = {
    "mass, cost, strength and 5 Hz": _ALL % 5.0,
    "mass, cost, strength and 11 Hz, near the 12.3 Hz of the drives": _ALL % 11.0,
}
"""Limits that `linkwright optimize` is run with."""

_METALS = "aluminium-6061-t6, aluminium-6082-t6, aluminium-7075-t6, aluminium-2024-t3, steel-s235, steel-s355"
_FIBRES = "gfrp-quasi-isotropic, gfrp-unidirectional, cfrp-quasi-isotropic, cfrp-unidirectional"
_DIAMETERS, _WALLS = "{from: 30 mm, to: 125 mm, step: 5 mm}", "{from: 1.5 mm, to: 8.5 mm, step: 0.5 mm}"
TUBES = (
    f"choose: {{section: [tube], material: [{_METALS}, {_FIBRES}], "
    f"sizes: {{diameter: {_DIAMETERS}, thickness: {_WALLS}}}}}\n"
    "subject_to: {mass: '<= 6 kg', cost: '<= 60 EUR', reach: == 1240 mm, link_length: [200 mm, 700 mm], "
    "wall_slenderness: off}\n"
)


@dataclass(frozen=True)
class Answer:
    """What the command came to: worst error (mm), gap (infinite where none was proven), seconds of CPU and by the
    wall, combinations."""

    error: float
    gap: float
    cpu: float
    seconds: float
    combinations: int


def commanded(made: Callable[[Path], Problem]) -> Answer:
    """A problem, made in a folder, solved by the command as anybody runs it, with nothing set."""
    with tempfile.TemporaryDirectory() as folder:
        asked = made(Path(folder))
        told = Path(folder) / "result.json"
        command = [sys.executable, "-m", "linkwright", "optimize", str(asked.file), "--json", str(told)]
        before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        seconds, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        result = json.loads(told.read_text(encoding="utf-8"))
    gap = math.inf if result["combinations_gap"] is None else float(result["combinations_gap"])
    return Answer(float(result["max_error_mm"]), gap, cpu, seconds, int(result["combinations"]))


def listed(folder: Path) -> Problem:
    """Three links of 300 tubes of ten materials each, whose lengths are free but for their sum."""
    (folder / "arm.yaml").write_text(ARM.replace("60 kN", "600 kN") + "payload: {mass: 5 kg}\n", encoding="utf-8")
    path = folder / "problem.yaml"
    path.write_text(f"arm: arm.yaml\n{TUBES}", encoding="utf-8")
    return read_problem(path)


def problem(folder: Path, limits: str, number: int = 30) -> Problem:
    """Three links of seven shapes and so many materials each, within limits."""
    wanted: list[PropertyName] = [*_ALWAYS, *(key for limit, key in _ASKED.items() if limit in limits)]
    names = [item.name for item in load_catalogue() if all(item.has(key) for key in wanted)][:number]
    (folder / "arm.yaml").write_text(ARM + "payload: {mass: 3 kg}\n", encoding="utf-8")
    chosen = f"choose: {{section: [{SHAPES}], material: [{', '.join(names)}]}}\n"
    path = folder / "problem.yaml"
    path.write_text(f"arm: arm.yaml\n{chosen}subject_to: {{{limits}}}\n", encoding="utf-8")
    return read_problem(path)
