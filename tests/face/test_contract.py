"""The public face: exactly the names that are promised, each told of, loaded late, and behaving as written."""

import dataclasses
import doctest
import importlib
import json
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import numpy as np
import pandas as pd
import plotly.graph_objects as go
import pytest

import linkwright as lw
from linkwright.cli import run

ROOT = Path(__file__).resolve().parents[2]
BACKLASH = ROOT / "examples" / "hidden-backlash"
WELDING = ROOT / "examples" / "welding-arm"

PROMISED = {
    *("read_arm", "Arm", "Joint", "Link", "evaluate", "read_problem", "Problem", "optimize", "tradeoff"),
    *(
        "read_recording",
        "read_recordings",
        "read_log",
        "columns",
        "diagnose",
        "predict",
        "compare",
        "compensate",
        "simulate",
        "redesign",
    ),
    *(
        "shapes",
        "materials",
        "sections",
        "actuators",
        "effects",
        "instruments",
        "limits",
        "inverse",
        "seam",
        "paper_tables",
        "paper_figures",
    ),
    *("import_arm", "export_arm", "budget", "plan", "watch", "write_table", "sweep", "show"),
    *("Effect", "Parameter", "Settings", "Twist", "traits", "PoseState", "drive_motion"),
    *("Shape", "Dimension", "numeric"),
    *("Figure", "OfDesign", "OfKinds", "OfLinks", "at_poses"),
    *("InputError", "NoAnswer", "MissingProperty", "Processes", "Cluster"),
}
HEAVY = ("casadi", "pandas", "scipy", "plotly", "numpy", "pint", "rich", "typer")


@pytest.fixture
def arm():
    """A planar arm of two links, built from parts."""
    return lw.Arm(
        chain=[
            (
                lw.Joint(range=["-90 deg", np.pi / 2], backlash="3 arcmin"),
                lw.Link(length=0.4, section=lw.shapes.Circle(diameter="60 mm"), material=lw.materials["steel-s355"]),
            ),
            (
                lw.Joint(range=["-100 deg", "100 deg"], stiffness=5e4),
                lw.Link(
                    length="300 mm",
                    section={"shape": "circle", "diameter": 0.05},
                    material={"elastic_modulus": 71e9, "poisson_ratio": 0.33, "density": "2700 kg/m^3"},
                ),
            ),
        ],
        payload={"mass": 2},
        name="bench",
    )


def python(code):
    """What a fresh process prints."""
    environment = {"PYTHONPATH": str(ROOT)}
    call = [sys.executable, "-c", code]
    return subprocess.run(call, cwd=ROOT, capture_output=True, text=True, check=True, env=environment).stdout.strip()


def test_names_are_those_promised():
    """All of them, and nothing else."""
    assert set(lw.__all__) == PROMISED
    assert lw.__all__ == sorted(lw.__all__)
    with pytest.raises(AttributeError):
        _ = lw.optimise


def test_version_is_that_of_the_distribution():
    """By the name that Python's modules have it by."""
    assert lw.__version__ == metadata.version("linkwright")


def test_import_alone_loads_nothing():
    """Nor does asking for an error; an arm needs neither solver nor tables."""
    shown = python(f"import sys, linkwright; print([m for m in {HEAVY} if m in sys.modules], len(linkwright.__all__))")
    assert shown == f"[] {len(PROMISED)}"
    code = "import sys, linkwright as lw; lw.Arm; print([m for m in ('pandas', 'plotly') if m in sys.modules])"
    assert python(code) == "[]"


@pytest.mark.parametrize("name", sorted(PROMISED - {"InputError", "NoAnswer", "MissingProperty"}))
def test_each_name_has_a_docstring_with_an_example(name):
    """An example that doctest finds; `tests/face/test_doctests.py` runs them."""
    thing = getattr(lw, name)
    told = thing.__doc__ or type(thing).__doc__
    assert told
    assert doctest.DocTestParser().get_examples(told)


def test_arm_is_built_as_a_file_is_read(arm, tmp_path):
    """Text and numbers in SI mean the same, and what is written reads back as the same arm."""
    arm.save(tmp_path / "arm.yaml")
    read = lw.read_arm(str(tmp_path / "arm.yaml"))
    assert read.to_yaml() == arm.to_yaml()
    assert lw.evaluate(read).max_error_mm == pytest.approx(lw.evaluate(arm).max_error_mm, rel=1e-9)
    joint, link = arm.model.joints[0], arm.model.links[0]
    assert joint.range == pytest.approx((-np.pi / 2, np.pi / 2))
    assert link.length == 0.4


