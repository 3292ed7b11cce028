"""The paper's conventions, for the columns "reproduced" and "as its equations read" and for nothing else.

What the printed figures turn out to be:
- squared distances: equation (29) lost its square root, so they are mm^2 though printed as mm;
- with clearance and backlash taken sqrt(2) times as large (a square's half side and not a disc's radius);
- with angles that are absolute: backlash of joint i turns link i alone;
- plus a deformation whose size at full stretch is two constants fitted to the paper, one for the links' weight
  and one for a tool that it does not print. How it varies with the pose and the design is taken from its equations.

What the equations read: (29) with its root, (22) to (25) without sqrt(2), (30) to (35) for the deformation, no tool.
Where the extraction of (33) leaves it open, the moment on link 2 takes the cosine of link 3, whose weight it is.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import minimize

from linkwright.core.sections.numeric import Array

from .printed import Paper, Parameters

GRAVITY = 9.81
SQUARE = math.sqrt(2.0)
"""The half diagonal of a square over its half side: what the printed clearance and backlash are multiplied by."""


@dataclass(frozen=True)
class Equations:
    """Equations (30) to (35) of the paper as they can be read, for its Table II."""

    parameters: Parameters

    @cached_property
    def area(self) -> float:
        """A, m^2."""
        return 0.25 * math.pi * self.parameters.diameter**2

    @cached_property
    def second_moment(self) -> float:
        """I of the round bar, m^4 (Table II prints d^2/64 for pi d^4/64)."""
        return math.pi * self.parameters.diameter**4 / 64.0

    def deflection(self, angles: Array, *, tool: float = 0.0, density: float | None = None) -> Array:
        """Where the deformation puts the tip (N, 2), m, at absolute link angles (N, 3), rad.

        `tool` is its weight in N, `density` (kg/m^3) replaces that of Table II. Each link bends and stretches by
        itself; the slope of its end turns nothing, as in the paper.
        """
        parameters = self.parameters
        lengths = np.array(parameters.lengths)
        weights = GRAVITY * (parameters.density if density is None else density) * self.area * lengths
        cosines, sines = np.cos(angles), np.sin(angles)
        bending = parameters.elastic_modulus * self.second_moment
        stretching = parameters.elastic_modulus * self.area
        moved = np.zeros((len(angles), 2))
        for link, length in enumerate(parameters.lengths):
            beyond = tool + float(weights[link + 1 :].sum())
            moment = np.zeros(len(angles))
            for other in range(link + 1, 3):
                carried = tool + 0.5 * weights[other] + float(weights[other + 1 :].sum())
                moment += carried * lengths[other] * cosines[:, other]
            shear = (weights[link] / 8.0 + beyond / 3.0) * length**3 * cosines[:, link]
            across = -(shear + 0.5 * moment * length**2) / bending
            along = -(beyond + weights[link]) * sines[:, link] * length / stretching
            moved[:, 0] += along * cosines[:, link] - across * sines[:, link]
            moved[:, 1] += along * sines[:, link] + across * cosines[:, link]
        return moved

    @cached_property
    def weight_sag(self) -> float:
        """What the tip sags by at full stretch without a tool, m: 0.0449 mm, where the figures need 0.0347 mm."""
        return float(np.hypot(*self.deflection(np.zeros((1, 3)))[0]))

    def tool_deflection(self, angles: Array) -> Array:
        """What each newton at the tip adds to the deflection (N, 2), m/N."""
        return self.deflection(angles, tool=1.0, density=0.0)


@dataclass(frozen=True)
class Deformation:
    """The equations' deformation, scaled: `weight` for the links' weight, `tool` the tool's weight in N."""

    equations: Equations
    weight: float = 1.0
    tool: float = 0.0

    def at(self, angles: Array) -> Array:
        """The tip's deflection (N, 2), m, at absolute link angles (N, 3), rad."""
        from_weight = self.weight * self.equations.deflection(angles)
        return from_weight + self.tool * self.equations.tool_deflection(angles) if self.tool else from_weight

    def worst_with(self, backlash: Sequence[float]) -> float:
        """The largest distance over all poses (m) where links turn by `backlash` (rad, three, signed) as well."""
        lengths = self.equations.parameters.lengths
        swing = np.array([length * turn for length, turn in zip(lengths, backlash, strict=True)])

        def distance(angles: Array) -> Array:
            shift = np.stack([-np.sin(angles) @ swing, np.cos(angles) @ swing], axis=1) + self.at(angles)
            return np.hypot(shift[:, 0], shift[:, 1])

        def nearness(angles: Array) -> float:
            return -1e6 * float(distance(angles[None])[0])

        grid = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
        starts = np.array(list(itertools.product(grid, repeat=3)))
        values = distance(starts)
        best = 0.0
        for start in starts[np.argsort(-values)[:8]]:
            minimum = minimize(nearness, start, method="Nelder-Mead")
            best = max(best, -1e-6 * float(minimum.fun))
        return best


