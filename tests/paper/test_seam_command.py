"""`linkwright seam`: a seam of one's own, its errors, and the point that cannot be reached."""

import json

import pytest

from linkwright.cli import run

pytestmark = pytest.mark.slow

ARM = """\
chain:
  - joint: {range: [-180 deg, 180 deg], backlash: 1 mrad}
    link: {length: 400 mm, section: {shape: circle, diameter: 100 mm}, material: aluminium-6061-t6}
  - joint: {range: [-180 deg, 180 deg]}
    link: {length: 420 mm, section: {shape: circle, diameter: 100 mm}, material: aluminium-6061-t6}
"""


@pytest.fixture
def arm(tmp_path):
    """A 2R arm with backlash in its first drive only."""
    path = tmp_path / "arm.yaml"
    path.write_text(ARM, encoding="utf-8")
    return path


def test_errors_along_a_seam_of_ones_own(arm, tmp_path, capsys):
    """Backlash turns the tip about the base: at (0, 600) mm half a milliradian is 0.3 mm along the seam."""
    target = tmp_path / "seam.json"
    points = ["--from", "-200 mm, 600 mm", "--to", "0.2 m, 600 mm", "--points", "3"]
    assert run(["seam", str(arm), *points, "--json", str(target)]) == 0
    content = json.loads(target.read_text(encoding="utf-8"))
    assert content["reachable"] == "reachable"
    middle = content["rows"][1]
    # The links' own sag adds less than 0.1 mm to either.
    assert 0.3 <= middle[1] <= 0.4
    assert middle[2] <= 0.1
    assert "tangential" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("points", "status", "words"),
    [
        (["--from", "-600 mm, 600 mm", "--to", "600 mm, 600 mm"], 1, "cannot be reached"),
        (["--from", "600, 600", "--to", "0 mm, 600 mm"], 2, "--from"),
        (["--from", "600 mm", "--to", "0 mm, 600 mm"], 2, "two lengths"),
        (["--from", "1 mm, 600 mm", "--to", "1 mm, 600 mm"], 2, "same point"),
    ],
)
def test_what_cannot_be_asked_or_reached_is_one_line(arm, points, status, words, capsys):
    """Status 1 where the arm cannot follow, 2 where the words are wrong."""
    assert run(["seam", str(arm), *points]) == status
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
