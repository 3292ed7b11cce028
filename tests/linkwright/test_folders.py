"""Output folders: made, taken again, and never written over what is not ours; and the optimiser's whole way."""

import json

import pytest

from linkwright.core.arm.files.read import read_arm
from linkwright.core.units.quantities import InputError
from linkwright.output.files import DESIGN, REPORT, RESULT, claim_folder
from linkwright.results.figures_in_words import figure, mm


def test_optimize_writes_its_three_files(linkwright, bench):
    """The new arm file is the design that result.json tells of, and the folder can be taken again."""
    status, out, err = linkwright("optimize", "problem.yaml", "--out", "made/result", "--json", "copy.json")
    assert (status, err) == (0, "")
    claim_folder(bench / "made" / "result", "optimize", (RESULT, REPORT, DESIGN))  # it can be taken again
    folder = bench / "made" / "result"
    assert {path.name for path in folder.iterdir()} == {"arm.yaml", "report.html", "result.json"}
    content = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    assert content["max_error_mm"] < content["before"]["max_error_mm"]
    assert content["mass_kg"] <= 3.0 * (1 + 1e-6)
    design = read_arm(folder / "arm.yaml")
    assert [1e3 * link.length for link in design.links] == pytest.approx([x["length_mm"] for x in content["links"]])
    assert design.links[0].section.diameter * 1e3 == pytest.approx(content["links"][0]["dimensions_mm"]["diameter"])
    assert mm(1e-3 * content["max_error_mm"], 5) in out
    assert "made/result/report.html" in out
    assert json.loads((bench / "copy.json").read_text(encoding="utf-8"))["mass_kg"] > 0
    # `evaluate` of the written arm file finds the error that `optimize` gave.
    linkwright("evaluate", "made/result/arm.yaml", "--problem", "problem.yaml", "--json", "again.json")
    result = json.loads((bench / "again.json").read_text(encoding="utf-8"))
    assert result["max_error_mm"] == pytest.approx(content["max_error_mm"], rel=1e-6)


def test_evaluate_writes_its_report(linkwright, bench):
    """And optimize does not take that folder."""
    status, _, _ = linkwright("evaluate", "arm.yaml", "--out", "result")
    assert status == 0
    assert {path.name for path in (bench / "result").iterdir()} == {"report.html", "result.json"}
    status, _, err = linkwright("optimize", "problem.yaml", "--out", "result")
    assert status == 2
    assert "linkwright optimize" in err


@pytest.mark.parametrize("name", ["arm.yaml", "notes.txt"])
def test_other_peoples_files_are_not_written_over(tmp_path, name):
    """Nor an arm file that stands alone: it need not be ours."""
    (tmp_path / name).write_text("mine", encoding="utf-8")
    with pytest.raises(InputError):
        claim_folder(tmp_path, "optimize", (RESULT, REPORT, DESIGN))
    assert (tmp_path / name).read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (1240.0, "1240"),
        (0.0042, "0.0042"),
        (-0.25, "−0.25"),
        (123456.0, "123456"),
        (3.4e-9, "3.4e−9"),
        (float("inf"), "∞"),
        (None, "–"),
        (26.0, "26"),
        (100.0, "100"),
    ],
)
def test_figures_in_words(value, text):
    """Four significant digits, no trailing zeros, whole numbers whole."""
    assert figure(value) == text
