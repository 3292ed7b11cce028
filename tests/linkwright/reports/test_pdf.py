"""Reports as PDF: the page on A4 by a browser's print, or one line before any work."""

import re
import shutil
import subprocess

import pytest

from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.evaluation import Evaluation
from linkwright.report.described import page_of
from linkwright.report.page import pdf_of
from linkwright.results.document import Description, Fact, Facts, amount, section, table

needs_chromium = pytest.mark.skipif(shutil.which("chromium") is None, reason="needs Debian's chromium")
needs_pdftotext = pytest.mark.skipif(shutil.which("pdftotext") is None, reason="needs Debian's poppler-utils")


@needs_chromium
def test_command_prints_the_page_on_a4(linkwright, bench):
    """A4 is 210 mm by 297 mm (ISO 216), 595 by 842 points; more than one page, so the sections are there."""
    status, out, _ = linkwright("evaluate", "arm.yaml", "--pdf", "a.pdf", "--author", "Ada")
    assert status == 0
    assert "written: a.pdf" in out
    content = (bench / "a.pdf").read_bytes()
    assert content.startswith(b"%PDF-")
    boxes = re.findall(rb"/MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\]", content)
    assert len(boxes) > 1
    assert {(round(float(wide)), round(float(high))) for wide, high in boxes} == {(595, 842)}


@needs_chromium
@needs_pdftotext
def test_what_a_page_folds_is_not_printed_and_tiles_stand_on_the_first_page(tmp_path):
    """200 rows would be five pages: 40 and where the others are take two; six tiles stand beside each other."""
    facts = Facts(tuple(Fact(f"tile {k}", amount(float(k), "mm")) for k in range(6)))
    rows = [(f"row {k}", amount(float(k), "mm")) for k in range(200)]
    made = page_of(Description("t", "h", (facts, section("Long", table(("what", "size"), rows)))))
    content = pdf_of(made)
    assert len(re.findall(rb"/MediaBox ", content)) == 2
    (tmp_path / "a.pdf").write_bytes(content)
    words = subprocess.run(
        ["pdftotext", "-layout", tmp_path / "a.pdf", "-"], capture_output=True, text=True, check=True
    )
    tiles = [line for line in words.stdout.splitlines() if "tile" in line]
    assert [line.count("tile") for line in tiles] == [6]
    assert "row 39" in words.stdout
    assert "row 40" not in words.stdout
    assert "150 more: on the page, and in the result's JSON" in words.stdout


@pytest.mark.parametrize(
    ("target", "named"),
    [("-", "--pdf: needs the name of a file"), ("arm.yaml", "input"), ("no/where.pdf", "no folder")],
)
def test_wrong_targets_are_one_line(linkwright, target, named):
    status, out, err = linkwright("evaluate", "arm.yaml", "--pdf", target)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert named in err


def test_the_settings_of_a_recording_are_an_input_too(linkwright, bench):
    (bench / "told.yaml").write_text("frame: free\n", encoding="utf-8")
    (bench / "recording.csv").write_text("q1_deg,x_mm,y_mm\n1,2,3\n", encoding="utf-8")
    given = ("arm.yaml", "recording.csv", "--recording-yaml", "told.yaml", "--pdf", "told.yaml")
    status, _, err = linkwright("diagnose", *given)
    assert (status, err.count("\n")) == (2, 1)
    assert "told.yaml: is the input" in err


def test_without_a_browser_one_line_says_so_before_any_work(linkwright, monkeypatch):
    monkeypatch.setattr("linkwright.report.page.shutil.which", lambda _: None)
    status, out, err = linkwright("optimize", "problem.yaml", "--pdf", "a.pdf")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert "--pdf: a PDF needs Chromium, Chrome or Edge" in err


def test_a_pdf_does_not_go_to_standard_output(evaluation, tmp_path, monkeypatch):
    """Nor into a file called `-`."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="needs the name of a file"):
        Evaluation(Arm.of(evaluation.arm), evaluation).save_pdf("-")
    assert list(tmp_path.iterdir()) == []
