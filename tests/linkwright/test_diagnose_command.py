"""`linkwright diagnose` as people and scripts meet it: files, JSON, page, screen, redesign."""

import io
import json
import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from rich.console import Console

from linkwright.core.arm.chain.chain import Link
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.elastic.joint_compliance import drive_compliance
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.answer.sentences import said_of_no_weight
from linkwright.core.diagnose.result import Alternative, Detectable, FittedParameter
from linkwright.core.units.quantities import read_quantity
from linkwright.core.units.units import kinds
from linkwright.json.diagnosis import diagnosis_json, minimum_detectable
from linkwright.json.parameters import in_unit, unit_of
from linkwright.output.diagnosis_folder import compensated, residuals
from linkwright.output.files import json_text
from linkwright.report.charts.covariates import covariates
from linkwright.report.described import page_of
from linkwright.report.pictures.svg import Plot, binned, round_ticks
from linkwright.results.diagnoses.answer import answer, to_do
from linkwright.results.diagnoses.described import describe
from linkwright.results.diagnoses.evidence import ladder
from linkwright.results.diagnoses.words import effect_words, interval, value
from linkwright.results.document import Table
from linkwright.results.figures_in_words import figure, from_to, mm
from linkwright.screen.described import show
from tests.diagnose.made_diagnosis import RECORDED, made_arm, made_diagnosis, write_recording
from tests.linkwright.reports.test_report import Page

VERDICTS = ("none", "named", "alias_class", "unknown", "insufficient_data")
CONTRACT = {
    "verdict",
    "noise_floor_mm",
    "rms_before_mm",
    "rms_after_mm",
    "rms_after_held_out_mm",
    "missing",
    "where",
    "unknown",
    "rejected_rows",
    "minimum_detectable_mm",
    "next_poses",
}


@pytest.fixture(scope="module", params=VERDICTS)
def diagnosis(request):
    return made_diagnosis(request.param)


def test_json_keeps_the_contract(diagnosis):
    """Every key of the contract, strict JSON, and lengths in mm."""
    content = json.loads(json_text(diagnosis_json(diagnosis)))
    assert content.keys() >= CONTRACT
    assert content["verdict"] == diagnosis.verdict
    assert content["rms_before_mm"] == pytest.approx(1e3 * diagnosis.rms_before)
    assert content["where"].keys() >= {"joint", "depends_on", "direction", "since_s"}
    assert content["rejected_rows"] == [17, 40]
    assert content["next_poses"] == [pytest.approx([math.degrees(x) for x in e.q]) for e in diagnosis.next_poses]
    if diagnosis.verdict == "unknown":
        assert content["unknown"].keys() >= {"depends_on", "amplitude_mm", "shape", "rejected", "since_s"}
        assert (content["missing"], content["where"]["since_s"]) == ([], 700.0)
    else:
        assert content["unknown"] is None


def test_findings_in_json():
    """A finding as the contract's example writes it: places from 1, units beside values, alternatives as pairs."""
    content = diagnosis_json(made_diagnosis("alias_class"))["missing"]
    assert [(item["effect"], item["at"], item["alternatives"]) for item in content] == [
        ("joint_compliance", [2], [["link_bending", [2]]])
    ]
    fitted = content[0]["parameters"]["compliance_2"]
    assert (fitted["value"], fitted["unit"]) == (pytest.approx(2.1e-5), "rad/(N*m)")
    assert fitted["ci95"] == pytest.approx([2.0e-5, 2.2e-5])


@pytest.mark.parametrize("kind", sorted(kinds()))
def test_units_of_json_read_back(kind):
    """What JSON writes of any kind of quantity is the SI value again when read with its unit."""
    value = 312.5 if kind == "temperature" else 0.0125
    written = in_unit(value, kind)
    text = f"{written} {unit_of(kind)}".strip()
    given = float(text) if kind == "dimensionless" else text
    assert read_quantity(given, kind, file="", key="") == pytest.approx(value, rel=1e-9)


