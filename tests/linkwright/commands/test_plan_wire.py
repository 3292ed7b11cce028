"""`linkwright plan` for a wire (distances) and a height gauge, the arm's readings made by sums of cosines."""

import csv
import json

import numpy as np
import pytest

from arm.files.write import arm_to_yaml
from tests.diagnose.recorded import LENGTHS, planar_tip
from tests.diagnose.several.days import SIGMA, arm

PLAY, ANCHOR = 1.5e-3, (1.5, 0.3)
RANDOM = np.random.default_rng(4)


def _read(q, sides, payload):
    """The wire's lengths, m, of an arm with play in its second joint: it lies where loads pull it, else trails."""
    angles = np.cumsum(q, axis=1)
    lever = np.cos(angles[:, 1:]) @ np.array(LENGTHS[1:])
    lies = np.where(payload * np.abs(lever) > 0.0, -np.sign(lever), -sides[:, 1])
    true = q + np.stack([0.0 * lies, 0.5 * PLAY * lies, 0.0 * lies], axis=1)
    away = planar_tip(true) - np.array(ANCHOR)
    return np.linalg.norm(away, axis=1) + SIGMA * RANDOM.standard_normal(len(q))


def _filled_in(plan, recording):
    """The blank column of a plan, as somebody fills it in who reads the wire."""
    with plan.open() as file:
        rows = list(csv.DictReader(file))
    q = np.radians([[float(row[f"q{k}_deg"]) for k in (1, 2, 3)] for row in rows])
    sides = np.array([[float(row[f"dir{k}"]) for k in (1, 2, 3)] for row in rows])
    read = _read(q, sides, np.array([float(row["payload_kg"]) for row in rows]))
    with recording.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        for row, value in zip(rows, read, strict=True):
            assert row["distance_mm"] == ""
            writer.writerow(row | {"distance_mm": f"{1e3 * value:.6f}"})
    recording.with_suffix(".yaml").write_text(plan.with_suffix(".yaml").read_text())


@pytest.fixture
def first(bench):
    """A recording of the wire from one side and under one load, and the arm's file."""
    (bench / "arm.yaml").write_text(arm_to_yaml(arm()))
    q = np.repeat(RANDOM.uniform(-0.6, 0.6, (10, 3)), 3, axis=0)
    read = _read(q, np.ones_like(q), np.full(len(q), 3.0))
    rows = [
        [*(f"{x:.9f}" for x in np.degrees(each)), "1", "1", "1", "3", f"{1e3 * value:.6f}"]
        for each, value in zip(q, read, strict=True)
    ]
    lines = ["q1_deg,q2_deg,q3_deg,dir1,dir2,dir3,payload_kg,distance_mm", *(",".join(row) for row in rows)]
    (bench / "first.csv").write_text("\n".join(lines) + "\n")
    (bench / "first.yaml").write_text("observes: distance\nanchor: [1500 mm, 300 mm, 0 mm]\n")
    return bench


def _diagnosed(linkwright, folder, *recordings):
    assert linkwright("diagnose", "arm.yaml", *recordings, "--json", "found.json")[0] == 0
    return json.loads((folder / "found.json").read_text())


def test_a_wire_tells_play_once_the_deciding_visits_are_made(linkwright, first):
    """One of several; the visits that decide, by the same wire without a word of it; named."""
    before = _diagnosed(linkwright, first, "first.csv")
    assert before["verdict"] == "alias_class"
    status, said, err = linkwright(
        "plan", "arm.yaml", "--poses", "10", "--after", "first.csv", "--payload", "0 kg", "--payload", "3 kg",
        "--out", "plan.csv", "--json", "plan.json",
    )  # fmt: skip
    assert (status, err) == (0, "")
    assert "plan.yaml" in said
    plan = json.loads((first / "plan.json").read_text())
    assert (plan["instrument"], plan["sees"]) == ("distance", ["distance"])
    assert plan["pairs_told"] >= plan["pairs_told_random"] > 0
    smaller = [np.log(each["random"] / each["smallest"]) for each in plan["shown"] if each["random"]]
    assert np.mean(smaller) > np.log(1.1)
    assert "anchor: [1500 mm, 300 mm, 0 mm]" in (first / "plan.yaml").read_text()
    _filled_in(first / "plan.csv", first / "second.csv")
    after = _diagnosed(linkwright, first, "first.csv", "second.csv")
    names = [(each["effect"], each["at"]) for each in after["missing"]]
    assert (after["verdict"], names) == ("named", [("backlash", [2])])
    assert linkwright("simulate", "arm.yaml", "--at", "plan.csv", "--out", "made.csv")[0] == 0
    assert "observes: distance" in (first / "made.yaml").read_text()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--instrument", "distance"), "anchor: needs three lengths"),
        (("--instrument", "along"), "direction: is missing"),
        (("--instrument", "along", "--direction", "0, 0, 1"), "out of the plane"),
        (("--instrument", "y", "--direction", "0, 0, 1"), "goes with the instrument along"),
        (("--anchor", "1 m, 0 m, 0 m"), "goes with the instrument distance"),
        (("--instrument", "along", "--direction", "1, 0", "--anchor-free"), "goes with the instrument distance"),
        (("--after", "first.csv", "--instrument", "xy"), "holds its distance, not xy"),
    ],
)
def test_wrong_input_is_one_line(linkwright, first, options, said):
    del first
    status, _, err = linkwright("plan", "arm.yaml", "--poses", "8", *options)
    assert status == 2
    assert err.count("\n") == 1
    assert said in err
