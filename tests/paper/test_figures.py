"""Figures 5 to 9 as data and as a page."""

import csv
import io
import json
import math
import re

import numpy as np
import pytest

from linkwright.paper.output.pages import figure_csv, figures_json
from linkwright.paper.output.pictures import describe
from linkwright.report.described import page_of
from tests.linkwright.samples import unpacked

pytestmark = pytest.mark.slow


def test_all_five_with_columns_of_one_length(figures):
    """Numbers as in the paper; every column as long as the others."""
    assert list(figures) == ["5", "6", "7", "8", "9"]
    for figure in figures.values():
        assert len({len(values) for values in figure.columns.values()}) == 1
        assert figure.remarks


def test_map_is_as_wide_as_the_arm_and_worst_at_its_sides(figures):
    """The largest cell comes near the true maximum, lies at full reach, and nothing lies beyond the reach."""
    figure = figures["5"]
    x, y, error = (figure.column(name) for name in ("x_mm", "y_mm", "corrected_mm"))
    seen = np.isfinite(error)
    assert np.nanmax(error) == pytest.approx(figure.marks["corrected_max_mm"], rel=0.02)
    assert np.nanmax(error) <= figure.marks["corrected_max_mm"]
    worst = np.nanargmax(error)
    assert abs(x[worst]) > 1100
    assert abs(y[worst]) < 300
    half = 0.5 * 2480 / 31
    assert np.hypot(x, y)[seen].max() < 1240 + half * math.sqrt(2)
    assert seen[np.hypot(x, y) < 1100].all()
    upright = seen & (np.abs(x) < half) & (np.abs(y) > 1000)
    assert error[upright].max() < 0.4 * figure.marks["corrected_max_mm"]


def test_map_of_the_paper_is_its_square(figures):
    """Its largest PE is the printed 0.0015 mm^2."""
    figure = figures["5"]
    squares = figure.column("paper_mm2")
    assert np.nanmax(squares) == pytest.approx(0.001457, rel=0.04)
    # Held straight up every link stands: its own place in the map is nearly dark, the sides are where it is worst.
    x, y = figure.column("x_mm"), figure.column("y_mm")
    assert abs(x[np.nanargmax(squares)]) > 1100
    upright = np.isfinite(squares) & (np.abs(x) < 45) & (np.abs(y) > 1150)
    assert upright.any()
    assert squares[upright].max() < 0.1 * 0.001457
    assert figure.marks["paper_max_mm2"] == pytest.approx(0.001457, abs=5e-7)


def test_around_the_circle(figures, book):
    """At 0 and 180 degrees what Table III has; upright the clearance alone, but for a trace of compression."""
    figure = figures["6"]
    degrees, ours = figure.column("shoulder_deg"), figure.column("corrected_with_deformation_mm")
    row = book.table("clearance").rows[-1]
    for at in (0.0, 180.0, 360.0):
        assert ours[np.argmin(np.abs(degrees - at))] == pytest.approx(1e3 * row.corrected[1], rel=1e-6)
    for at in (90.0, 270.0):
        assert ours[np.argmin(np.abs(degrees - at))] == pytest.approx(0.075, abs=4e-4)
    paper = figure.column("paper_with_deformation_mm2")
    assert paper.max() == pytest.approx(row.reproduced[1], rel=1e-9)
    assert np.ptp(figure.column("corrected_clearance_mm")) == 0.0


def test_clearance_swept(figures):
    """From 0.005 to 2 mm; the truth is a straight line, the paper's a parabola."""
    figure = figures["7"]
    sizes = figure.column("clearance_mm")
    assert (sizes[0], sizes[-1]) == pytest.approx((0.005, 2.0))
    rest = figure.column("corrected_with_deformation_mm") - 3 * sizes
    assert rest == pytest.approx(np.full(len(sizes), 0.17729), abs=5e-5)
    roots = np.sqrt(figure.column("paper_with_deformation_mm2"))
    assert np.polyfit(sizes, roots, 1) == pytest.approx([3 * math.sqrt(2), 0.038174], rel=1e-6)
    even = figure.marks["clearance_equals_deformation_mm"]
    assert 3 * even == pytest.approx(0.17729, abs=5e-5)


def test_backlash_swept(figures):
    """2.5 m of lever arms in truth, 1.24 m times the root of 2 in the paper."""
    figure = figures["8"]
    turns = figure.column("backlash_rad")
    assert turns[-1] == pytest.approx(0.01)
    assert figure.column("corrected_with_deformation_mm") == pytest.approx(2500 * turns + 0.17729, abs=1e-3)
    assert np.sqrt(figure.column("paper_backlash_mm2")) == pytest.approx(1240 * math.sqrt(2) * turns)


def test_length_swept_to_the_yield(figures):
    """Root of 2 sigma W / q by hand: 15.05 m; the error goes with the fourth power of the length."""
    figure = figures["9"]
    reach, error = figure.column("reach_mm"), figure.column("corrected_mm")
    weight = 2700 * 9.81 * math.pi * 0.05**2
    modulus = math.pi * 0.1**3 / 32
    assert figure.marks["yields_at_reach_mm"] == pytest.approx(1e3 * math.sqrt(2 * 240e6 * modulus / weight), rel=1e-4)
    bending = weight * (1e-3 * reach) ** 4 / (8 * 71e9 * math.pi * 0.1**4 / 64) * 1e3
    assert error == pytest.approx(bending, rel=6e-3)
    scale = reach / 1240
    paper = (0.034684 * scale**4 + 0.003490 * scale**3) ** 2
    assert figure.column("paper_mm2") == pytest.approx(paper, rel=1e-9)
    safe = figure.column("safety_factor")
    assert np.all(np.diff(safe) < 0)
    assert np.interp(figure.marks["yields_at_reach_mm"], reach, safe) == pytest.approx(1.0, abs=0.15)
    assert figure.marks["linear_to_reach_mm"] < figure.marks["yields_at_reach_mm"]


def test_csv_and_json_hold_the_same(figures):
    """Ten digits; an empty cell and a null where no pose is."""
    content = figures_json(list(figures.values()))
    for item in content["figures"]:
        read = list(csv.DictReader(io.StringIO(figure_csv(figures[item["number"]]))))
        for name, values in item["columns"].items():
            assert [None if row[name] == "" else float(row[name]) for row in read] == values
    assert any(value is None for value in content["figures"][0]["columns"]["corrected_mm"])


def test_page_stands_alone(figures):
    """Every figure twice, the truth and the paper, and nothing that is fetched."""
    made = page_of(describe(list(figures.values())))
    drawn = unpacked(re.search(r'id="figures">(.*?)</script>', made)[1])
    for number in figures:
        assert f'data-figure="true-{number}"' in made
        assert f'data-figure="paper-{number}"' in made
        assert drawn[f"true-{number}"]["data"]
    head = made.split("<script", 1)[0]
    assert "<link" not in made.split("<script>", 1)[0]
    assert "http" not in head
    assert "<script src" not in made
    assert "a link yields" in json.dumps(drawn)
