"""`linkwright inverse`: every pose at a point, and what keeps the tip from it."""

import json
import math

import pytest

ARM = """\
name: two links
chain:
  - joint: {range: [-180 deg, 180 deg]}
    link: {length: 400 mm, mass: 1 kg}
  - joint: {range: [%s deg, 150 deg]}
    link: {length: 300 mm, mass: 1 kg}
"""


@pytest.fixture
def two_links(bench):
    """A 2R arm that bends to both sides, and one that bends to the left only."""
    (bench / "both.yaml").write_text(ARM % "-150", encoding="utf-8")
    (bench / "left.yaml").write_text(ARM % "0", encoding="utf-8")


def tip(q):
    """Of the two links, mm, by hand."""
    first, both = math.radians(q[0]), math.radians(q[0] + q[1])
    return 400.0 * math.cos(first) + 300.0 * math.cos(both), 400.0 * math.sin(first) + 300.0 * math.sin(both)


@pytest.mark.usefixtures("two_links")
def test_both_branches_of_two_links_reach_the_point(linkwright):
    """The elbow left and right; a negative length is no option."""
    status, out, err = linkwright("inverse", "both.yaml", "300 mm", "-0.4 m", "--json", "poses.json")
    assert (status, err) == (0, "")
    assert "2 poses at (300, −400) mm" in out
    with open("poses.json", encoding="utf-8") as stream:
        poses = json.load(stream)["poses"]
    assert sorted(math.copysign(1.0, pose["q_deg"][1]) for pose in poses) == [-1.0, 1.0]
    for pose in poses:
        assert tip(pose["q_deg"]) == pytest.approx((300.0, -400.0), abs=1e-6)
        assert pose["isolated"]
        assert not pose["singular"]


@pytest.mark.usefixtures("two_links")
def test_a_joint_range_leaves_one_branch(linkwright):
    """An elbow that bends to the left only."""
    status, out, _ = linkwright("inverse", "left.yaml", "300 mm", "-400 mm")
    assert status == 0
    assert "1 pose at" in out
    assert "joint 2 (0° to 150°)" in " ".join(out.split())


@pytest.mark.usefixtures("two_links")
def test_full_stretch_is_one_singular_pose(linkwright):
    """Both branches meet there, and with the one-sided elbow it stands at its limit."""
    status, out, _ = linkwright("inverse", "left.yaml", "700 mm", "0 mm")
    assert status == 0
    assert "1 pose at" in out
    assert "singular" in out
    assert "family" not in out


def test_a_redundant_arm_says_that_the_poses_are_samples(linkwright, bench):
    """Three links have a family of poses at a point, and two once the last is inclined as asked."""
    text = ARM % "-150" + "  - joint: {range: [-180 deg, 180 deg]}\n    link: {length: 100 mm, mass: 1 kg}\n"
    (bench / "three.yaml").write_text(text, encoding="utf-8")
    status, out, _ = linkwright("inverse", "three.yaml", "400 mm", "300 mm", "--most", "5")
    assert status == 0
    assert "5 poses" in out
    assert "samples of a family" in out
    status, out, _ = linkwright("inverse", "three.yaml", "400 mm", "300 mm", "--inclination", "30 deg")
    assert status == 0
    assert "2 poses" in out
    assert "family" not in out


@pytest.mark.usefixtures("two_links")
@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (("800 mm", "0 mm"), 1, "the tip stays 100 mm away"),
        (("50 mm", "0 mm"), 1, "away"),
        (("300 mm", "400 mm", "50 mm"), 1, "50 mm away"),
        (("800", "0 mm"), 2, "X"),
        (("800 mm",), 2, "Y"),
        (("800 mm", "0 mm", "0 mm", "0 mm"), 2, "extra"),
        (("300 mm", "400 mm", "--inclination", "30 mm"), 2, "--inclination"),
    ],
)
def test_what_cannot_be_reached_or_read_is_one_line(linkwright, words, status, said):
    """Status 1 with the distance missing, 2 for words that are wrong."""
    ended, out, err = linkwright("inverse", "both.yaml", *words)
    assert (ended, out) == (status, "")
    assert err.count("\n") == 1
    assert said in err