def test_minimum_detectable_is_that_of_the_worst_visible_place():
    """The largest over places that show the effect; null where none does."""
    sizes = minimum_detectable(made_diagnosis())
    assert sizes == {
        "backlash": pytest.approx(0.03),
        "encoder_offset": None,
        "clearance": None,
        "joint_compliance": pytest.approx(0.008),
    }


def test_nothing_unknown_becomes_nan():
    """What cannot be known is null in JSON, a dash for people."""
    fitted = FittedParameter("lag", "lag", (), "time", math.nan, (0.0, math.inf))
    finding = replace(made_diagnosis().findings[0], parameters=(fitted,), p_value=math.nan)
    diagnosis = replace(made_diagnosis(), findings=(finding,), noise_floor=None, rms_after_held_out=math.nan)
    text = json_text(diagnosis_json(diagnosis))
    assert "NaN" not in text
    assert "Infinity" not in text
    assert json.loads(text)["missing"][0]["parameters"]["lag"]["ci95"] == [0.0, None]
    assert value(fitted).text == interval(fitted).text == "–"
    assert "nan" not in Page(page_of(describe(diagnosis))).text.lower()


@pytest.mark.parametrize(
    ("size", "ends", "words"),
    [
        (2.1e-5, (2.0e-5, 2.2e-5), ("21 urad/(N·m)", "20 to 22 urad/(N·m)")),
        (2.0988e-5, (2.0798e-5, 2.1178e-5), ("21 urad/(N·m)", "20.8 to 21.2 urad/(N·m)")),
        (-2.1e-5, (-2.5e-5, -1.7e-5), ("−21 urad/(N·m)", "−25 to −17 urad/(N·m)")),
    ],
)
def test_figures_have_the_digits_that_their_interval_supports(size, ends, words):
    fitted = FittedParameter("compliance_2", "compliance", (2,), "compliance", size, ends)
    assert (value(fitted).text, interval(fitted).text) == words


@pytest.fixture(scope="module", params=[*VERDICTS, "in space"])
def page(request):
    """The report of each verdict, and of an arm in space."""
    if request.param == "in space":
        return Page(page_of(describe(made_diagnosis("named", made_arm(space=True)))))
    return Page(page_of(describe(made_diagnosis(request.param))))


def test_page_is_whole_and_loads_nothing(page):
    assert page.open == []
    assert "link" not in {tag for tag, _ in page.tags}
    for tag, attributes in page.tags:
        for name in ("src", "href", "srcset", "data", "xlink:href", "action"):
            assert name not in attributes, (tag, attributes)


def test_page_opens_with_the_plain_sentence():
    """First the heading, then the answer and what to do, then the whole sentence, then all figures."""
    diagnosis = made_diagnosis("unknown")
    text = Page(page_of(describe(diagnosis))).text
    places = [text.index(part) for part in (answer(diagnosis), *to_do(diagnosis), diagnosis.sentence, "RMS of the")]
    assert places == sorted(places)


@pytest.mark.parametrize("effect", sorted(EFFECTS))
def test_the_answer_has_at_most_thirty_words(effect):
    """However long an effect's name is, and whatever else was found: what, where and its share stand in it."""
    made = made_diagnosis("alias_class")
    first = replace(made.findings[0], effect=effect)
    bare = replace(first, effect="joint_compliance", alternatives=(), rms_explained=0.1 * first.rms_explained)
    for findings in ((first,), (replace(first, alternatives=()),), (first, *(bare for _ in range(7)))):
        said = answer(replace(made, findings=findings))
        assert len(said.split()) <= 30
        assert effect_words(effect, first.at)[1:].split(" (")[0] in said
        assert said.endswith(".")
    share = 100.0 * (1.0 - (made.ladder[1].rms / made.ladder[0].rms) ** 2)
    said = answer(replace(made, findings=(first,)))
    assert f"({figure(share, 2)} % of the mismatch)" in said
    assert f"Error {from_to(mm(made.rms_before, 3), mm(made.rms_after, 3))}" in said


def test_the_answer_of_every_verdict_is_short(diagnosis):
    assert len(answer(diagnosis).split()) <= 30


