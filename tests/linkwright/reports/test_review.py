"""What a design review looks at: dimensions, joint loads against statics by hand, poses that differ."""

import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import linkwright as lw
from linkwright.core.arm.chain.chain import Joint, LoadCase
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.limits.joint_loads import JointLoad, joint_loads
from linkwright.core.sections import Circle, RectangularTube, Tube
from linkwright.report.described import MOST_FOLDED, MOST_ROWS, table_html
from linkwright.report.pictures.loads import loads_picture
from linkwright.report.pictures.sections import sections_grid
from linkwright.report.pictures.side_view import side_view
from linkwright.results.design import drives, poses_that_differ
from linkwright.results.design import joint_loads as joint_loads_told
from linkwright.results.document import Bars, count, share, table, words
from linkwright.results.figures_in_words import factor_words
from linkwright.results.optimization import bound_sentence
from tests.linkwright.samples import arm_of

G = 9.81


def stretched():
    """Two tubes, 400 and 300 mm, a mass of 2 kg at each joint and 1 kg at the tip, stretched level."""
    return replace(arm_of((Tube(0.08, 0.003), RectangularTube(0.04, 0.06, 0.002, 0.002))), gravity=(0.0, -G, 0.0))


def test_joint_loads_are_those_of_statics_by_hand():
    """Weights times their distances, for a stretched level arm; nothing tilts a joint of a planar arm."""
    arm = stretched()
    inner, outer = evaluate(arm).link_masses
    first, second = joint_loads(arm, LoadCase(1.0), (0.0, 0.0))
    assert second.force == pytest.approx((0.0, -(outer + 1.0) * G, 0.0))
    assert second.moment == pytest.approx((0.0, 0.0, -(0.15 * outer + 0.3) * G))
    assert first.force == pytest.approx((0.0, -(inner + 2.0 + outer + 1.0) * G, 0.0))
    moment = (0.2 * inner + 0.4 * 2.0 + 0.55 * outer + 0.7) * G
    assert first.moment == pytest.approx((0.0, 0.0, -moment))
    assert (abs(first.drive), first.tilting, first.along) == pytest.approx((moment, 0.0, 0.0))
    assert first.radial == pytest.approx(math.hypot(*first.force))


def test_a_column_is_pressed_along_its_axis_and_tilted():
    """Turning about the plumb line: the weight runs along the axis, its moment lies across."""
    column = Joint(axis=(0.0, 0.0, 1.0), range=(-1.0, 1.0))
    arm = replace(arm_of((Circle(0.05),), (0.4,), (column,)), gravity=(0.0, 0.0, -G))
    mass = evaluate(arm).mass
    (load,) = joint_loads(arm, LoadCase(1.0), (0.7,))
    assert (load.along, load.radial, load.drive) == pytest.approx((-(mass + 1.0) * G, 0.0, 0.0), abs=1e-9)
    assert load.tilting == pytest.approx((0.2 * mass + 0.4) * G)


def test_the_side_view_is_to_scale_and_says_the_sizes():
    """Links as long to each other as they are and as high to their length; a tube's bore is dashed."""
    picture = side_view(stretched(), (LoadCase(1.0), LoadCase(2.5)))
    outlines = [
        np.array([[float(x) for x in point.split(",")] for point in found.split("L")])
        for found in re.findall(r'<path d="M([^Z]+)Z" class="link after"', picture)
    ]
    (first, high), (second, low) = (np.ptp(outline, axis=0) for outline in outlines)
    assert first / second == pytest.approx(4.0 / 3.0, rel=1e-4)
    assert (high / first, low / second) == pytest.approx((0.08 / 0.4, 0.06 / 0.3), rel=1e-3)
    assert picture.count('class="hidden"') == 4
    told = re.findall(r">([^<>]+)</text>", picture)
    for item in ("400", "300", "700", "1", "2", "⌀ 80", "60 × 40", "wall 3", "walls 2, 2", "payload 2.5 kg"):
        assert item in told


def test_the_report_holds_loads_and_the_bent_shape(evaluation):
    assert 'class="bent"' in loads_picture(evaluation)
    unweighed = replace(evaluation.arm.links[0], section=None, material=None, mass=None)
    arm = replace(evaluation.arm, links=(unweighed, *evaluation.arm.links[1:]))
    result = evaluate(arm)
    assert result.joint_loads is None
    assert loads_picture(result) == ""


def test_a_pose_turned_with_its_base_is_shown_once(evaluation):
    """And one that is a few degrees off; another load case, or another elbow, is another pose."""
    top = evaluation.worst.poses[0]
    turned = replace(top, q=(top.q[0] + 1.0, *top.q[1:]))
    near = replace(top, q=(*top.q[:-1], top.q[-1] + 0.05), error=0.9 * top.error)
    other = replace(top, q=(*top.q[:-1], top.q[-1] + 0.5))
    loaded = replace(turned, load_case=top.load_case + 1)
    worse = replace(turned, error=0.9 * top.error)
    result = replace(evaluation, worst=replace(evaluation.worst, poses=(top, turned, near, other, loaded, worse)))
    assert poses_that_differ(result) == (top, other, loaded, worse)


