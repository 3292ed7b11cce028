"""Free lengths where a path or a box stays where it is: held against a search over lengths and sizes with formulas of
its own (E. Oberg et al., Machinery's Handbook: a cantilever under an end force, an end moment and its own weight)."""

from __future__ import annotations

import itertools
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.optimize.problem import read_problem
from linkwright.core.optimize.run import optimise
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import NoAnswer

E, RHO, GRAVITY = 70e9, 2700.0, 9.81


@dataclass(frozen=True)
class Rods:
    """Two round rods in a vertical plane whose joints turn as far as they like: places to reach (m), what the tip
    carries (kg) and pushes with (N), the second joint's mass, the joints' stiffnesses (N m/rad), ranges of lengths and
    diameters (m), the greatest mass (kg), the lengths' sum where it is fixed."""

    places: Array
    payload: float
    force: tuple[float, float]
    joint: float
    stiffness: tuple[float, float]
    lengths: tuple[float, float]
    sizes: tuple[float, float]
    mass: float
    total: float | None = None

    def error(self, L: Array, d: Array) -> Array:
        """The worst error (m) of designs L (N, 2), d (N, 2); infinite where a place is not reached."""
        area, second = math.pi * d**2 / 4.0, math.pi * d**4 / 64.0
        weight = RHO * area * GRAVITY
        r2 = (self.places**2).sum(axis=1)
        cosine = (r2[None] - (L**2).sum(axis=1)[:, None]) / (2.0 * L[:, :1] * L[:, 1:])
        missed = (np.abs(cosine) > 1.0 + 1e-9).any(axis=1)
        bend = np.arccos(np.clip(cosine, -1.0, 1.0))
        worst = np.zeros(len(L))
        for side in (1.0, -1.0):
            q2 = side * bend
            q1 = np.arctan2(self.places[:, 1], self.places[:, 0])[None]
            q1 = q1 - np.arctan2(L[:, 1:] * np.sin(q2), L[:, :1] + L[:, 1:] * np.cos(q2))
            tip = np.zeros((*q2.shape, 2))
            moment: Array | float = 0.0
            fx: Array | float = self.force[0]
            fy: Array | float = self.force[1] - self.payload * GRAVITY
            arm = np.zeros((*q2.shape, 2))
            for k, angle in ((1, q1 + q2), (0, q1)):
                along = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
                across = np.stack([-along[..., 1], along[..., 0]], axis=-1)
                span, ei, ea = L[:, k : k + 1], E * second[:, k : k + 1], E * area[:, k : k + 1]
                w = weight[:, k : k + 1]
                ft, fn = fx * across[..., 0] + fy * across[..., 1], fx * along[..., 0] + fy * along[..., 1]
                wt, wn = -w * across[..., 1], -w * along[..., 1]
                sag = (ft * span**3 / 3.0 + moment * span**2 / 2.0 + wt * span**4 / 8.0) / ei
                turn = (ft * span**2 / 2.0 + moment * span + wt * span**3 / 6.0) / ei
                pull = (fn * span + wn * span**2 / 2.0) / ea
                moment = moment + ft * span + wt * span**2 / 2.0
                swung = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
                tip = tip + sag[..., None] * across + pull[..., None] * along + turn[..., None] * swung
                arm = arm + span[..., None] * along
                if self.stiffness[k]:
                    swung = np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
                    tip = tip + (moment / self.stiffness[k])[..., None] * swung
                fy = fy - w * span - (self.joint * GRAVITY if k == 1 else 0.0)
            worst = np.maximum(worst, np.hypot(tip[..., 0], tip[..., 1]).max(axis=1))
        return np.where(missed, np.inf, worst)

    def best(self, steps: int = 17, rounds: int = 6) -> tuple[float, Array]:
        """The least worst error (m) that a grid finds which closes in on the best of several, and that design."""
        low = np.array([*[self.lengths[0]] * 2, *[math.log(self.sizes[0])] * 2])
        high = np.array([*[self.lengths[1]] * 2, *[math.log(self.sizes[1])] * 2])
        result, grids = (math.inf, low), [(low, high)]
        for number in range(rounds):
            ends: list[tuple[float, Array, Array]] = []
            for a, b in grids:
                axes = [np.linspace(x, y, steps if number == 0 else 7) for x, y in zip(a, b, strict=True)]
                if self.total is not None:
                    axes[1] = np.array([0.0])
                x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 4)
                if self.total is not None:
                    x[:, 1] = self.total - x[:, 0]
                L, d = x[:, :2], np.exp(x[:, 2:])
                kept = (self.lengths[0] - 1e-12 <= L).all(axis=1) & (self.lengths[1] + 1e-12 >= L).all(axis=1)
                kept &= (RHO * math.pi / 4.0 * d**2 * L).sum(axis=1) <= self.mass
                values = np.full(len(x), np.inf)
                for part in np.array_split(np.flatnonzero(kept), 1 + int(kept.sum()) // 20000):
                    values[part] = self.error(L[part], d[part])
                step, several = (b - a) / (len(axes[0]) - 1), 400 if number == 0 else 1
                ends += [(float(values[best]), x[best], step) for best in np.argsort(values)[:several]]
            ends.sort(key=lambda end: end[0])
            if not ends or not math.isfinite(ends[0][0]):
                return result
            if ends[0][0] < result[0]:
                result = ends[0][:2]
            apart: list[tuple[float, Array, Array]] = []
            for item in ends:
                if len(apart) < 4 and all(np.abs(item[1][:2] - x[:2]).max() > 0.05 for _, x, _ in apart):
                    apart.append(item)
            wide = 1.0 if number < 2 else 0.7
            grids = [(np.maximum(x - wide * step, low), np.minimum(x + wide * step, high)) for _, x, step in apart]
        return result

    def write(self, folder: Path, workspace: str, given: tuple[float, float]) -> Path:
        """The problem as a file; `given` are the arm's own lengths (m)."""
        keys = [f", stiffness: {k} N*m/rad" if k else "" for k in self.stiffness]
        keys[1] += f", mass: {self.joint} kg" if self.joint else ""
        links = "".join(
            f"  - joint: {{type: revolute, range: [-180 deg, 180 deg]{key}}}\n"
            f"    link: {{length: {1e3 * length} mm, section: {{shape: circle, diameter: {500 * sum(self.sizes)} mm}},"
            f" material: {{elastic_modulus: {E / 1e9} GPa, poisson_ratio: 0.3, density: {RHO} kg/m^3}}}}\n"
            for key, length in zip(keys, given, strict=True)
        )
        (folder / "arm.yaml").write_text(f"leave_out: [shear_deformation]\nchain:\n{links}")
        reach = "" if self.total is None else f", reach: '== {1e3 * self.total} mm'"
        low, high = (1e3 * length for length in self.lengths)
        small, large = (1e3 * size for size in self.sizes)
        (folder / "problem.yaml").write_text(
            f"arm: arm.yaml\nworkspace: {workspace}\nload_cases:\n"
            f"  - {{payload: {{mass: {self.payload} kg}}, force: [{self.force[0]} N, {self.force[1]} N, 0 N]}}\n"
            f"subject_to: {{mass: '<= {self.mass} kg'{reach}, link_length: [{low} mm, {high} mm], "
            f"section_size: [{small} mm, {large} mm]}}\nchoose: {{section: [circle]}}\n"
        )
        return folder / "problem.yaml"


def path(*points: tuple[float, float], count: int = 41) -> tuple[Array, str]:
    """Places (m) along a path, and its words."""
    pieces = [np.linspace(a, b, count) for a, b in itertools.pairwise(points)]
    words = ", ".join(f"[{1e3 * x} mm, {1e3 * y} mm]" for x, y in points)
    return np.vstack(pieces), f"{{path: [{words}]}}"


def test_the_long_link_may_be_the_second(tmp_path: Path) -> None:
    """The ends of the path lie so that either link may be the long one; what is in between does not reach it."""
    places, words = path((0.1722, 0.416), (0.3645, 0.3513))
    rods = Rods(places, 5.35, (0.0, 0.0), 1.884, (119426.0, 0.0), (0.15, 1.0), (0.005, 0.131), 12.0, 0.874)
    known, _ = rods.best()
    result = optimise(read_problem(rods.write(tmp_path, words, (0.608, 0.266))))
    assert result.objective <= known * (1.0 + 1e-3)
    lengths = np.array([result.arm.lengths])
    sizes = np.array([[link.section.diameter for link in result.arm.links]])  # type: ignore[union-attr]
    assert rods.error(lengths * (1.0 + 1e-10), sizes)[0] == pytest.approx(result.objective, rel=1e-3)


@pytest.mark.slow
def test_an_arm_too_short_is_given_lengths_that_reach(tmp_path: Path) -> None:
    """Stretched out, the rods as given end 160 mm before the end of the path, from hypot(350, 500) mm."""
    places, words = path((0.55, 0.25), (0.35, 0.5))
    rods = Rods(places, 2.0, (0.0, 0.0), 1.0, (50000.0, 0.0), (0.12, 0.7), (0.01, 0.1), 6.0)
    known, _ = rods.best(9)
    result = optimise(read_problem(rods.write(tmp_path, words, (0.2, 0.25))))
    assert result.objective <= known * (1.0 + 1e-3)
    assert result.start is not None
    assert "of the path cannot be reached (at (350, 500) mm the tip stays 160 mm away)" in result.start
    assert sum(result.before.arm.lengths) >= math.hypot(0.35, 0.5)
    assert result.before.max_error >= result.objective


@pytest.mark.slow
def test_where_no_lengths_reach_it_is_said_what_is_short(tmp_path: Path) -> None:
    places, words = path((0.55, 0.25), (0.35, 0.5))
    rods = Rods(places, 2.0, (0.0, 0.0), 1.0, (0.0, 0.0), (0.12, 0.3), (0.01, 0.1), 6.0)
    short = 1e3 * (math.hypot(0.35, 0.5) - 0.6)
    text = rf"300 and 300 mm, keep the tip {short:.4g} mm away from \(350, 500\) mm"
    text += r"; links of ([\d.]+) and ([\d.]+) mm would"
    with pytest.raises(NoAnswer, match=text) as caught:
        optimise(read_problem(rods.write(tmp_path, words, (0.2, 0.25))))
    result = re.search(text, str(caught.value))
    assert result is not None
    assert sum(map(float, result.groups())) >= 1e3 * math.hypot(0.35, 0.5) - 1.0