def test_an_arm_without_weight_is_told_first():
    """Before the largest cause, with what to write; not where gravity is none, a link weighs, or nothing was found."""
    made = made_diagnosis("named")
    bare = tuple(Link(link.length, mass=0.0) for link in made.arm.links)
    light = replace(made.arm, links=bare, joints=tuple(replace(joint, mass=0.0) for joint in made.arm.joints))
    said = answer(replace(made, arm=light))
    assert said.startswith("All links weigh 0 kg here. Found: ")
    assert len(said.split()) <= 30
    assert "`mass: unknown`" in to_do(replace(made, arm=light))[0]
    assert said_of_no_weight(light, "unknown").startswith("All links weigh 0 kg")
    for arm in (
        replace(light, gravity=(0.0, 0.0, 0.0)),
        light.with_links((*bare[:-1], replace(bare[-1], mass=0.1))),
        light.with_links((*bare[:-1], replace(bare[-1], mass=None))),
        made.arm,
    ):
        assert not said_of_no_weight(arm, "named")
        assert "weigh 0 kg" not in answer(replace(made, arm=arm))
    assert not said_of_no_weight(light, "none")


@pytest.mark.parametrize(
    ("effect", "other", "has", "asked"),
    [
        ("joint_compliance", ("servo_droop", (2,)), {}, "c2_deg"),
        ("joint_compliance", ("link_bending", (2,)), {}, "j2_deg"),
        ("joint_compliance", ("link_bending", (2,)), {"joint_side": np.zeros((72, 3))}, None),
        ("encoder_offset", ("base_compliance", ()), {}, "basex_mm, basey_mm"),
        ("joint_compliance", ("thermal_expansion", (2,)), {"temperature": None}, "temperature_degC"),
    ],
)
def test_what_would_tell_is_named_by_its_column(effect, other, has, asked):
    """A drive that gives and a servo that droops differ by the command; a link that bends by a joint-side encoder."""
    made = made_diagnosis("alias_class")
    finding = replace(made.findings[0], effect=effect, alternatives=(Alternative(*other, 0.999, 0.3),))
    result = replace(made, findings=(finding,), recording=replace(made.recording, **has))
    logged = [line for line in to_do(result) if line.startswith("Log ")]
    assert (asked in logged[0]) if asked else not logged


@pytest.mark.parametrize(("likeness", "same"), [(1.0 - 1e-13, True), (0.9999, False)])
def test_one_geometry_under_two_names_asks_for_no_encoder(likeness, same):
    """A link's length and the next axis shifted along it: no encoder tells them, and where they are alike either will
    do."""
    made = made_diagnosis("alias_class")
    other = Alternative("axis_misalignment", (3,), likeness, 9.0)
    finding = replace(made.findings[0], effect="link_length", at=(2,), alternatives=(other,))
    lines = to_do(replace(made, findings=(finding,)))
    assert not [line for line in lines if line.startswith("Log ")]
    assert any("are the same geometrically here: correct either." in line for line in lines) is same


def test_small_findings_stand_below_by_their_cause():
    """What held-out readings hardly need is told in one line, with what it moves together, and in a separate table."""
    made = made_diagnosis("named")
    small = replace(made.findings[0], effect="encoder_offset", at=(3,), small=True)
    result = replace(made, findings=(*made.findings, small), small_together=2e-6)
    page = Page(page_of(describe(result))).text
    assert f"Small, together 2 µm: {EFFECTS[small.effect].cause}: " in page or "Small, together 0.002 mm: " in page
    assert "Small, together" not in Page(page_of(describe(made))).text
    content = diagnosis_json(result)
    assert [item["small"] for item in content["missing"]] == [*([False] * len(made.findings)), True]
    assert content["small_together_mm"] == pytest.approx(0.002)