def test_a_gantry_is_as_bad_wherever_its_first_slide_stands():
    """Its worst pose is told once, and what no weight lies on holds nothing, at no pose of its own."""
    slide = lw.Joint(type="prismatic", axis="x", range=["0 m", "2 m"])
    turn = lw.Joint(axis="y", range=["-20 deg", "60 deg"], actuator="RV-20E")
    arm = lw.Arm(
        [
            (slide, lw.Link(length="300 mm", direction=[0, 0, 1], rigid=True, mass="5 kg")),
            (turn, lw.Link(length="0.8 m", section="SHS 60x4", material="steel-s355")),
        ],
        payload={"mass": "10 kg"},
        gravity=[0, 0, -9.81],
    )
    evaluation = lw.evaluate(arm).found
    top = evaluation.worst.poses[0]
    moved = replace(evaluation.worst, poses=(top, replace(top, q=(0.2, top.q[1]))))
    assert poses_that_differ(replace(evaluation, worst=moved)) == (top,)
    slide_row, joint_row = drives(evaluation).rows
    assert [words(cell) for cell in slide_row[2:]] == ["0 N", "–", "–", "–"]
    assert "0°" in words(joint_row[5])


def test_full_turns_are_one_pose(evaluation):
    """A wrist at -180 and at 180 degrees stands where it stood."""
    top = evaluation.worst.poses[0]
    one, other = (replace(top, q=(*top.q[:-1], turn)) for turn in (-math.pi, math.pi))
    result = replace(evaluation, worst=replace(evaluation.worst, poses=(one, other)))
    assert poses_that_differ(result) == (one,)


def test_what_rounding_leaves_is_no_load():
    """A joint that carries nothing along its axis says 0, not 5e-14 N."""
    load = JointLoad(
        revolute=True, axis=(0.0, 0.0, 1.0), force=(0.0, 50.0, 5e-14), moment=(4.0, 2e-29, 0.0), drive=2e-29
    )
    told = [words(cell) for row in joint_loads_told(SimpleNamespace(joint_loads=(load,))).rows for cell in row]
    assert told == ["1", "50 N", "4 N·m", "50 N", "0 N", "4 N·m", "0 N·m"]


def test_rigid_links_have_no_empty_card(evaluation):
    arm = evaluation.arm
    rigid = replace(arm.links[0], section=None, material=None, mass=1.0)
    drawn = sections_grid((("", replace(arm, links=(rigid, *arm.links[1:]))),))
    assert drawn.count('class="card"') == len(arm.links) - 1
    assert "Rigid, without a section: link 1." in drawn


@pytest.mark.parametrize("columns", [2, 3, 8])
def test_rows_too_wide_for_a_phone_tell_their_headings(columns):
    """They are taken apart there; what stands beside its name in one column fits."""
    heads = ["effect", *(f"figure {k}" for k in range(1, columns))]
    made = table_html(table(heads, [("backlash", *(count(k) for k in range(1, columns)))]))
    told = [f'data-head="figure {k}"' in made for k in range(1, columns)]
    assert told == [columns > 2] * (columns - 1)
    assert ('class="apart"' in made) == (columns > 2)


def test_rows_with_bars_tell_their_headings():
    """Where a phone takes the row apart, each figure says what it is, and a number at its head of what."""
    made = table_html(table(["joint", "could describe", ""], [(count(1), share(0.43), Bars((("after", 0.43),)))]))
    assert 'scope="row" data-head="joint"' in made
    assert '<td class="number" data-head="could describe"' in made


@pytest.mark.parametrize(("gap", "said"), [(3e-13, "no design is better"), (0.004, "more than 0.4 % better")])
def test_a_rest_of_the_solver_is_no_gap(result, gap, said):
    """A bound that is the design's own figure to all digits told leaves nothing better."""
    bounded = replace(result, bound_of="all_designs", lower_bound=result.objective * (1.0 - gap))
    assert bound_sentence(bounded).endswith(said)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (10.01, 9.985, "0.25 % smaller"),
        (9.985, 10.01, "0.25 % larger"),
        (2.0, 1.0, "2 times smaller"),
        (1.0, 1.0001, "unchanged"),
    ],
)
def test_small_changes_are_no_one_times_smaller(before, after, said):
    assert factor_words(before, after) == said


def test_a_table_of_thousands_leaves_the_page_small():
    """What is left out is counted, and said to be in the JSON."""
    made = table_html(table(["n", "what"], [(count(k), "x" * 100) for k in range(5000)]))
    assert len(made) < 50_000
    assert f"<summary>{MOST_FOLDED} more</summary>" in made
    assert f"and {5000 - MOST_ROWS - MOST_FOLDED} more, in the result's JSON" in made
    assert made.count("<tr>") == 2 + MOST_ROWS + MOST_FOLDED