def test_replace_gives_a_new_arm(arm):
    """The old one stays; keys that are not in the file yet can be set, and taken out."""
    longer = arm.replace("chain[1].link.length", "430 mm")
    assert (longer.model.links[0].length, arm.model.links[0].length) == (0.43, 0.4)
    assert arm.replace("chain[2].joint.clearance", 25e-6).model.joints[1].clearance == 25e-6
    assert arm.replace("payload.force", ["0 N", -5.0, "0 N"]).model.payload.force == (0.0, -5.0, 0.0)
    assert arm.replace("payload", None).model.payload.mass == 0.0
    with_effect = arm.replace("effects", [{"effect": "encoder_offset", "at": 2, "offset": "0.05 deg"}])
    assert with_effect.replace("effects[1].at", 1).model.effects[0].at == (1,)
    with pytest.raises(dataclasses.FrozenInstanceError):
        arm.model = longer.model


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("chain[1].link.lenght", "430 mm", "did you mean 'length'?"),
        ("chian[1].link.length", "430 mm", "did you mean 'chain'?"),
        ("chain[3].link.length", "430 mm", "the list holds 2"),
        ("chain[1].link.length", "430 kg", "is a mass, not a length"),
        ("chain[1].link.length.unit", "mm", "has no keys"),
        ("paylod.mass", "2 kg", "did you mean 'payload'?"),
        ("chain..link", 1, "is no key"),
    ],
)
def test_replace_says_what_is_wrong(arm, key, value, words):
    """In one line, with what would do."""
    with pytest.raises(lw.InputError) as error:
        arm.replace(key, value)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_evaluation(arm, tmp_path):
    """Figures, tables with units, a picture, and the same JSON and files as the command."""
    result = lw.evaluate(arm)
    assert 0.0 < result.max_error_mm <= result.upper_bound_mm
    assert result.worst_poses["error_mm"].iloc[0] == pytest.approx(result.max_error_mm)
    assert {"q1_deg", "q2_deg", "load_case"} <= set(result.worst_poses.columns)
    assert list(result.by_effect.columns) == ["effect", "title", "error_mm"]
    assert result.mass_kg > 0.0
    given = tmp_path / "arm.yaml"
    arm.save(given)
    read = lw.evaluate(given)
    assert run(["evaluate", str(given), "--json", str(tmp_path / "a.json"), "--out", str(tmp_path / "out")]) == 0
    assert (tmp_path / "a.json").read_text(encoding="utf-8") == read.to_json()
    read.save(tmp_path / "saved", made_from=[given])
    same_files(tmp_path / "out", tmp_path / "saved")
    a_result(read)


def a_result(result):
    """What every result has: one line, a page for a notebook, a picture, JSON, tables; frozen."""
    line = repr(result)
    assert line.startswith(f"<{type(result).__name__}: ")
    assert "\n" not in line
    assert len(line) < 300
    assert "<table" in result._repr_html_()
    assert isinstance(result.plot(), go.Figure)
    assert json.loads(result.to_json())["made_by"].startswith("linkwright ")
    with pytest.raises(dataclasses.FrozenInstanceError):
        result.found = None


def same_files(one, other, *, but=()):
    """Two folders hold the same files, those of `but` aside."""
    names = {path.name for path in one.iterdir()}
    assert names == {path.name for path in other.iterdir()}
    for name in names - set(but):
        assert (one / name).read_bytes() == (other / name).read_bytes(), name


@pytest.fixture(scope="module")
def problem():
    """A problem of seconds."""
    return lw.Problem(
        arm=WELDING / "arm.yaml",
        workspace={"path": [["600 mm", "300 mm"], ["700 mm", 0.3]]},
        subject_to={"mass": "<= 30 kg", "section_size": [0.02, "150 mm"]},
        choose={"section": ["circle"], "same": ["size"]},
    )


@pytest.mark.slow
def test_interrupt_leaves_the_best_so_far(problem):
    """Once a design is finished; before that there is nothing to give."""

    def impatient(text, share):
        del share
        if text.startswith("solving from further starts"):
            raise KeyboardInterrupt

    best = lw.optimize(problem, progress=impatient)
    assert best.interrupted
    assert "interrupted" in repr(best)
    assert best.found.after.max_error < best.before.found.max_error

    def at_once(iteration):
        del iteration
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        lw.optimize(problem, log=at_once)


def test_problem_is_checked_as_its_file_is(problem):
    """Unknown keys, points out of reach, and what a material lacks."""
    with pytest.raises(lw.InputError, match="did you mean 'minimize'"):
        lw.Problem(arm=WELDING / "arm.yaml", minimise="mass")
    lacking = problem.arm.replace("chain[1].link.material", {"elastic_modulus": "71 GPa", "poisson_ratio": 0.33})
    with pytest.raises(lw.MissingProperty, match="density"):
        lw.evaluate(lacking)
    with pytest.raises(lw.NoAnswer, match="cannot be reached"):
        lw.inverse(problem.arm, "5 m", "0 m")


@pytest.mark.slow
def test_a_limit_that_nobody_can_keep_is_named(problem):
    with pytest.raises(lw.NoAnswer, match="max_error"):
        lw.optimize(problem.replace("subject_to.max_error", "<= 0.05 mm"))


def test_inverse_reaches_the_point(arm):
    """Both elbows."""
    result = lw.inverse(arm, "450 mm", 0.3)
    assert len(result.table) == 2
    for pose in result.found:
        first, second = pose.q
        tip = (0.4 * np.cos(first) + 0.3 * np.cos(first + second), 0.4 * np.sin(first) + 0.3 * np.sin(first + second))
        assert tip == pytest.approx((0.45, 0.3), abs=1e-8)
    a_result(result)