def test_that_there_is_another_cause_is_said_before_every_name_of_the_first():
    """However many names the data cannot tell apart: the answer is of all that was found, and each joint is ringed."""
    made = made_diagnosis("named")
    names = ("servo_droop", "joint_hardening", "creep")
    alike = tuple(Alternative(name, made.findings[0].at, 1.0, 0.0) for name in names)
    first = replace(made.findings[0], effect="joint_compliance", alternatives=alike)
    second = replace(first, effect="encoder_offset", at=(3,), alternatives=())
    result = replace(made, findings=(first, second))
    assert "or 3 like it" in answer(result)
    assert f" and 1 smaller cause. Error {from_to(mm(made.rms_before, 3), mm(made.rms_after, 3))}" in answer(result)
    assert len(answer(result).split()) <= 30
    assert "or 2 more" in answer(replace(made, findings=(first,)))
    page = page_of(describe(result))
    assert page.count('class="mark"') == len({*first.at, 3})
    assert "joints 2 and 3 are ringed" in page


def test_the_ladder_is_drawn_to_scale():
    """Beside each model a bar goes by what it leaves of the largest."""
    made = made_diagnosis("named")
    (rows,) = (item.rows for item in ladder(made).items if isinstance(item, Table))
    shares = [dict(row[-1].bars)["after"] for row in rows]
    assert shares[1] / shares[0] == pytest.approx(made.ladder[1].rms / made.ladder[0].rms)
    assert max(share for row in rows for _, share in row[-1].bars) == pytest.approx(1.0)


def test_page_says_everything_that_was_found():
    """Findings, aliases, ladder, rejected forms, detectable sizes, next poses, standards, rows set aside, notes."""
    diagnosis = made_diagnosis("alias_class")
    text = Page(page_of(describe(diagnosis))).text
    for words in (
        "21 urad/(N·m)",
        "20 to 22 urad/(N·m)",
        "What the data cannot tell apart",
        "bending of the links (link 2)",
        *(rung.label for rung in diagnosis.ladder),
        *(form.reason for form in diagnosis.rejected_forms),
        "joint 2 is ringed",
        "28.65°, −14.32°, 90°",
        diagnosis.next_poses_note,
        "pose repeatability",
        *(row.reason for row in diagnosis.rejected_rows),
        *diagnosis.notes,
        *diagnosis.null_vectors,
        *diagnosis.recording.warnings,
    ):
        assert words in text, words


def test_page_describes_the_unknown():
    text = Page(page_of(describe(made_diagnosis("unknown")))).text
    for words in ("a step of 0.28 mm at 700 s", "it grows evenly, the mismatch does not", "step in time", "93 %"):
        assert words in text


def test_pictures_need_no_script():
    """Arrow maps before and after and a plot for every covariate are SVG in the page itself."""
    diagnosis = made_diagnosis()
    source = page_of(describe(diagnosis))
    for label in ("Residuals before over the workspace", "Residuals after over the workspace"):
        assert f'aria-label="{label}' in source
    names = [covariate.name for covariate in covariates(diagnosis)]
    assert names == ["q1", "q2", "q3", "dir1", "dir2", "dir3", "payload_kg", "temperature_degC", "time"]
    assert source.count('aria-label="Residuals against') == len(names)


def test_arrows_run_from_model_to_measured():
    """Arrows start where the tip nominally is and have the residual's direction, y up on the page."""
    diagnosis = made_diagnosis()
    source = page_of(describe(diagnosis))
    start = source.index('aria-label="Residuals before over the workspace')
    svg = source[source.rindex("<svg", 0, start) : source.index("</svg>", start) + 6]
    paths = [e.attrib["d"] for e in ET.fromstring(svg).iter("path") if e.attrib["class"] == "arrows before"]
    strokes = [piece.split("L") for piece in paths[0][1:].split("M")]
    moved = [
        np.subtract(*(np.array(point.split(","), dtype=float) for point in reversed(stroke)))
        for stroke in strokes
        if len(stroke) == 2
    ]
    expected = diagnosis.residual_before * [1.0, -1.0]
    assert len(moved) == len(expected)
    scale = np.linalg.norm(moved) / np.linalg.norm(expected)
    assert np.abs(np.array(moved) - scale * expected).max() < 0.15  # tenths of a unit are written


