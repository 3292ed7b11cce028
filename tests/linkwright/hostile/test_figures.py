"""Figures beyond all arms and all readings: refused where they are read, or answered; never a traceback."""

import math

import pytest

from linkwright.core.arm.errors.lost_motion import played
from linkwright.core.arm.errors.model import beam_values, beams_of, error_model
from linkwright.core.diagnose.reading.settings import read_settings
from tests.linkwright.conftest import ARM, PROBLEM

HEADER = "q1_deg,q2_deg,x_mm,y_mm"


def reading(first, second):
    """A row at these angles (degrees), of the arm of the bench without errors."""
    a, b = math.radians(first), math.radians(first + second)
    x, y = 400.0 * math.cos(a) + 300.0 * math.cos(b), 400.0 * math.sin(a) + 300.0 * math.sin(b)
    return [f"{value:.4f}" for value in (first, second, x, y)]


ROWS = [reading(-80.0 + 17.0 * k, -90.0 + 19.0 * k) for k in range(10)]


def recording(rows=ROWS, header=HEADER):
    return "\n".join([header, *(",".join(row) for row in rows)]) + "\n"


SAID_OF_ARMS = [
    ("length: 400 mm", "length: 1e200 mm", "chain[1].link.length"),
    ("length: 400 mm", f"length: {'9' * 5000}", "5000 digits"),
    ("diameter: 60 mm", "diameter: 1e200 mm", "chain[1].link.section.diameter"),
    ("diameter: 60 mm", "diameter: 1e-300 mm", "chain[1].link.section.diameter"),
    ("mass: 2 kg", "mass: 1e200 kg", "payload.mass"),
    ("50 kN*m/rad", "1e-200 N*m/rad", "chain[2].joint.stiffness"),
    ("3 arcmin", "1e200 arcmin", "chain[1].joint.backlash"),
    ("type: revolute", "b" * 1000 + ": 1", "unknown key"),
    ("bench <arm> & co", '"a \\e[31mred\\e[0m arm"', "control character"),
]


@pytest.mark.parametrize(("old", "new", "named"), SAID_OF_ARMS)
def test_a_figure_of_no_arm_names_its_key(linkwright, bench, old, new, named):
    (bench / "arm.yaml").write_text(ARM.replace(old, new, 1))
    status, out, err = linkwright("evaluate", "arm.yaml")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith("arm.yaml: ")
    assert named in err
    assert "\x1b" not in err
    assert len(err) < 2200


@pytest.mark.parametrize("axis", ["[0, 0, 1e200]", "[0, 0, 1e-150]", "[0, 0, 1e-320]"])
def test_an_axis_is_a_direction_however_long(linkwright, bench, axis):
    """Whose square no float holds; below the least of floats it has none."""
    (bench / "arm.yaml").write_text(ARM.replace("type: revolute", f"type: revolute, axis: {axis}"))
    status, _, err = linkwright("inverse", "arm.yaml", "500 mm", "200 mm")
    assert (status, err) == (0, "") if axis != "[0, 0, 1e-320]" else status == 2


@pytest.mark.parametrize("direction", [[1e200, 1.0, 0.0], [1e-150, 0.0, 0.0], [1e308, 1e308]])
def test_so_is_the_direction_of_a_height(tmp_path, direction):
    asked = tmp_path / "recording.yaml"
    told = f"observes: along\ndirection: {direction}\n".replace("e+", ".0e+").replace("e-", ".0e-")
    asked.write_text(told, encoding="utf-8")
    assert math.hypot(*read_settings(asked).instrument.direction) == pytest.approx(1.0)


@pytest.mark.parametrize(("old", "new"), [("diameter: 60 mm", "diameter: 1e-6 mm"), ("50 kN*m/rad", "1e-9 N*m/rad")])
def test_an_arm_that_gives_without_end_has_no_answer(linkwright, bench, old, new):
    """Each figure may stand, but the arm of them does not."""
    (bench / "arm.yaml").write_text(ARM.replace(old, new, 1))
    status, out, err = linkwright("evaluate", "arm.yaml")
    assert (status, out, err.count("\n")) == (1, "", 1)
    assert "times its reach" in err


SAID_OF_PROBLEMS = [
    ('"<= 3 kg"', '"<= 1e200 kg"', "subject_to.mass"),
    ("[20 mm, 80 mm]", "[20 mm, 1e200 mm]", "subject_to.section_size[2]"),
    ("[20 mm, 80 mm]", "[1e-200 mm, 80 mm]", "subject_to.section_size[1]"),
    ("[20 mm, 80 mm]", "[1e-9 mm, 80 mm]", "subject_to.section_size"),
    ("500 mm, 200 mm", "1e200 mm, 200 mm", "workspace.path[1][1]"),
    ("20 N, 0 N", "1e200 N, 0 N", "load_cases[2].force[1]"),
    ("[500 mm, 200 mm], ", "[500 mm, 200 mm], " * 2000, "workspace.path"),
]


@pytest.mark.parametrize(("old", "new", "named"), SAID_OF_PROBLEMS)
def test_a_bound_of_no_problem_names_its_key(linkwright, bench, old, new, named):
    (bench / "problem.yaml").write_text(PROBLEM.replace(old, new, 1))
    status, out, err = linkwright("optimize", "problem.yaml")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"problem.yaml: {named}: " in err


