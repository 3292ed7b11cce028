"""Reports as PDF: what the page says, the same bytes again, and no word taken for markup."""

import json
from dataclasses import replace

import pytest
import typst

from linkwright.core.units.quantities import InputError
from linkwright.face.arm import Arm
from linkwright.face.evaluation import Evaluation
from linkwright.pdf.document import pdf_of
from linkwright.pdf.markup import markup, quoted
from linkwright.pdf.pieces import pieces_of
from linkwright.report.contents import Contents
from linkwright.report.origin import Origin
from linkwright.report.pages.diagnosis import diagnosis_report
from linkwright.report.pages.optimization import optimization_report
from linkwright.results.document import Description, Lines, Paragraph, section, table
from tests.diagnose.made_diagnosis import made_arm, made_diagnosis

ORIGIN = Origin("1970-01-02", "0.1.0", (("arm.yaml", "ba78"),), author="Ada")
ODD = (
    '#panic("x")',
    'a" + read("/etc/passwd") + "',
    "\\",
    '\\"',
    "*b* _i_ $x$ @ref <label> // no #{1/0} `raw` = no\theading",
)


@pytest.mark.parametrize("verdict", ["named", "unknown"])
def test_a_diagnosis_is_set_twice_the_same(verdict):
    contents = diagnosis_report(made_diagnosis(verdict, made_arm(space=True)))
    first = pdf_of(contents, ORIGIN)
    assert first.startswith(b"%PDF-")
    assert first == pdf_of(contents, ORIGIN) != pdf_of(contents, replace(ORIGIN, author="Bob"))


def test_sentences_tables_and_origin_are_all_there(result):
    contents = optimization_report(result)
    source = markup(contents, ORIGIN.rows)
    told = [contents.described.title, "Ada", "SHA-256 ba78", "1970-01-02"]
    for item in contents.described.items:
        told += [item.text] if isinstance(item, Paragraph) else []
        told += item.lines if isinstance(item, Lines) else []
    assert len(told) > 5
    assert [words for words in told if quoted(words) not in source] == []


def test_maps_are_drawn_with_the_greatest_error_in_the_last_colour(result):
    """Viridis runs from #440154 to #fde725 (the matplotlib developers)."""
    contents = optimization_report(result)
    before, after, *own = pieces_of(contents.pictures["map"], contents.figures)
    assert (before.heading, after.heading) == ("Before", "After")
    assert before.caption.startswith("Error over the workspace; the worst")
    for piece, name in ((before, "map-before"), (after, "map-after")):
        rows = [value for row in contents.figures[name]["data"][0]["z"] for value in row if value is not None]
        cells = piece.drawing.count("<rect") - 64 - 1
        assert 0 < cells <= len(rows)
    last = "rgb(253, 231, 37)"
    assert before.drawing.count(last) > 1  # a cell, and the end of the colour bar
    # On one scale the better design is dark all over; in its own colours its worst cell has the last one too.
    assert after.drawing.count(last) == 1
    headings = ["Before, in its own colours", "After, in its own colours"]
    assert [piece.heading for piece in own] == headings[-len(own) :]
    assert own[-1].drawing.count(last) > 1


@pytest.mark.parametrize("words", ODD)
def test_no_word_is_taken_for_markup(words):
    """Typst reads it back as it was; an arm's name cannot run code, nor end the string that it stands in."""
    assert json.loads(typst.eval(b"", expression=quoted(words))) == words.replace("\t", " ")
    told = Description(words, words, (Paragraph(words), section(words, table([words], [(words,)]), lead=words)))
    assert pdf_of(Contents(told, {}), replace(ORIGIN, author=words)).startswith(b"%PDF-")


def test_command_writes_it(linkwright, bench, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    for name in ("a.pdf", "b.pdf"):
        status, out, _ = linkwright("evaluate", "arm.yaml", "--pdf", name, "--author", "Ada")
        assert status == 0
        assert f"written: {name}" in out
    assert (bench / "a.pdf").read_bytes() == (bench / "b.pdf").read_bytes()


def test_how_long_it_took_is_left_out_where_the_date_is_given(result, monkeypatch):
    """For two runs of one question never take as long."""

    def both(seconds):
        diagnosis = replace(made_diagnosis("named", made_arm(space=True)), seconds=seconds)
        pages = diagnosis_report(diagnosis), optimization_report(replace(result, seconds=seconds))
        return [markup(page, ORIGIN.rows) for page in pages]

    assert all(one != other for one, other in zip(both(1.0), both(2.0), strict=True))
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    assert both(1.0) == both(2.0)


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


def test_without_typst_one_line_says_how_to_get_it_before_any_work(linkwright, monkeypatch):
    monkeypatch.setattr("linkwright.pdf.document.find_spec", lambda _: None)
    status, out, err = linkwright("optimize", "problem.yaml", "--pdf", "a.pdf")
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert "pip install 'linkwright[pdf]'" in err


def test_a_pdf_does_not_go_to_standard_output(evaluation, tmp_path, monkeypatch):
    """Nor into a file called `-`."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match="needs the name of a file"):
        Evaluation(Arm.of(evaluation.arm), evaluation).save_pdf("-")
    assert list(tmp_path.iterdir()) == []