def test_dots_stand_where_the_data_is():
    plot = Plot(100.0, 50.0, (0.0, 10.0), (-1.0, 1.0), left=5.0, top=2.0)
    assert plot.x(np.array([0.0, 5.0, 10.0])).tolist() == [5.0, 55.0, 105.0]
    assert plot.y(np.array([-1.0, 1.0])).tolist() == [52.0, 2.0]


@pytest.mark.parametrize("span", [(0.0, 1.0), (-0.37, 0.41), (1234.0, 1239.0), (-1e-4, 3e-4), (0.0, 7.0), (5.0, 5.0)])
def test_ticks_are_round_and_within(span):
    ticks = round_ticks(*span)
    assert 1 <= len(ticks) <= 6
    assert all(span[0] - 1e-9 <= tick <= span[1] + 1e-9 for tick in ticks)
    if len(ticks) > 2:
        steps = {round((b - a) / (ticks[1] - ticks[0]), 6) for a, b in pairwise(ticks)}
        assert steps == {1.0}


def test_bins_hold_means():
    """Few values: one mean each; many: equal numbers."""
    x, y = np.array([1.0, 1.0, 2.0]), np.array([0.0, 2.0, 5.0])
    assert [part.tolist() for part in binned(x, y)] == [[1.0, 2.0], [1.0, 5.0]]
    x = np.arange(120.0)
    middle, mean = binned(x, 3.0 * x, bins=12)
    assert len(middle) == 12
    assert np.allclose(mean, 3.0 * middle)


def test_many_readings_stay_a_page_of_bearable_size():
    """12,000 readings do not become 12,000 arrows, dots and texts."""
    small = made_diagnosis()
    count = 12_000
    pick = np.arange(count) % small.recording.size
    big = replace(
        small,
        recording=replace(
            small.recording.kept(np.ones(small.recording.size, dtype=bool)),
            **{
                name: getattr(small.recording, name)[pick]
                for name in ("q", "tip", "row", "time", "sides", "payload_mass", "temperature")
            },
        ),
        residual_before=small.residual_before[pick],
        residual_after=small.residual_after[pick],
    )
    assert len(page_of(describe(big))) - len(page_of(describe(small))) < 3_000_000


def test_screen_tells_the_same(diagnosis):
    """The sentence first; parameters with intervals, the ladder, next poses, rows set aside."""
    out = io.StringIO()
    show(Console(file=out, width=110, highlight=False, markup=False), describe(diagnosis))
    text = out.getvalue()
    assert text.startswith(answer(diagnosis))
    assert diagnosis.sentence in text
    for words in ("Row 17 is set aside", diagnosis.next_poses_note, "noise floor"):
        assert words in text
    if diagnosis.findings:
        assert "20 to 22 urad/(N·m)" in " ".join(text.split())
        assert "+ joint_compliance at 2" in text
    if diagnosis.verdict == "none":
        assert "would have been found from" in text


def test_residuals_file():
    """A line a reading: measured less modelled in mm."""
    diagnosis = made_diagnosis()
    table = residuals(diagnosis)
    assert table.row.tolist() == diagnosis.recording.row.tolist()
    assert np.allclose(table[["before_x_mm", "before_y_mm"]], 1e3 * diagnosis.residual_before, atol=1e-8)
    assert np.allclose(table.after_mm, 1e3 * np.linalg.norm(diagnosis.residual_after, axis=1), atol=1e-8)
    assert np.allclose(np.radians(table[["q1_deg", "q2_deg", "q3_deg"]]), diagnosis.recording.q, atol=1e-9)


def test_compensation_file_only_for_what_is_unknown():
    assert compensated(made_diagnosis("named")) is None
    unknown = made_diagnosis("unknown")
    table = compensated(unknown)
    assert np.allclose(table[["dx_mm", "dy_mm"]], 1e3 * unknown.unknown.predicted, atol=1e-8)


@pytest.mark.parametrize("command", ["diagnose", "compare", "compensate"])
def test_help_shows_an_example(linkwright, command):
    status, out, _ = linkwright(command, "--help")
    assert status == 0
    assert f"Example: linkwright {command}" in " ".join(out.split())


