"""Reports as PDF: the page on A4 by a browser's print, or one line before any work."""

import re
import shutil

import pytest

from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.evaluation import Evaluation

needs_chromium = pytest.mark.skipif(shutil.which("chromium") is None, reason="needs Debian's chromium")


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
