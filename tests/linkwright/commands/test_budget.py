"""`linkwright budget`: the example, screen, files and the Python face alike."""

import json
from pathlib import Path

import pytest

import linkwright as lw

HOBBY = Path(__file__).resolve().parents[3] / "examples" / "hobby-arm"
SHEET = (HOBBY / "sheet.yaml").read_text(encoding="utf-8") + "draws: 40\n"


def test_the_hobby_arm(linkwright, tmp_path):
    """As on paper it errs by what `evaluate` says; the shoulder's play is worth more than the pan's."""
    sheet, out = tmp_path / "sheet.yaml", tmp_path / "out"
    sheet.write_text(SHEET, encoding="utf-8")
    arguments = ("budget", str(HOBBY / "arm.yaml"), "--sheet", str(sheet), "--out", str(out))
    status, said, err = linkwright(*arguments, "--markdown", str(tmp_path / "said.md"))
    assert (status, err) == (0, "")
    result = lw.budget(HOBBY / "arm.yaml", sheet=sheet)
    assert (out / "result.json").read_text(encoding="utf-8") == result.to_json()
    content = json.loads(result.to_json())
    assert content["nominal_mm"] == pytest.approx(lw.evaluate(HOBBY / "arm.yaml").max_error_mm, rel=1e-6)
    assert content["nominal_mm"] < content["median_mm"] < content["worst_mm"] <= max(content["samples_mm"])
    gains = {item["part"]: item["worst_less_mm"] for item in content["better"]}
    assert gains["second servo at the shoulder"] > gains["second servo at the pan"]
    words = " ".join(said.split())
    for each in ("worst error, 95 % of arms", "compliance of the drives", "jig for the zeros", "mm per EUR"):
        assert each in words
    page = (out / "report.html").read_text(encoding="utf-8")
    assert 'class="fill before"' in page
    assert "Bars: at the worst pose (grey)" in page
    assert "What to buy better first" in (tmp_path / "said.md").read_text(encoding="utf-8")
    assert len(repr(result)) < 200
    assert len(result.plot().data) == 2
    result.save(out)
    with pytest.raises(lw.InputError, match="holds other files"):
        result.save(tmp_path)


def test_without_a_sheet_all_arms_are_alike(linkwright):
    """And it says so."""
    status, said, _ = linkwright("budget", str(HOBBY / "arm.yaml"))
    assert status == 0
    assert "give tolerances with --sheet" in said
    status, _, err = linkwright("budget", str(HOBBY / "arm.yaml"), "--sheet", "nothing.yaml")
    assert status == 2
    assert err.count("\n") == 1
