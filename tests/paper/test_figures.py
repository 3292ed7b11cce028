"""Figures 5 to 9 as data and as a page."""

import csv
import io
import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.paper.corrected import PaperArm, pose_errors
from linkwright.paper.output.figures import postures_at
from linkwright.paper.output.pages import figure_csv, figures_json
from linkwright.paper.output.pictures import describe, figure_svg
from linkwright.paper.printed import read_paper
from linkwright.report.described import page_of
from linkwright.report.pictures.contour import regions

pytestmark = pytest.mark.slow
SVG = "{http://www.w3.org/2000/svg}"


def test_all_five_with_columns_of_one_length(figures):
    """Numbers as in the paper; every column as long as the others."""
    assert list(figures) == ["5", "6", "7", "8", "9"]
    for figure in figures.values():
        assert len({len(values) for values in figure.columns.values()}) == 1
        assert figure.remarks


def test_map_is_as_wide_as_the_arm_and_worst_at_its_sides(figures):
    """The largest is the true maximum, at full reach to either side; nothing lies beyond the reach."""
    figure = figures["5"]
    x, y, error = (figure.column(name) for name in ("x_mm", "y_mm", "corrected_mm"))
    assert error.max() == pytest.approx(figure.marks["corrected_max_mm"], rel=1e-9)
    worst = error > (1 - 1e-9) * error.max()
    assert sorted(x[worst].tolist()) == pytest.approx([-1240, 1240])
    assert y[worst] == pytest.approx(0, abs=1e-9)
    assert np.hypot(x, y).max() == pytest.approx(1240)
    upright = (np.abs(x) < 40) & (np.abs(y) > 1000)
    assert error[upright].max() < 0.4 * figure.marks["corrected_max_mm"]


def test_map_against_random_poses(figures):
    """Poses whose tips come near a place of the map: none errs more than the map there and about it, and some nearly
    as much."""
    figure, arm = figures["5"], PaperArm(read_paper()).arm()
    q = np.random.default_rng(2).uniform(-math.pi, math.pi, (100_000, 3))
    tips, errors = 1e3 * tip_position(arm, q)[:, :2], 1e3 * pose_errors(arm, q)
    x, y, mapped = (figure.column(name) for name in ("x_mm", "y_mm", "corrected_mm"))
    for place in (100, 250, 400, 600, 700):
        near = errors[np.hypot(*(tips - [x[place], y[place]]).T) < 25]
        around = mapped[np.hypot(x - x[place], y - y[place]) < 130]
        assert len(near) > 20
        assert 0.8 * mapped[place] < near.max() < around.max()


@pytest.mark.parametrize("share", [-1.0, -0.2, 0.001, 0.6, 1.0])
def test_postures_have_their_tips_where_they_are_due(share):
    """On either side of the elbow, also where the wrist comes near the base."""
    lengths = (0.4, 0.42, 0.42)
    radius, angle = np.repeat([1e-6, 0.2, 0.41, 0.42, 0.8, 1.24], 7), np.tile(np.linspace(0, 6, 7), 6)
    q = np.cumsum(postures_at(lengths, radius, angle, share), axis=-1)
    x, y = (sum(length * turn(q[..., k]) for k, length in enumerate(lengths)) for turn in (np.cos, np.sin))
    assert np.abs(x - radius * np.cos(angle)).max() < 1e-7
    assert np.abs(y - radius * np.sin(angle)).max() < 1e-7


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
    """Ten digits."""
    content = figures_json(list(figures.values()))
    for item in content["figures"]:
        read = list(csv.DictReader(io.StringIO(figure_csv(figures[item["number"]]))))
        for name, values in item["columns"].items():
            assert [None if row[name] == "" else float(row[name]) for row in read] == values


def test_page_stands_alone(figures):
    """Every figure twice, the truth and the paper, drawn in the page itself, and nothing that is fetched."""
    made = page_of(describe(list(figures.values())))
    body = made.split("<body>", 1)[1].split("<script", 1)[0]
    assert body.count("<svg ") == 2 * len(figures)
    assert "a link yields" in body
    assert "http" not in made.split("<script", 1)[0]
    assert "<script src" not in made


def test_drawings_for_print(figures):
    """Whole SVG files of 180 mm with words as words; two curves apart by their dashes, ticks enough on every axis."""
    for figure in figures.values():
        drawn = ElementTree.fromstring(figure_svg(figure))
        assert drawn.get("width") == "180mm"
        halves = drawn.findall(SVG + "svg")
        assert len(halves) == 2
        for half in halves:
            words = [item.text for item in half.iter(SVG + "text")]
            ticks = [text for text in words if re.fullmatch("\u2212?[0-9.e\u2212]+", text)]
            assert len(ticks) >= 6, figure.number
            curves = [item for item in half.iter(SVG + "path") if "course" in item.get("class", "")]
            looks = {(item.get("class"), item.get("stroke-dasharray")) for item in curves}
            assert len(looks) == {"5": 0, "9": 1}.get(figure.number, 2)


def test_regions_of_a_cone():
    """About the middle a cone is at least so high within a circle; a ring has a hole, which turns the other way."""
    radius, angle = np.repeat(np.linspace(1e-9, 1, 21), 60), np.tile(2 * np.pi * np.arange(60) / 60, 21)
    x, y = radius * np.cos(angle), radius * np.sin(angle)

    def area(ring):
        return 0.5 * float(np.sum(ring[:, 0] * np.roll(ring[:, 1], -1) - ring[:, 1] * np.roll(ring[:, 0], -1)))

    disc = 0.5 * 60 * math.sin(2 * np.pi / 60)
    (cone,) = regions(x, y, 1 - radius, 60, 0.33)
    assert area(cone) == pytest.approx(0.67**2 * disc, rel=1e-3)
    rings = regions(x, y, radius, 60, 0.33)
    assert sum(map(area, rings)) == pytest.approx((1 - 0.33**2) * disc, rel=1e-3)
    assert sorted(np.sign([area(ring) for ring in rings])) == [-1, 1]
    assert regions(x, y, radius, 60, 2.0) == []
    (left,) = regions(x, y, x, 60, 0.0)
    assert area(left) == pytest.approx(0.5 * disc, rel=0.06)
