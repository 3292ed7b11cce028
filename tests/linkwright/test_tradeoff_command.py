"""`linkwright tradeoff`: its files, arms that bear their figures out, wrong input, and what a stop leaves."""

import csv
import itertools
import json
import re
import xml.etree.ElementTree as ET

import pytest

import linkwright as lw
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.figures import FIGURES
from linkwright.core.arm.files.read import read_arm
from linkwright.core.optimize.tradeoff.question import axes_of
from linkwright.core.optimize.tradeoff.trace import Tracer
from linkwright.report.charts.fronts import _axis
from linkwright.report.pictures.svg import marks
from linkwright.results.tradeoff import spread
from tests.linkwright.samples import unpacked

PROBLEM = """\
arm: arm.yaml
subject_to: {mass: "<= 4 kg", max_error: "<= 2 mm", section_size: [20 mm, 80 mm], thickness: [2 mm, 10 mm]}
choose: {section: [circle], material: [aluminium-6061-t6, steel-s355], same: [size, section, material]}
"""
ONE = PROBLEM.split("choose")[0] + "choose: {section: tube, material: aluminium-6061-t6, same: [section, material]}\n"


@pytest.fixture
def two(bench):
    """A problem with two materials."""
    (bench / "two.yaml").write_text(PROBLEM, encoding="utf-8")
    (bench / "one.yaml").write_text(ONE, encoding="utf-8")
    return bench


