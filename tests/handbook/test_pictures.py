"""Pictures in the pages show what the program says now."""

import pytest
from PIL import Image

from handbook.pictures import PICTURES, answer_in


@pytest.mark.parametrize("picture", PICTURES, ids=lambda picture: picture.name)
def test_picture_of_a_report_is_not_stale(picture):
    """`make picture-reports` wrote into it what the report answered; a fresh one answers the same."""
    assert answer_in(picture.path) == picture.answer()


def test_a_picture_that_says_nothing_is_seen(tmp_path):
    """The check above checked."""
    Image.new("P", (2, 2)).save(tmp_path / "plain.png")
    assert answer_in(tmp_path / "plain.png") == ""
