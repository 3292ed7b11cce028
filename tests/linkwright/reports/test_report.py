"""The report pages: they load nothing, hold the figures of the result, and draw to scale."""

import math
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Joint
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.worst.search import WorstPose
from linkwright.core.sections import Circle, Tube
from linkwright.report.described import origin_of, page_of, signed
from linkwright.report.pictures.arm import arm_picture, shared_window, skeleton, skeleton_at
from linkwright.report.pictures.sections import sections_grid
from linkwright.report.pictures.side_view import side_view
from linkwright.results import evaluation as evaluations
from linkwright.results.diagnoses import described as diagnoses
from linkwright.results.figures_in_words import mm
from linkwright.results.optimization import describe
from tests.diagnose.made_diagnosis import made_arm, made_diagnosis
from tests.linkwright.samples import arm_of, unpacked

VOID = {"meta", "br", "link", "img", "input", "hr"}


class Page(HTMLParser):
    """A page taken apart: its tags, its visible text, its scripts."""

    def __init__(self, source):
        super().__init__()
        self.tags, self.words, self.scripts, self.open = [], [], {}, []
        self.feed(source)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_data(self, data):
        tag, attributes = self.open[-1] if self.open else ("", {})
        if tag == "script":
            self.scripts.setdefault(attributes.get("id", ""), data)
        elif tag != "style":
            self.words.append(data)

    @property
    def figures(self):
        """The figures' data."""
        return unpacked(self.scripts["figures"])

    @property
    def text(self):
        """All that can be read, blanks made equal."""
        return " ".join(" ".join(self.words).replace("\u00a0", " ").split())


@pytest.fixture(scope="module")
def page(result):
    """The report of the optimisation."""
    return Page(page_of(describe(result)))


def test_page_is_well_formed(page):
    """Every tag is closed, in order."""
    assert page.open == []


def test_page_loads_nothing(page):
    """No script, style, picture or frame from elsewhere, neither by attribute nor by style."""
    assert "link" not in {tag for tag, _ in page.tags}
    for tag, attributes in page.tags:
        for name in ("src", "href", "srcset", "data", "xlink:href", "action"):
            assert name not in attributes, (tag, attributes)
        assert "url(" not in (attributes.get("style") or "")


def test_styles_and_own_script_load_nothing(result):
    """Plotly is left out of the search: its code names addresses that these figures never ask for."""
    source = page_of(describe(result))
    style = source[source.index("<style>") : source.index("</style>")]
    own = source[source.rindex("<script>") :]
    for text in (style, own):
        assert not re.search(r"https?:|url\(|@import|fetch\(|XMLHttpRequest", text)


def test_plotly_stands_in_the_page_once_and_packed(page, result):
    """It has more than four megabytes of its own; a report can be mailed."""
    assert 1_000_000 < len(page.scripts["plotly"]) < len(page_of(describe(result))) <= 2_000_000


@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs Debian's chromium")
def test_a_browser_draws_every_figure(page, result, tmp_path):
    """Unpacked by the page's own script, from a file, without a network."""
    report = tmp_path / "report.html"
    report.write_text(page_of(describe(result)), encoding="utf-8")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=20000", "--dump-dom"]
    drawn = subprocess.run(
        ["chromium", *options, report.as_uri()], capture_output=True, text=True, check=True, timeout=120
    ).stdout
    places = re.findall(r'<div class="plot[^>]*data-figure="([^"]+)"[^>]*>(.{0,4000})', drawn, re.DOTALL)
    assert {name for name, _ in places} == set(page.figures)
    assert all("main-svg" in inside for _, inside in places)


