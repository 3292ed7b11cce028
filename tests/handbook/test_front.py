"""The picture in docs/how-to/tradeoff.md is what its command draws now, and what was solved for it holds."""

import json

import pytest
import yaml

import linkwright as lw
from handbook.front import DRAWN, PAGE, PICTURE, asked, shown, unpack
from handbook.sources import ROOT
from linkwright.cli import run
from linkwright.core.optimize.tradeoff.journal import JOURNAL
from tests.handbook import pages

EXAMPLE = ROOT / "examples" / "welding-arm"


@pytest.fixture(scope="module")
def again(tmp_path_factory):
    """The folder that the page's command leaves where all it asks for is solved already."""
    folder = tmp_path_factory.mktemp("front")
    unpack(folder)
    assert run(asked(shown(), folder)) == 0
    return folder


def found_in(folder):
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))


def test_the_picture_is_what_the_command_draws_now(again):
    """Another arm, problem, material, axis or accuracy is refused; another drawing, refinement or envelope differs."""
    assert found_in(again)["solved"] == 0
    assert (again / DRAWN).read_bytes() == PICTURE.read_bytes()


def test_the_page_says_what_the_picture_shows(again):
    result = found_in(again)
    page = PAGE.read_text(encoding="utf-8")
    assert "for seven shapes, with their envelope and its knee](../pictures/tradeoff.svg)" in page
    assert len(result["fronts"]) == 7
    assert result["envelope"]["knee"] is not None


def test_points_are_what_their_arms_err_by(again):
    """A sample of those drawn, evaluated anew."""
    for point in found_in(again)["points"][::40]:
        made = lw.evaluate(again / point["arm_file"]).found
        assert 1e3 * made.max_error == pytest.approx(point["max_error_mm"], rel=1e-6)
        assert made.mass == pytest.approx(point["mass_kg"], rel=1e-8)


@pytest.mark.parametrize("share", [pytest.param(0.4, marks=pytest.mark.slow), 0.85])
def test_points_of_the_envelope_are_found_anew(again, tmp_path, share):
    """By `optimize`, which knows nothing of what is kept, with the point's mass as limit and its shape alone."""
    points = [item for item in found_in(again)["points"] if item["on_envelope"]]
    point = points[round(share * (len(points) - 1))]
    given = yaml.safe_load((EXAMPLE / "problem.yaml").read_text(encoding="utf-8"))
    given["arm"] = str(EXAMPLE / "arm.yaml")
    given["subject_to"]["mass"] = f"<= {point['mass_kg']!r} kg"
    given["choose"] = {"section": [point["front"]], "material": ["aluminium-6061-t6"], "same": ["section"]}
    (tmp_path / "one.yaml").write_text(yaml.safe_dump(given), encoding="utf-8")
    best = lw.optimize(tmp_path / "one.yaml").found
    assert 1e3 * best.after.max_error == pytest.approx(point["max_error_mm"], rel=2e-3)


@pytest.mark.slow
def test_a_front_that_was_stopped_is_gone_on_with(tmp_path, monkeypatch):
    """As the page types it, of a small problem whose journal lost the second half of its points."""
    given = yaml.safe_load((EXAMPLE / "problem.yaml").read_text(encoding="utf-8"))
    given["arm"] = str(EXAMPLE / "arm.yaml")
    given["subject_to"] = {"mass": "<= 26 kg", "section_size": ["90 mm", "100 mm"]}
    given["choose"] = {"section": ["circle"], "material": ["aluminium-6061-t6"], "same": ["section", "size"]}
    (tmp_path / "problem.yaml").write_text(yaml.safe_dump(given), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    (typed,) = (item.words for item in pages.shown(PAGE) if "--resume" in item.words)
    assert run([word for word in typed if word != "--resume"]) == 0
    folder = tmp_path / typed[typed.index("--out") + 1]
    whole, lines = found_in(folder), (folder / JOURNAL).read_text(encoding="utf-8").splitlines(keepends=True)
    (folder / JOURNAL).write_text("".join(lines[: len(lines) // 2 + 1]), encoding="utf-8")
    (folder / "result.json").unlink()
    assert run(typed) == 0
    gone_on = found_in(folder)
    assert 0 < gone_on["resumed"] < whole["solved"]
    assert 0 < gone_on["solved"] < whole["solved"]
    for old, new in zip(whole["points"], gone_on["points"], strict=True):
        assert [new["mass_kg"], new["max_error_mm"]] == pytest.approx([old["mass_kg"], old["max_error_mm"]], rel=1e-6)
