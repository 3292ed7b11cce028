"""Pictures in the pages show what the program says now."""

import pytest
from PIL import Image

from handbook.pictures import PICTURES, answer_in
from handbook.sources import ROOT
from tests.handbook.pages import shown, told


@pytest.mark.parametrize("picture", PICTURES, ids=lambda picture: picture.name)
def test_picture_of_a_report_is_not_stale(picture):
    """`make picture-reports` wrote into it what the report answered. README shows what a fresh one answers, and
    test_commands.py that it does."""
    command = {"diagnosis": "diagnose", "welding-arm": "optimize"}[picture.name]
    (page,) = (item for item in shown(ROOT / "README.md") if item.words[0] == command)
    assert told([answer_in(picture.path)], "\n".join(page.printed)) == []


def test_a_picture_that_says_nothing_is_seen(tmp_path):
    """The check above checked."""
    Image.new("P", (2, 2)).save(tmp_path / "plain.png")
    assert answer_in(tmp_path / "plain.png") == ""
