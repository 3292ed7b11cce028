"""Questions without an answer: the limit in the way is named, and the figure that it would have to be does."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from linkwright.core.optimize.run import optimise
from linkwright.core.units.quantities import NoAnswer
from tests.costs import slow_but
from tests.optimize.builders import PAPER_ARM, jointed, problem_of, ranged

ARM = jointed(
    [400, 420, 420],
    ranged("-100 100", "-100 100", "-100 100", more=", mass: 2 kg, stiffness: 60 kN*m/rad, backlash: 1 arcmin"),
)
SIZES = "section_size: [10 mm, 60 mm]"

IMPOSSIBLE = {
    "mass too small": (f"subject_to: {{mass: '<= 0.01 kg', {SIZES}}}\n", ["mass"]),
    "mass too large": (f"subject_to: {{mass: '== 400 kg', {SIZES}}}\n", ["mass"]),
    "total mass too small": (f"subject_to: {{total_mass: '<= 9 kg', {SIZES}}}\n", ["total_mass"]),
    "error too small": ("minimize: mass\nsubject_to: {max_error: '<= 1 mm'}\n", ["max_error"]),
    "frequency too high": (
        f"minimize: mass\nsubject_to: {{first_frequency: '>= 200 Hz', {SIZES}}}\n",
        ["first_frequency"],
    ),
    "safety too high": (f"minimize: mass\nsubject_to: {{safety_factor: '>= 200', {SIZES}}}\n", ["safety_factor"]),
    "buckling too high": (f"minimize: mass\nsubject_to: {{buckling: '>= 100000', {SIZES}}}\n", ["buckling"]),
    "light and strong": (
        "subject_to: {mass: '<= 1 kg', safety_factor: '>= 20', section_size: [5 mm, 140 mm]}\n",
        ["mass", "safety_factor"],
    ),
}
_NEED = re.compile(r"(\w+) (?:<=|>=|==) [^,:]+? would have to be ((?:<=|>=|==) [\d.e-]+(?: [A-Za-z]+)?)")


@pytest.mark.parametrize("name", slow_but(IMPOSSIBLE, "error too small"))
def test_blocking_limit_is_named_with_a_figure_that_does(name: str, tmp_path: Path) -> None:
    text, blocking = IMPOSSIBLE[name]
    with pytest.raises(NoAnswer) as caught:
        optimise(problem_of(tmp_path, ARM, text))
    needs = dict(_NEED.findall(str(caught.value)))
    assert sorted(needs) == blocking
    assert "\n" not in str(caught.value)
    for limit, need in needs.items():
        text = re.sub(rf"\b{limit}: '[^']*'", f"{limit}: '{need}'", text)
    result = optimise(problem_of(tmp_path, ARM, text))
    assert result.status in ("certified", "converged")


def test_figure_is_no_looser_than_it_has_to_be(tmp_path: Path) -> None:
    """The least error of rods up to 60 mm thick is what the relaxed limit on the error must be, to its four digits."""
    least = optimise(problem_of(tmp_path, ARM, f"subject_to: {{{SIZES}}}\n")).objective
    with pytest.raises(NoAnswer) as caught:
        optimise(problem_of(tmp_path, ARM, f"minimize: mass\nsubject_to: {{max_error: '<= 1 mm', {SIZES}}}\n"))
    need = float(dict(_NEED.findall(str(caught.value)))["max_error"].split()[1])
    assert 1e3 * least <= need * (1.0 + 1e-6)
    assert need <= 1e3 * least * (1.0 + 1e-3)


def test_unreachable_path_names_the_point(tmp_path: Path) -> None:
    text = "workspace: {path: [[1300 mm, 0 mm], [1350 mm, 100 mm]]}\nsubject_to: {mass: '<= 10 kg'}\n"
    with pytest.raises(NoAnswer, match=r"\(1300, 0\) mm cannot be reached: the tip stays 60 mm away"):
        optimise(problem_of(tmp_path, PAPER_ARM, text))


def test_box_out_of_reach(tmp_path: Path) -> None:
    text = "workspace: {box: [[1300 mm, -300 mm], [1700 mm, 300 mm]]}\nsubject_to: {mass: '<= 10 kg'}\n"
    with pytest.raises(NoAnswer, match="cannot be reached"):
        optimise(problem_of(tmp_path, PAPER_ARM, text))