# The command itself, with the real reader and engine.


def test_command_end_to_end(linkwright, bench):
    """Exit 0, four files, the effect (or its class) named with an interval that holds the truth, an arm that reads."""
    write_recording(bench)
    status, out, err = linkwright("diagnose", "arm.yaml", "recording.csv", "--out", "res", "--json", "d.json")
    assert (status, err) == (0, "")
    assert {path.name for path in (bench / "res").iterdir()} == {
        "report.html",
        "diagnosis.json",
        "arm.yaml",
        "residuals.csv",
    }
    content = json.loads((bench / "d.json").read_text(encoding="utf-8"))
    assert content == json.loads((bench / "res" / "diagnosis.json").read_text(encoding="utf-8"))
    result = content["missing"][0]
    names = [[result["effect"], result["at"]], *result["alternatives"]]
    assert ["joint_compliance", [2]] in names
    assert content["sentence"] in out
    corrected = read_arm(bench / "res" / "arm.yaml")
    assert drive_compliance(corrected, 1) == pytest.approx(1.0 / 50e3 + RECORDED, rel=0.05)
    # An earlier diagnosis may be replaced; anybody else's folder may not.
    assert linkwright("diagnose", "arm.yaml", "recording.csv", "--out", "res")[0] == 0
    (bench / "res" / "mine.txt").write_text("keep", encoding="utf-8")
    assert linkwright("diagnose", "arm.yaml", "recording.csv", "--out", "res")[0] == 2


def test_command_exits_with_0_whatever_the_verdict(linkwright, bench):
    """Nothing missing is an answer."""
    write_recording(bench, 0.0)
    status, _, _ = linkwright("diagnose", "arm.yaml", "recording.csv", "--json", "d.json")
    content = json.loads((bench / "d.json").read_text(encoding="utf-8"))
    assert (status, content["verdict"], content["missing"]) == (0, "none", [])
    assert content["minimum_detectable_mm"]["joint_compliance"] > 0.0


def test_effects_can_be_taken_out(linkwright, bench):
    write_recording(bench)
    taken = ("--without-effect", "joint_compliance", "--without-effect", "servo_droop")
    assert linkwright("diagnose", "arm.yaml", "recording.csv", "--json", "d.json", *taken)[0] == 0
    content = json.loads((bench / "d.json").read_text(encoding="utf-8"))
    named = {item["effect"] for item in content["missing"]}
    named |= {name for item in content["missing"] for name, _ in item["alternatives"]}
    assert not named & {"joint_compliance", "servo_droop"}


WRONG = [
    (("arm.yaml", "none.csv"), "none.csv"),
    (("none.yaml", "recording.csv"), "none.yaml"),
    (("arm.yaml", "recording.csv", "--without-effect", "join_compliance"), "did you mean 'joint_compliance'"),
    (("arm.yaml", "recording.csv", "--recording-yaml", "none.yaml"), "none.yaml"),
    (("arm.yaml", "recording.csv", "--json", "recording.csv"), "input"),
    (("arm.yaml", "recording.csv", "--problem", "none.yaml"), "none.yaml"),
    (("arm.yaml", "recording.csv", "--out", "."), "other files"),
]


@pytest.mark.parametrize(("arguments", "named"), WRONG, ids=lambda value: str(value)[:40])
def test_wrong_input_is_one_line(linkwright, bench, arguments, named):
    write_recording(bench)
    status, _, err = linkwright("diagnose", *arguments)
    assert status == 2
    assert len(err.splitlines()) == 1
    assert named in err


def test_detectable_needs_to_be_visible():
    """A place that shows nothing does not hide one that does."""
    hidden = Detectable("backlash", (3,), 1.0, "total", "angle", 1.0, 0.0)
    diagnosis = made_diagnosis()
    more = replace(diagnosis, detectable=(hidden, *diagnosis.detectable))
    assert minimum_detectable(more) == minimum_detectable(diagnosis)