SAID_OF_SETTINGS = [
    ("sigma: 1e-300 mm", "sigma"),
    ("sigma: 1e300 mm", "sigma"),
    ("encoding: undefined", "encoding"),
    ("encoding: punycode", "encoding"),
    ('encoding: "a\\0b"', "control character"),
    ("encoding: rot13", "encoding"),
    ("time_format: '%Z%Z'\ncolumns: {time_s: x_mm}", "time_format"),
    ("time_format: '%Q'\ncolumns: {time_s: x_mm}", "time_format"),
    (f"skip_rows: {10**18}", "skip_rows"),
    (f"skip_rows: {'9' * 5000}", "5000 digits"),
    ("observes: along\ndirection: [0, 0.0, 0]", "direction: "),
    (f"observes: along\ndirection: [{'9' * 400}, 0, 0]", "400 digits"),
    ("observes: along\ndirection: [.inf, 0, 0]", "direction[1]"),
]


@pytest.mark.parametrize(("settings", "named"), SAID_OF_SETTINGS)
def test_settings_beyond_sense_name_their_key(linkwright, bench, settings, named):
    (bench / "r.csv").write_text(recording())
    (bench / "recording.yaml").write_text(settings + "\n")
    status, out, err = linkwright("diagnose", "arm.yaml", "r.csv")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert named in err


@pytest.mark.parametrize("cell", ["1e200", "-1e308", "1e400", "9" * 400])
@pytest.mark.parametrize("column", [0, 2])
def test_a_cell_beyond_anything_measured_sets_its_row_aside(linkwright, bench, column, cell):
    """The others are read as they are without it."""
    rows = [list(row) for row in ROWS]
    rows[4][column] = cell
    (bench / "r.csv").write_text(recording(rows))
    status, _, err = linkwright("predict", "arm.yaml", "r.csv", "--json", "result.json")
    assert (status, err) == (0, "")
    assert '"rows": 9' in (bench / "result.json").read_text()


@pytest.mark.parametrize("cell", ["1e200", "1e400", "nan"])
def test_a_pose_of_a_plan_beyond_anything_is_left_out(linkwright, bench, cell):
    """As a recording's is; nothing is computed of it, and no warning reaches the screen."""
    (bench / "plan.csv").write_text(f"q1_deg,q2_deg,x_mm,y_mm\n{cell},0,,\n10,20,,\n30,20,,\n")
    status, _, err = linkwright("simulate", "arm.yaml", "--at", "plan.csv", "--out", "made.csv")
    assert (status, err) == (0, "")
    assert (bench / "made.csv").read_text().count("\n") == 3


def test_a_column_of_such_cells_is_refused(linkwright, bench):
    rows = [[*row, "1e200"] for row in ROWS]
    (bench / "r.csv").write_text(recording([[*row[:2], "1e200", row[3]] for row in rows]))
    status, _, err = linkwright("diagnose", "arm.yaml", "r.csv")
    assert status == 2
    assert "x_mm is 1e200, beyond anything measured" in err


SECTIONS = """\
format_version: {}
tables:
  - family: CHS
    shape: tube
    source: "own"
    columns: [{}, diameter_mm, thickness_mm]
    rows:
      - [mine, {}, 3.2]
"""


@pytest.mark.parametrize(
    ("version", "name", "diameter"),
    [
        ("1", "[name]", "60.3"),
        ("1", "{a: 1}", "60.3"),
        ("9" * 5000, "name", "60.3"),
        ("1", "name", "9" * 5000),
        ("1", "name", "1e200"),
        ("1", "name", ".nan"),
        ("1", "name", "[60.3]"),
    ],
)
def test_odd_tables_of_sections_are_one_line(linkwright, bench, version, name, diameter):
    (bench / "own.yaml").write_text(SECTIONS.format(version, name, diameter))
    status, _, err = linkwright("sections", "check", "own.yaml")
    assert (status, err.count("\n")) == (2, 1)
    assert err.startswith("own.yaml") or "own.yaml: " in err
    (bench / "own.yaml").write_text(SECTIONS.format("1", "name", "60.3"))
    assert linkwright("sections", "check", "own.yaml")[0] == 0


def test_references_as_text_are_one_line(linkwright, bench):
    (bench / "own.yaml").write_text("format_version: 1\nreferences: a book\nmaterials: {}\n")
    status, _, err = linkwright("materials", "check", "own.yaml")
    assert (status, err) == (2, "own.yaml: references: needs keys with values (key: value), not 'a book'\n")


def test_many_draws_of_play_need_no_memory_for_all_poses(bench):
    """A hundred thousand draws at 256 poses would be 700 MB; the quantile is that of each pose by itself."""
    import tracemalloc

    from linkwright.core.arm.files.read import read_arm

    (bench / "many.yaml").write_text(ARM + "play: {mode: statistical, draws: 100000}\n")
    arm = read_arm(bench / "many.yaml")
    model = error_model(arm).cases[0]
    p = beam_values(beams_of(arm))
    arrays = model.arrays([[0.01 * k, 0.2] for k in range(128)], p)
    tracemalloc.start()
    result = played(arrays, model.radii, "statistical", planar=True, statistics=arm.statistics)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 150e6
    alone = played(model.arrays([[0.05, 0.2]], p), model.radii, "statistical", planar=True, statistics=arm.statistics)
    assert result.error[5] == pytest.approx(alone.error[0], rel=1e-12)
