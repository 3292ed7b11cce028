"""The picture in docs/how-to/tradeoff.md shows the points of the table beside it, and those are found anew."""

import csv
import xml.etree.ElementTree as ET

import pytest
import yaml

import linkwright as lw
from handbook.front import PAGE, PICTURE, TABLE, asked, shown
from handbook.sources import ROOT
from linkwright.cli import run

EXAMPLE = ROOT / "examples" / "welding-arm"


@pytest.fixture(scope="module")
def points():
    """The points that the picture shows."""
    with TABLE.open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def test_the_picture_shows_the_points_of_the_table(points):
    """A dot each, in as many fronts as the page says, each falling from left to right."""
    page = PAGE.read_text(encoding="utf-8")
    assert "for seven shapes, with their envelope and its knee](../pictures/tradeoff.svg)" in page
    assert len({point["front"] for point in points}) == 7
    circles = [
        item for item in ET.fromstring(PICTURE.read_text(encoding="utf-8")).iter() if item.tag.endswith("circle")
    ]
    assert len(circles) >= len(points)
    for name in {point["front"] for point in points}:
        front = [(float(p["mass_kg"]), float(p["max_error_mm"])) for p in points if p["front"] == name]
        assert front == sorted(front)
        assert [error for _, error in front] == sorted((error for _, error in front), reverse=True)
    assert any(point["knee"] == "1" and point["on_envelope"] == "1" for point in points)


@pytest.mark.slow
def test_the_table_is_what_the_command_solves_now(points, tmp_path, monkeypatch):
    """Of one of the seven shapes."""
    given = yaml.safe_load((EXAMPLE / "problem.yaml").read_text(encoding="utf-8"))
    given["arm"] = str(EXAMPLE / "arm.yaml")
    given["choose"]["section"] = ["circle"]
    (tmp_path / "problem.yaml").write_text(yaml.safe_dump(given), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    words = asked(shown(), tmp_path / "front")
    assert run([words[0], "problem.yaml", *words[2:]]) == 0
    with (tmp_path / "front" / TABLE.name).open(encoding="utf-8", newline="") as stream:
        again = [(float(row["mass_kg"]), float(row["max_error_mm"])) for row in csv.DictReader(stream)]
    kept = [(float(p["mass_kg"]), float(p["max_error_mm"])) for p in points if p["front"] == "circle"]
    for one, other in zip(again, kept, strict=True):
        assert one == pytest.approx(other, rel=1e-4)


@pytest.mark.parametrize("share", [pytest.param(0.4, marks=pytest.mark.slow), 0.85])
def test_points_of_the_envelope_are_found_anew(points, tmp_path, share):
    """By `optimize`, with the point's mass as limit and its shape alone."""
    on = [point for point in points if point["on_envelope"] == "1"]
    point = on[round(share * (len(on) - 1))]
    given = yaml.safe_load((EXAMPLE / "problem.yaml").read_text(encoding="utf-8"))
    given["arm"] = str(EXAMPLE / "arm.yaml")
    given["subject_to"]["mass"] = f"<= {point['mass_kg']} kg"
    given["choose"] = {"section": [point["front"]], "material": ["aluminium-6061-t6"], "same": ["section"]}
    (tmp_path / "one.yaml").write_text(yaml.safe_dump(given), encoding="utf-8")
    best = lw.optimize(tmp_path / "one.yaml").found
    assert 1e3 * best.after.max_error == pytest.approx(float(point["max_error_mm"]), rel=2e-3)