def test_files_agree_and_arms_bear_their_figures_out(two, linkwright):
    status, out, _ = linkwright(
        "tradeoff",
        "two.yaml",
        "--by",
        "material",
        "--accuracy",
        "0.4",
        "--out",
        "front",
        "--csv",
        "rows.csv",
        "--markdown",
        "front.md",
    )
    assert status == 0
    assert "knee" in out
    result = json.loads((two / "front/result.json").read_text())
    assert result["made_by"].startswith("linkwright tradeoff")
    points = re.findall(r"^\| (\d+)(?: knee)? \|", (two / "front.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(map(int, points)) == [point["number"] for point in result["points"]]
    rows = list(csv.DictReader((two / "rows.csv").read_text().splitlines()))
    assert (two / "rows.csv").read_text() == (two / "front/tradeoff.csv").read_text()
    assert [int(row["number"]) for row in rows] == [point["number"] for point in result["points"]]
    assert result["price_unit"] == "mm/kg"
    files = sorted(path.name for path in (two / "front/points").iterdir())
    assert files == sorted(point["arm_file"].removeprefix("points/") for point in result["points"])
    for point, row in list(zip(result["points"], rows, strict=True))[::4]:
        again = evaluate(read_arm(two / "front" / point["arm_file"]))
        assert again.mass == pytest.approx(point["mass_kg"], rel=1e-8)
        assert 1e3 * again.max_error == pytest.approx(point["max_error_mm"], rel=1e-6)
        assert float(row["mass_kg"]) == point["mass_kg"]
        assert float(row["price_mm_per_kg"] or "nan") == pytest.approx(point["price"] or float("nan"), nan_ok=True)
    for name in ("aluminium-6061-t6", "steel-s355"):
        assert name in {front["name"] for front in result["fronts"]}
    picture = (two / "front/tradeoff.svg").read_text()
    drawing = ET.fromstring(picture)
    assert drawing.tag.endswith("svg")
    circles = [item for item in drawing.iter() if item.tag.endswith("circle")]
    assert len(circles) >= len(result["points"])
    for circle in circles:
        assert 0.0 < float(circle.get("cx", "nan")) < 860.0
        assert 0.0 < float(circle.get("cy", "nan")) < 560.0
    page = (two / "front/report.html").read_text()
    figures = unpacked(re.search(r'id="figures">(.*?)</script>', page)[1])
    hovered = [text for trace in figures["front"]["data"] for text in trace["hovertext"] if "<b>point" in text]
    assert len({re.search(r"point (\d+)", text)[1] for text in hovered}) == len(result["points"])
    known = [item.title for item in FIGURES.values() if result["points"][0].get(item.key) is not None]
    assert len(known) > 6
    assert all(title in text for text in hovered for title in known)
    assert "http" not in re.sub(r"<script.*?</script>", "", page.replace("http://www.w3.org", ""), flags=re.DOTALL)


WRONG = {
    "unknown figure": (["one.yaml", "--x", "weight"], "--x"),
    "no choice": (["bare.yaml", "--by", "shape"], "choose"),
    "strangers": (["one.yaml", "--out", "full"], "notes.txt"),
    "another command's": (["one.yaml", "--out", "other"], "not of `linkwright tradeoff`"),
    "csv over the problem": (["one.yaml", "--csv", "one.yaml"], "is the input"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_input_is_one_line(name, two, linkwright):
    arguments, words = WRONG[name]
    (two / "bare.yaml").write_text("arm: arm.yaml\n")
    for folder, file in (("full", "notes.txt"), ("other", "result.json")):
        (two / folder).mkdir()
        (two / folder / file).write_text("{}")
    status, _, error = linkwright("tradeoff", *arguments)
    assert status == 2
    assert error.count("\n") == 1
    assert words in error


def test_no_design_is_no_answer(two, linkwright):
    (two / "one.yaml").write_text(ONE.replace("<= 4 kg", "<= 0.05 kg"), encoding="utf-8")
    status, _, error = linkwright("tradeoff", "one.yaml")
    assert status == 1
    assert "would have to be" in error


@pytest.mark.parametrize(("points", "kept"), [pytest.param(1, 0, marks=pytest.mark.slow), (4, 3)])
def test_ctrl_c_leaves_the_points_solved_so_far(two, linkwright, monkeypatch, points, kept):
    """It comes as so many points have been solved; `test_interrupt.py` sends the signal itself."""
    node, solved = Tracer._node, itertools.count(1)

    def counted(self, *arguments):
        if next(solved) == points:
            raise KeyboardInterrupt
        return node(self, *arguments)

    monkeypatch.setattr(Tracer, "_node", counted)
    status, _, error = linkwright("tradeoff", "one.yaml", "--accuracy", "0.05", "--out", "front")
    assert status == 130
    if not kept:
        assert "no point was solved yet" in error
        assert not (two / "front").exists()
        return
    assert "these are the points solved so far" in error
    result = json.loads((two / "front/result.json").read_text())
    assert result["interrupted"]
    assert not result["envelope"]["complete"]
    assert 0 < len(result["points"]) <= kept
    assert (two / "front/report.html").exists()


def test_marks_of_an_axis():
    assert marks(0.9, 4.2, log=False) == pytest.approx([1.0, 2.0, 3.0, 4.0])
    assert marks(0.9, 30.0, log=True) == pytest.approx([1.0, 2.0, 5.0, 10.0, 20.0])
    assert marks(1e-3, 2.0, log=True) == pytest.approx([1e-3, 1e-2, 0.1, 1.0])


def test_a_figure_in_logarithms_is_marked_in_words_as_the_picture_is():
    """Plotly's own marks between powers of ten are too small to read; a front's price need not be known everywhere."""
    axis = _axis([[0.37, 3.0], [None, 5.0]], log=True)
    assert axis["tickvals"] == marks(0.37, 5.0, log=True)
    assert axis["ticktext"] == ["0.5", "1", "2", "5"]
    assert "tickvals" not in _axis([[0.37, 3.0]], log=False)


def test_listed_points_hold_ends_and_knee():
    class Numbered:
        def __init__(self, number):
            self.number = number

    points = [Numbered(k) for k in range(1, 101)]
    listed = [point.number for point in spread(points, 10, 47)]
    assert len(listed) == 10
    assert {1, 47, 100} <= set(listed)
    assert spread(points[:5], 10, None) == points[:5]


def test_the_help_names_every_figure_that_is_shipped():
    """It is asked for before the figures are loaded, so that it names them by hand."""
    named = re.findall(r"[a-z]+(?:_[a-z]+)*", (lw.tradeoff.__doc__ or "").split("Any two figures:")[1].split(".")[0])
    assert sorted(named) == sorted(axes_of(FIGURES))