def test_a_report_says_where_it_is_from(result, tmp_path, monkeypatch):
    """The sum of a file as sha256sum has it (FIPS 180-4's example "abc"), the day by the clock that is given."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    problem = tmp_path / "problem.yaml"
    problem.write_text("abc")
    origin = origin_of([problem, tmp_path / "gone.yaml"], author="<Ada>", comment="second study")
    told = Page(signed(page_of(describe(result)), origin))
    assert told.open == []
    for words in (
        "1970-01-02",
        "<Ada>",
        "second study",
        "problem.yaml SHA-256 ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
        "gone.yaml no longer there",
    ):
        assert words in told.text


def test_page_says_what_the_result_says(page, result):
    """The headline and the tiles."""
    for value in (result.before.max_error, result.after.max_error):
        assert mm(value) in page.text
    assert "one kilogram more would buy 0.0042 mm" in page.text
    assert "tube: diameter 80, thickness 3 mm" in page.text
    assert "problem.yaml" in page.text
    assert "folder/problem.yaml" not in page.text
    assert "infeasible" in page.text


def test_names_are_text_and_not_markup(page):
    """An arm may be called anything."""
    assert "welding <arm>: the new design" in page.text
    assert "arm" not in {tag for tag, _ in page.tags}


def test_maps_share_one_colour_scale_and_hold_the_errors(page, result):
    """The figures in the page are those of the result, in mm, null where no pose puts the tip."""
    figures = page.figures
    heats = [figures[name]["data"][0] for name in ("map-before", "map-after")]
    assert {(heat["zmin"], heat["zmax"]) for heat in heats} == {(heats[0]["zmin"], heats[0]["zmax"])}
    for heat, field, evaluation in zip(
        heats, (result.before_map, result.after_map), (result.before, result.after), strict=True
    ):
        shown = np.array(heat["z"], dtype=float)
        assert np.allclose(shown, 1e3 * field.worst, atol=1e-6, equal_nan=True)
        assert np.isnan(shown).any()
        assert np.nanmax(shown) <= 1e3 * evaluation.worst.upper_bound
    assert heats[0]["zmax"] == pytest.approx(1e3 * result.before.max_error)
    layouts = [figures[name]["layout"] for name in ("map-before", "map-after")]
    assert layouts[0]["xaxis"]["range"] == layouts[1]["xaxis"]["range"]


def test_worst_pose_is_marked_where_the_tip_is(page, result):
    """In the plane: x and y of the nominal tip."""
    figures = page.figures
    marks = figures["map-after"]["data"][1]
    first, second = result.after.worst.poses[0].q
    x = 400.0 * math.cos(first) + 300.0 * math.cos(first + second)
    y = 400.0 * math.sin(first) + 300.0 * math.sin(first + second)
    assert (marks["x"][0], marks["y"][0]) == pytest.approx((x, y), abs=1e-3)


def test_every_figure_has_its_place(page):
    """And every place its figure, with words for those who cannot see it."""
    places = [attributes for _, attributes in page.tags if "data-figure" in attributes]
    assert {place["data-figure"] for place in places} == set(page.figures)
    drawings = [attributes for tag, attributes in page.tags if tag == "svg"]
    assert len(drawings) == 2 + 2 + 4
    assert all(attributes["aria-label"] for attributes in drawings + places)


def test_bars_are_to_scale(page, result):
    """The widest is the largest effect; another is as wide as its share."""
    widths = [
        float(re.fullmatch(r"width:([\d.]+)%", attributes["style"])[1])
        for tag, attributes in page.tags
        if tag == "span" and (attributes.get("class") or "").startswith("fill")
    ]
    values = [value for item in (result.before, result.after) for value in item.by_effect.values()]
    expected = sorted(100.0 * value / max(values) for value in values)
    tables = [sorted(widths[first : first + len(values)]) for first in range(len(widths))]
    assert [drawn for drawn in tables if drawn == pytest.approx(expected, abs=0.01)]


def test_sections_are_drawn_to_one_scale():
    """A bar of 50 mm spans 50 units, in the same window as a tube of 80 mm, whose bore stays open."""
    grid = sections_grid((("before", arm_of((Circle(0.05),), (0.4,))), ("after", arm_of((Tube(0.08, 0.003),), (0.4,)))))
    windows = re.findall(r'viewBox="([^"]+)"', grid)
    assert len(windows) == 2
    assert len(set(windows)) == 1
    paths = re.findall(r'<path d="([^"]+)"', grid)
    spans = []
    for path in paths:
        across = [[float(point.split(",")[0]) for point in ring.split("L")] for ring in path[1:-1].split("ZM")]
        spans.append([max(ring) - min(ring) for ring in across])
    assert spans == [pytest.approx([50.0], rel=1e-3), pytest.approx([80.0, 74.0], rel=1e-3)]


def test_arm_is_drawn_to_scale(evaluation):
    """Links from joint to joint, as thick as their sections are high, and the error exaggerated by one factor."""
    drawn = skeleton(evaluation)
    link = drawn.links[0]
    assert math.dist(link.start, link.end) == pytest.approx(400.0)
    assert link.thickness == pytest.approx(50.0, rel=1e-3)
    assert math.hypot(*drawn.error) == pytest.approx(1e3 * evaluation.max_error)
    window = shared_window([drawn])
    picture = arm_picture(evaluation.arm, drawn, window, "before")
    line = re.search(r'<line x1="([-\d.e]+)" y1="([-\d.e]+)"[^>]*class="error-line"', picture)
    assert (float(line[1]), float(line[2])) == pytest.approx(drawn.tip, rel=1e-4, abs=1e-2)
    assert window.exaggeration * math.hypot(*drawn.error) < 0.2 * 700.0


@pytest.mark.parametrize("turned", [0.0, 0.7, math.pi / 2, math.pi])
def test_letters_are_read_however_the_arm_stands(evaluation, turned):
    """Pictures are at most 320 pixels high (`.bounded.small` in style.css): none has letters below 9 pixels."""
    pose = WorstPose((turned, *(0.0 for _ in evaluation.arm.joints[1:])), 0, 0.0, (0.0, 0.0, 0.0), (), ())
    drawn = skeleton_at(evaluation.arm, pose)
    window = shared_window([drawn])
    picture = arm_picture(evaluation.arm, drawn, window, "before")
    assert float(re.search(r'font-size="([\d.]+)"', picture)[1]) * 320.0 / window.height >= 9.0
    assert all(window.left < x < window.left + window.width for x, _ in drawn.points)
    assert all(window.top < y < window.top + window.height for _, y in drawn.points)


def test_an_arm_in_space_is_drawn_upright_through_its_tip():
    """A turning column: across is the distance from its axis, up is up."""
    column = Joint(axis=(0.0, 0.0, 1.0), range=(0.5, 2.0))
    elbow = Joint(axis=(0.0, 1.0, 0.0), range=(-1.0, 1.0), stiffness=1e4)
    arm = replace(arm_of((Circle(0.05), Circle(0.05)), joints=(column, elbow)), gravity=(0.0, 0.0, -9.81))
    result = evaluate(arm)
    drawn = skeleton(result)
    second = result.worst.poses[0].q[1]
    assert drawn.tip == pytest.approx((400.0 + 300.0 * math.cos(second), 300.0 * math.sin(second)), abs=1e-6)
    page = Page(page_of(evaluations.describe(result)))
    assert "seen from the side" in page.text


def test_a_scara_is_seen_from_above_at_its_true_reach():
    """Axes that point up: 400 and 300 mm, the elbow at q, reach sqrt(400^2 + 300^2 + 2 400 300 cos q)."""
    joint = Joint(axis=(0.0, 0.0, 1.0), range=(0.6, 0.6), stiffness=1e4)
    arm = arm_of((Circle(0.05), Circle(0.05)), joints=(replace(joint, range=(0.2, 0.2)), joint))
    result = evaluate(replace(arm, gravity=(0.0, 0.0, -9.81)))
    drawn = skeleton(result, above=True)
    assert drawn.tip == pytest.approx((math.sqrt(400.0**2 + 300.0**2 + 2.0 * 400.0 * 300.0 * math.cos(0.6)), 0.0))
    elbow = drawn.links[0].end
    assert math.hypot(*elbow) == pytest.approx(400.0)
    assert elbow[1] > 0.0  # to the right of the line to the tip, whose joint turns to the left: below it on the page
    assert "seen from above" in Page(page_of(evaluations.describe(result))).text


def test_an_arm_in_space_can_be_turned_beside_its_side_view():
    """Its axis in mm and the error at its tip, in closed form: 400 and 300 mm about upright axes."""
    joint = Joint(axis=(0.0, 0.0, 1.0), range=(0.6, 0.6), stiffness=1e4)
    arm = arm_of((Circle(0.05), Circle(0.05)), joints=(replace(joint, range=(0.0, 0.0)), joint))
    result = evaluate(replace(arm, gravity=(0.0, 0.0, -9.81)))
    figure = Page(page_of(evaluations.describe(result))).figures["in-space"]
    traces = {trace["name"]: trace for trace in figure["data"]}
    ends = [traces["arm"][name][-1] for name in "xyz"]
    assert ends == pytest.approx([400.0 + 300.0 * math.cos(0.6), 300.0 * math.sin(0.6), 0.0], abs=1e-6)
    assert "reach" not in traces
    scale = float(figure["layout"]["title"]["text"].split()[1])
    far = [b - a for a, b in (traces["worst error"][name] for name in "xyz")]
    assert math.hypot(*far) == pytest.approx(1e3 * scale * result.max_error, rel=1e-6)


def test_beside_a_slide_lengths_add_up_to_no_reach():
    """The side view lays a spindle out in line; only what is in line is summed."""
    turning = Joint(axis=(0.0, 0.0, 1.0), range=(0.6, 0.6), stiffness=1e4)
    arm = arm_of((Circle(0.05), Circle(0.05)), joints=(turning, turning))
    slide = Joint(type="prismatic", axis=(0.0, 0.0, 1.0), range=(0.0, 0.0))
    assert ">700<" in side_view(arm, arm.cases)
    assert ">700<" not in side_view(replace(arm, joints=(turning, slide)), arm.cases)


def test_page_of_a_single_arm(evaluation):
    """The same parts, without before and after."""
    page = Page(page_of(evaluations.describe(evaluation)))
    assert page.open == []
    assert mm(evaluation.max_error) in page.text
    assert set(page.figures) == {"map-arm"}
    assert "before" not in page.text.lower()


def test_warnings_are_on_the_page(evaluation):
    """Plainly, in words."""
    warned = replace(evaluation, warnings=("link 1 yields: 300 MPa, safety factor 0.9",))
    assert "link 1 yields: 300 MPa" in Page(page_of(evaluations.describe(warned))).text


@pytest.mark.slow
def test_how_long_it_took_is_left_out_where_the_date_is_given(result, monkeypatch):
    """For two runs of one question never take as long."""

    def both(seconds):
        diagnosis = replace(made_diagnosis("named", made_arm(space=True)), seconds=seconds)
        return [page_of(diagnoses.describe(diagnosis)), page_of(describe(replace(result, seconds=seconds)))]

    assert all(one != other for one, other in zip(both(1.0), both(2.0), strict=True))
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert both(1.0) == both(2.0)