def test_recording_from_a_data_frame(tmp_path):
    """The same columns give the same readings; several are read one by one."""
    arm = lw.read_arm(BACKLASH / "arm.yaml")
    rec = lw.read_recording(BACKLASH / "recording.csv", arm)
    again = lw.read_recording(pd.read_csv(BACKLASH / "recording.csv"), arm)
    assert np.array_equal(rec.found.tip, again.found.tip)
    rec.save(tmp_path / "copy.csv")
    pair = lw.read_recordings([tmp_path / "copy.csv", str(BACKLASH / "after-service.csv")], arm)
    assert pair[0].found.tip == pytest.approx(rec.found.tip, abs=1e-8)
    with pytest.raises(lw.InputError, match="x_mm"):
        lw.read_recording(rec.table.drop(columns="x_mm"), arm)


def test_simulation_is_the_command_s(tmp_path):
    """The same seed, the same file and JSON."""
    entry = "{effect: encoder_offset, at: 2, offset: 0.05 deg}"
    arguments = ["simulate", str(WELDING / "arm.yaml"), "--poses", "6", "--with", entry]
    assert run([*arguments, "--out", str(tmp_path / "a.csv"), "--json", str(tmp_path / "a.json")]) == 0
    effect = {"effect": "encoder_offset", "at": 2, "offset": np.radians(0.05)}
    made = lw.simulate(WELDING / "arm.yaml", poses=6, with_=[effect])
    made.save(tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert (tmp_path / "a.json").read_text(encoding="utf-8") == made.to_json()
    with pytest.raises(lw.InputError, match="did you mean 'both'"):
        lw.simulate(WELDING / "arm.yaml", poses=6, sides="boht")


def test_compensation_is_the_command_s(tmp_path):
    """The same table and JSON."""
    arguments = ["compensate", str(WELDING / "arm.yaml"), "--grid", "3", "--payload", "1 kg"]
    assert run([*arguments, "--out", str(tmp_path / "a.csv"), "--json", str(tmp_path / "a.json")]) == 0
    result = lw.compensate(WELDING / "arm.yaml", grid=3, payload=1.0)
    result.save(tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    assert (tmp_path / "a.json").read_text(encoding="utf-8") == result.to_json()
    a_result(result)


def test_catalogues_are_mappings():
    """Names, members and what is near."""
    assert "steel-s355" in lw.materials
    assert len(list(lw.materials)) == len(lw.materials)
    assert lw.materials["steel-s355"].at(353.15) == lw.materials["steel-s355"].at("80 degC")
    assert "RectangularTube" in dir(lw.shapes)
    with pytest.raises(lw.InputError, match="thickness"):
        lw.shapes.RectangularTube(width="80 mm", height="120 mm")
    assert lw.effects["backlash"].id == "backlash"
    assert "backlash" in lw.effects
    mine = dataclasses.replace(lw.effects["payload"], id="my_payload")
    lw.effects.register(mine)
    try:
        assert lw.effects["my_payload"] is mine
        lw.effects.check(mine)
    finally:
        lw.effects.withdraw("my_payload")
    assert "my_payload" not in lw.effects
    assert importlib.import_module("linkwright.core.arm.effects").EFFECTS["clearance"] is lw.effects["clearance"]


def test_the_name_of_a_file_is_no_chain():
    with pytest.raises(lw.InputError, match=r"lw.read_arm\('arm.yaml'\)"):
        lw.Arm("arm.yaml")


def test_what_is_no_file_is_told_by_the_name_of_its_argument():
    """An arm where a problem is due, arguments the wrong way round, a number."""
    arm = lw.read_arm("examples/bench-arm/arm.yaml")
    for call, told in (
        (lambda: lw.optimize(arm), "problem: needs a Problem or the path of its file, not Arm"),
        (lambda: lw.diagnose(pd.DataFrame({"q1_deg": [1.0]}), arm), "arm: needs an Arm or the path of its file, not"),
        (lambda: lw.read_recording(arm, arm), "recording: needs a DataFrame or the path of its file, not Arm"),
        (lambda: lw.show(7), "arm: needs an Arm or the path of its file, not int"),
    ):
        with pytest.raises(lw.InputError, match=told):
            call()


def test_signatures_are_for_people():
    """Annotations as they are written in the documentation, without what the command line asks by; defaults stay."""
    import inspect

    for name in ("diagnose", "evaluate", "optimize", "tradeoff", "simulate"):
        words = str(inspect.signature(getattr(lw, name)))
        assert "Option(" not in words
        assert "Annotated" not in words
        assert "'Arm" not in words
    assert str(inspect.signature(lw.evaluate)).startswith(
        "(arm: Arm | File, problem: Problem | File | None = None, *, "
    )
    assert inspect.signature(lw.diagnose).parameters["thorough"].default is False


def test_what_is_listed_is_public():
    """And nothing that the package only uses."""
    assert set(dir(lw)) == {*lw.__all__, "__version__"}
