"""Every picture of an arm shows the bodies that STEP's solids are: their silhouettes lie in the solids' boxes."""

import io
import math
import re
from importlib.resources import files

import ezdxf
import numpy as np
import pandas as pd
import pytest

import linkwright as lw
from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.placed.heights import heights
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import Rectangle, TSection
from linkwright.core.sections.taper import build_tapered
from linkwright.report.pictures.arm import skeleton_at
from linkwright.report.pictures.sections import sections_grid
from linkwright.report.pictures.side_view import side_view

UPRIGHT, LEVEL, LEANING = (0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.0, -math.sin(0.6), math.cos(0.6))
SECTIONS = (
    Rectangle(0.0658, 0.02),
    TSection(width=0.05, height=0.09, flange_thickness=0.008, web_thickness=0.006),
    build_tapered("rectangle", {"width": (0.06, 0.03), "height": (0.1, 0.04)}),
)


def arm_with(axis, up=None):
    """Three links along x one after another under gravity along -z, whose joints turn about parallel axes."""
    steel = load_catalogue().find("steel-s355")
    links = tuple(Link(0.3, section=item, material=steel, height_direction=up) for item in SECTIONS)
    joints = tuple(Joint(axis=axis, range=(-1.0, 1.0)) for _ in SECTIONS)
    return Arm("sampled", joints, links, gravity=(0.0, 0.0, -9.81), payload=LoadCase(1.0))


def boxes(arm):
    """The boxes around STEP's solids, mm: least and greatest corner of each link."""
    pytest.importorskip("build123d")
    from linkwright.drawings.step import solids

    results = [solid.bounding_box() for solid in solids(arm).values()]
    return [(np.array(tuple(box.min)), np.array(tuple(box.max))) for box in results]


def paths(picture):
    """The first ring of each link's path in a picture, y up."""
    rings = re.findall(r'<path d="M([^Z"]+)Z[^"]*"[^>]*class="link', picture)
    return [np.array([[float(x) for x in place.split(",")] for place in ring.split("L")]) * (1, -1) for ring in rings]


ARMS = [
    pytest.param(arm_with(UPRIGHT), ["level (along y)"] * 3, id="upright axes"),
    pytest.param(arm_with(LEVEL), ["up"] * 3, id="level axes"),
    pytest.param(arm_with(LEANING), ["56 deg from up"] * 3, id="leaning axes"),
    pytest.param(arm_with(UPRIGHT, (0.0, 0.0, 1.0)), ["up"] * 3, id="upright axes, stood up"),
    pytest.param(arm_with(LEVEL, (0.0, 0.0, -1.0)), ["up", "down", "up"], id="upside down"),
]


@pytest.mark.parametrize(("arm", "points"), ARMS)
def test_silhouettes_are_those_of_the_solids(arm, points):
    """From the side, in line, as cross-sections and on the drawing; by boxes that build123d measures."""
    bodies = boxes(arm)
    drawn = skeleton_at(arm, WorstPose((0.0,) * 3, 0, 0.0, (0.0, 0.0, 0.0), (), ()))
    in_line, cuts = paths(side_view(arm, arm.cases)), paths(sections_grid((("", arm),)))
    sheet = ezdxf.read(io.StringIO(lw.export_arm(lw.Arm.of(arm), to="dxf").text)).modelspace()
    outlines = [np.array([p[:2] for p in item.get_points()]) for item in sheet.query("LWPOLYLINE[layer=='OUTLINE']")]
    views = [outline for outline in outlines if outline[:, 0].min() == pytest.approx(0.0)]
    scale = np.ptp(in_line[0][:, 0]) / 300.0
    for number, ((low, high), link) in enumerate(zip(bodies, drawn.links, strict=True)):
        corners = np.array(link.corners) * (1.0, -1.0)
        assert corners.min(axis=0) == pytest.approx(low[[0, 2]], abs=1e-3)
        assert corners.max(axis=0) == pytest.approx(high[[0, 2]], abs=1e-3)
        assert in_line[number][:, 1].min() / scale == pytest.approx(low[2], abs=0.01)
        assert in_line[number][:, 1].max() / scale == pytest.approx(high[2], abs=0.01)
        assert np.ptp(views[number], axis=0) == pytest.approx((high - low)[[0, 2]], abs=1e-3)
        assert np.ptp(cuts[number], axis=0) == pytest.approx((high - low)[1:], abs=0.01)
    assert [height.words for height in heights(arm)] == points


@pytest.mark.parametrize(("arm", "points"), ARMS)
def test_tables_and_drawings_say_where_heights_point(arm, points):
    """The parts' list, the drawing, the side view and the links of the result."""
    table = pd.read_csv(io.StringIO(lw.export_arm(lw.Arm.of(arm), to="bom").text))
    assert table.loc[table["part"].str.startswith("link"), "height_at_zero"].tolist() == points
    sheet = ezdxf.read(io.StringIO(lw.export_arm(lw.Arm.of(arm), to="dxf").text)).modelspace()
    words = [item.dxf.text for item in sheet.query("TEXT")]
    picture = side_view(arm, arm.cases)
    for point in points:
        assert any(f"height points {point} with all joints at zero" in line for line in words)
        assert f"height {point}" in picture


def test_sizes_on_the_drawing_are_the_sections_own_however_it_leans():
    sheet = ezdxf.read(io.StringIO(lw.export_arm(lw.Arm.of(arm_with(LEANING)), to="dxf").text)).modelspace()
    said = sorted(item.get_measurement() for item in sheet.query("DIMENSION"))
    assert said == pytest.approx(sorted([300.0] * 3 + [65.8, 20, 50, 90, 60, 100, 30, 40]))


def test_walls_thinner_than_a_pixel_have_an_outline_of_their_own_colour():
    """1 mm in half a metre, 200 pixels high, is 0.4 pixels wide; elsewhere links are set apart by white."""
    style = files("linkwright.report").joinpath("style.css").read_text(encoding="utf-8")
    stroke = dict(re.findall(r"\.profile\.(before|after) \{ stroke: ([^;]+);", style))
    assert stroke == {"before": "var(--before)", "after": "var(--after)"}
    drawn = re.findall(r'<path [^>]*class="([^"]+)"', sections_grid([("before", arm_with(LEVEL))]))
    assert [set(of.split()) for of in drawn] == [{"link", "profile", "before"}] * 3
