"""`linkwright seam`: a seam of one's own, its errors, and the point that cannot be reached."""

import json
import math

import numpy as np
import pytest

from linkwright.cli import run
from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.worst.workspace import Unreachable
from linkwright.paper.corrected import PaperArm
from linkwright.paper.printed import read_paper
from linkwright.paper.seam import Postures, around, seam_errors

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


def _rigid(backlash):
    """Massless links of the paper's lengths: nothing but play moves the tip."""
    joints = tuple(Joint(backlash=item) for item in backlash)
    return Arm("rigid", joints, tuple(Link(length, mass=0.0) for length in (0.4, 0.42, 0.42)))


def test_backlash_of_the_first_joint_moves_the_tip_round_the_base():
    """Whatever the posture: the error is b/2 times the tip's own vector turned by 90 degrees."""
    places, errors = seam_errors(_rigid((2e-3, 0.0, 0.0)), (0.6, 0.5), (-0.6, 0.5), points=5, postures=32)
    assert places == pytest.approx([0.0, 0.3, 0.6, 0.9, 1.2])
    for (along, across, total), x in zip(errors, (0.6, 0.3, 0.0, -0.3, -0.6), strict=True):
        assert along == pytest.approx(1e-3 * 0.5, rel=1e-6)
        assert across == pytest.approx(1e-3 * abs(x), rel=1e-6, abs=1e-12)
        assert total == pytest.approx(1e-3 * math.hypot(x, 0.5), rel=2e-4)


def test_the_seam_is_searched_over_all_postures():
    """Against the closed form of the 2R inverse at every orientation of link 3, 0.25 degrees apart."""
    postures = Postures(PaperArm(read_paper()).arm(clearance=(1, 2, 3), backlash=(1, 2, 3)), 512)
    point = np.array([[0.3, 0.5, 0.0]])
    directions = around(8)
    result = postures.farthest(point, directions)[0]
    turns = np.radians(np.arange(0.0, 360.0, 0.25))
    wrist = point[0, :2] - 0.42 * np.column_stack([np.cos(turns), np.sin(turns)])
    cosine = ((wrist**2).sum(axis=1) - 0.4**2 - 0.42**2) / (2 * 0.4 * 0.42)
    rows = []
    for elbow in (1.0, -1.0):
        ok = np.abs(cosine) < 1.0
        q2 = elbow * np.arccos(cosine[ok])
        q1 = np.arctan2(wrist[ok, 1], wrist[ok, 0]) - np.arctan2(0.42 * np.sin(q2), 0.4 + 0.42 * np.cos(q2))
        rows.append(np.column_stack([q1, q2, turns[ok] - q1 - q2]))
    brute = postures.support(np.vstack(rows), directions).max(axis=0)
    assert result == pytest.approx(brute, rel=1e-3)


def test_a_seam_out_of_reach_is_refused():
    with pytest.raises(Unreachable, match="1300"):
        seam_errors(_rigid((1e-3, 0.0, 0.0)), (0.6, 0.5), (1.3, 0.0), points=3, postures=16)


def test_directions_come_in_pairs():
    with pytest.raises(ValueError, match="even"):
        around(7)