@dataclass(frozen=True)
class Reading:
    """Distances (m) of the paper's tables by one reading of its equations.

    `scale` is what play is multiplied by; `weight_sag` and `tool_sag` (m) are the deformation's two parts at full
    stretch, `deformation` the same at any pose.
    """

    paper: Paper
    scale: float
    weight_sag: float
    tool_sag: float
    deformation: Deformation

    @property
    def sag(self) -> float:
        """The deformation at full stretch, m."""
        return self.weight_sag + self.tool_sag

    def play(self, joints: Sequence[int], *, backlash: bool) -> tuple[float, float]:
        """Tables III and IV without and with deformation: the distances of all joints with play simply add up."""
        lengths = self.paper.parameters.lengths
        arms = [lengths[joint - 1] for joint in joints]
        size = self.paper.backlash_size * sum(arms) if backlash else self.paper.clearance_size * len(joints)
        return self.scale * size, self.scale * size + self.sag

    def direction(self, signs: Sequence[int]) -> tuple[float, float]:
        """Table V without and with deformation: the largest over all poses for these signs. With absolute angles some
        pose lines up the links' swings whatever their signs."""
        turns = [self.scale * self.paper.backlash_size * sign for sign in signs]
        swings = zip(turns, self.paper.parameters.lengths, strict=True)
        return sum(abs(turn) * length for turn, length in swings), self.deformation.worst_with(turns)

    def material(self, modulus: float, density: float) -> float:
        """Table VI: the links' part goes with density over modulus, the tool's with 1 over modulus."""
        parameters = self.paper.parameters
        softer = parameters.elastic_modulus / modulus
        return softer * (self.tool_sag + self.weight_sag * density / parameters.density)

    def shape(self, second_moment: float) -> float:
        """Table VII: pure bending, which goes with I of the circle over I (m^4)."""
        return self.sag * self.deformation.equations.second_moment / second_moment


@dataclass(frozen=True)
class Conventions:
    """The paper's conventions on its data: printed figures (mm^2) out of Table II and the two fitted constants."""

    paper: Paper

    @cached_property
    def equations(self) -> Equations:
        """The equations as they read."""
        return Equations(self.paper.parameters)

    @cached_property
    def fitted(self) -> Deformation:
        """The equations' deformation, scaled so that its two parts have the fitted sizes at full stretch."""
        per_newton = float(np.hypot(*self.equations.tool_deflection(np.zeros((1, 3)))[0]))
        return Deformation(
            self.equations, self.paper.weight_sag / self.equations.weight_sag, self.paper.tool_sag / per_newton
        )

    @cached_property
    def printed(self) -> Reading:
        """What the printed figures turn out to be; they are the squares of these distances."""
        return Reading(self.paper, SQUARE, self.paper.weight_sag, self.paper.tool_sag, self.fitted)

    @cached_property
    def as_read(self) -> Reading:
        """As the equations read: with a root and without sqrt(2), no tool, nothing fitted."""
        return Reading(self.paper, 1.0, self.equations.weight_sag, 0.0, Deformation(self.equations))


def squared(distance: Any) -> Any:
    """What the paper prints for a distance (m), or an array of them: the square, mm^2."""
    return (1e3 * distance) ** 2


def printed_second_moment(shape: str, dimensions: Mapping[str, float], *, misprint: bool = False) -> float:
    """I (m^4) that Table VII's figure of a shape needs; with `misprint` by the formula that it prints.

    They differ for the triangle alone: b h^3/36 (about the centroid) fits its figure, b h^3/12 is printed.
    """
    width = dimensions.get("width", 0.0)
    height = dimensions.get("height", dimensions.get("diameter", 0.0))
    if shape == "circle":
        return math.pi * height**4 / 64.0
    if shape == "ellipse":
        return math.pi * width * height**3 / 64.0
    if shape == "rectangle":
        return width * height**3 / 12.0
    if shape == "triangle":
        return width * height**3 / (12.0 if misprint else 36.0)
    hole = height - 2.0 * dimensions["flange_thickness"]
    return (width * height**3 - (width - dimensions["web_thickness"]) * hole**3) / 12.0
