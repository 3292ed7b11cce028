"""Height and width of sections are limited apart, by link too: against bisection, and every shape's own outline."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.figures import FIGURES, OfLinks
from linkwright.core.optimize.run import optimise
from linkwright.core.sections import SHAPES
from linkwright.core.units.quantities import InputError
from tests.optimize.builders import problem_of

ARM = """\
chain:
  - joint: {type: revolute, range: [-90 deg, 90 deg]}
    link: {length: 400 mm, section: {shape: rectangle, width: 30 mm, height: 60 mm}, material: aluminium-6061-t6}
  - joint: {type: revolute, range: [-90 deg, 90 deg]}
    link: {length: 300 mm, section: {shape: rectangle, width: 30 mm, height: 60 mm}, material: aluminium-6061-t6}
payload: {mass: 3 kg}
"""
CHOOSE = "choose: {section: [rectangle]}\n"


@pytest.mark.parametrize("shape", sorted(name for name, kind in SHAPES.items() if kind.variables))
def test_height_and_width_are_those_of_the_outline(shape: str) -> None:
    """Of a symmetric one; those of a regular polygon across flats, as it stands."""
    kind = SHAPES[shape]
    section = kind.start(8e-4, (0.02, 0.12), (0.002, 0.01))
    outline = np.vstack(section.outline())
    for name, axis in (("section_height", 1), ("section_width", 0)):
        follows = FIGURES[name].follows
        assert isinstance(follows, OfLinks)
        (value,) = follows.values(section, None) or (None,)  # type: ignore[arg-type]
        assert value == pytest.approx(float(np.ptp(outline[:, axis])), rel=1e-3)


def test_a_height_binds_and_the_width_makes_up_for_it(tmp_path: Path) -> None:
    """The lightest rectangle for an error is as high as it may be; its price is that of a bisection's neighbour."""

    def lightest(height: float) -> float:
        text = f"minimize: mass\nsubject_to: {{max_error: '<= 0.3 mm', section_height: '<= {height} mm'}}\n"
        result = optimise(problem_of(tmp_path, ARM, text + CHOOSE))
        assert FIGURES["section_height"].value(result.after) == pytest.approx(1e-3 * height, rel=1e-6)
        prices.append(next(item.price for item in result.binding if item.name == "section_height"))
        return result.objective

    prices: list[float | None] = []
    lower, higher = lightest(70.0), lightest(70.7)
    assert prices[0] is not None
    assert abs(prices[0]) == pytest.approx((lower - higher) / 0.7, rel=0.05)


def test_each_link_has_its_own_width(tmp_path: Path) -> None:
    text = "minimize: mass\nsubject_to: {max_error: '<= 0.3 mm', section_height: {1: '<= 60 mm', 2: '<= 40 mm'},\n"
    text += "  section_width: '<= 50 mm'}\n"
    result = optimise(problem_of(tmp_path, ARM, text + CHOOSE))
    sections = [link.section.given() for link in result.arm.links if link.section is not None]
    assert sections[0]["height"] <= 0.06 * (1.0 + 1e-9)
    assert sections[1]["height"] <= 0.04 * (1.0 + 1e-9)
    assert max(section["width"] for section in sections) <= 0.05 * (1.0 + 1e-9)


def test_a_height_from_below_is_told_in_a_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"section_height: can only be limited by <="):
        problem_of(tmp_path, ARM, "minimize: mass\nsubject_to: {section_height: '>= 60 mm'}\n")
