"""Pictures in the pages show what the program says now."""

from PIL import Image

from handbook.pictures import PICTURE, answer_in, diagnosed


def test_picture_of_a_diagnosis_is_not_stale():
    """`make picture-diagnosis` wrote into it what the report answered; a fresh diagnosis answers the same."""
    assert answer_in(PICTURE) == diagnosed().sentence


def test_a_picture_that_says_nothing_is_seen(tmp_path):
    """The check above checked."""
    Image.new("P", (2, 2)).save(tmp_path / "plain.png")
    assert answer_in(tmp_path / "plain.png") == ""
