"""`linkwright plan` for a wire (distances) and a height gauge, the arm's readings made by sums of cosines; for levels
and cameras, by simulated readings."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import linkwright as lw
from linkwright.core.arm.files.write import arm_to_yaml
from tests.diagnose.instruments.six_joint_arm import six_joint_arm
from tests.diagnose.recorded import LENGTHS, planar_tip
from tests.diagnose.several.days import SIGMA, arm

HEAVY = Path(__file__).resolve().parents[3] / "examples" / "hidden-backlash" / "arm.yaml"
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
        [*(f"{x:.9f}" for x in np.degrees(item)), "1", "1", "1", "3", f"{1e3 * value:.6f}"]
        for item, value in zip(q, read, strict=True)
    ]
    lines = ["q1_deg,q2_deg,q3_deg,dir1,dir2,dir3,payload_kg,distance_mm", *(",".join(row) for row in rows)]
    (bench / "first.csv").write_text("\n".join(lines) + "\n")
    (bench / "first.yaml").write_text("observes: distance\nanchor: [1500 mm, 300 mm, 0 mm]\n")
    return bench


def _diagnosed(linkwright, folder, *recordings):
    assert linkwright("diagnose", "arm.yaml", *recordings, "--json", "found.json")[0] == 0
    return json.loads((folder / "found.json").read_text())


@pytest.mark.slow
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
    smaller = [np.log(item["random"] / item["smallest"]) for item in plan["shown"] if item["random"]]
    assert np.mean(smaller) > np.log(1.1)
    assert "anchor: [1500 mm, 300 mm, 0 mm]" in (first / "plan.yaml").read_text()
    _filled_in(first / "plan.csv", first / "second.csv")
    after = _diagnosed(linkwright, first, "first.csv", "second.csv")
    names = [(item["effect"], item["at"]) for item in after["missing"]]
    assert (after["verdict"], names) == ("named", [("backlash", [2])])
    assert linkwright("simulate", "arm.yaml", "--at", "plan.csv", "--out", "made.csv")[0] == 0
    assert "observes: distance" in (first / "made.yaml").read_text()


GIVES = {"effect": "joint_compliance", "at": 2, "compliance": "60 urad/(N*m)"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "header", "setting"),
    [
        (("tilt", "--tilt-link", "3", "--sigma", "20 urad"), "tilt_x_deg,tilt_y_deg", "tilt_link: 3"),
        (("camera", "--camera", "on_tool", "--sigma-angle", "0.1 mrad"), "x_mm,y_mm,z_mm,qw,qx,qy,qz", "camera: on_"),
        (("same_point",), "point", "observes: same_point"),
        (("bar", "--bar", "0 mm, 400 mm"), "bar_mm,bar", "observes: bar"),
    ],
)
def test_a_plan_is_recorded_by_the_instrument_that_it_is_for(linkwright, bench, options, header, setting):
    """Its file says what is read; simulated there, what was asked for is found, and a plan goes on from it."""
    (bench / "arm.yaml").write_text(arm_to_yaml(six_joint_arm()))
    plan = ("plan", "arm.yaml", "--poses", "9", "--payload", "0 kg", "--payload", "4 kg")
    status, said, err = linkwright(
        *plan, "--for", "joint_compliance:2", "--instrument", *options, "--out", "plan.csv", "--json", "plan.json"
    )
    assert (status, err) == (0, "")
    content = json.loads((bench / "plan.json").read_text())
    assert options[0].removeprefix("same_") in " ".join(content["sees"])
    assert "noise" in said
    lines = (bench / "plan.csv").read_text().splitlines()
    assert lines[0].endswith(f"payload_kg,{header}")
    touches = header in ("point", "plane", "bar_mm,bar")
    if touches:  # which of those it is, and where about
        assert {line.split(",")[-1] for line in lines[1:]} == {item["label"] for item in content["touches"]}
        assert {item["touches"] for item in content["visits"]} == {item["label"] for item in content["touches"]}
    else:
        assert all(line.endswith("," * len(header.split(","))) for line in lines[1:])
    assert setting in (bench / "plan.yaml").read_text()
    made = lw.simulate("arm.yaml", at="plan.csv", with_=[GIVES], noise="20 um")
    assert made.found.slots is not None
    assert made.found.size == 27
    made.save("made.csv")
    result = lw.diagnose("arm.yaml", "made.csv").found
    names = [(one.effect, one.at) for finding in result.findings for one in (finding, *finding.alternatives)]
    assert ("joint_compliance", (2,)) in names
    more = () if options[0] == "tilt" else ("--sigma", "20 um")
    # Nine touches of a few places fill a box in which there are no other postures.
    more += ("--avoid", "below z -5 m") if touches else ()
    status, _, err = linkwright(*plan, "--for", "backlash:3", "--after", "made.csv", *more, "--out", "more.csv")
    assert (status, err) == (0, "")
    assert setting in (bench / "more.yaml").read_text()
    if touches:
        assert lw.simulate("arm.yaml", at="more.csv").found.touches is not None


def test_torques_are_planned_read_and_diagnosed_beside_the_tip(linkwright, tmp_path):
    """Blank columns for them, what they will tell of weights; simulated there, the weights are borne out and the drive
    that gives is named."""
    plan, recording, content = (str(tmp_path / name) for name in ("plan.csv", "r.csv", "p.json"))
    gives = "{effect: backlash, at: 2, total: 3 arcmin}"
    status, said, err = linkwright(
        "plan", str(HEAVY), "--poses", "12", "--for", "backlash", "--torques", "2 N*m", "--out", plan, "--json", content
    )
    assert (status, err) == (0, "")
    assert "links weigh" in said
    with open(plan) as file:
        assert file.readline().endswith("payload_kg,tau1_Nm,tau2_Nm,tau3_Nm,x_mm,y_mm\n")
    first = json.loads((tmp_path / "p.json").read_text())["torques"][0]
    assert 0.0 < first["links_within"] <= 1.1 * first["links_within_random"]
    assert first["friction_within"] > 0.0
    arguments = ("--at", plan, "--with", gives, "--torques", "2 N*m", "--out", recording)
    assert linkwright("simulate", str(HEAVY), *arguments)[0] == 0
    result = lw.diagnose(HEAVY, recording).found
    names = [(one.effect, one.at) for finding in result.findings for one in (finding, *finding.alternatives)]
    assert ("backlash", (2,)) in names
    assert any("Torques confirm the weights of the links" in note for note in result.notes)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--torques", "0.5 N*m, 0.4 N*m"), "--torques: needs one scatter for all joints that turn, or one for each"),
        (("--torques", "0 N*m"), "--torques: must be positive"),
        (("--torques", "2 kg"), "--torques"),
        (("--instrument", "same_point", "--frame", "free"), "touches are in no frame"),
        (("--instrument", "same_point", "--poses", "400"), "touches something again in"),
        (("--instrument", "tilt"), "--tilt-link: needs base or the number of a link, 1 to 3"),
        (("--instrument", "tilt", "--tilt-link", "4"), "--tilt-link: needs base or the number of a link, 1 to 3"),
        (("--instrument", "tilt", "--tilt-link", "2", "--frame", "free"), "goes with an instrument that reads the tip"),
        (("--instrument", "tilt", "--tilt-link", "2", "--sigma", "20 um"), "sigma"),
        (("--tilt-link", "2"), "goes with the instrument tilt, not 'tracker'"),
        (("--instrument", "camera", "--camera", "fixed"), "camera needs an arm in space"),
        (("--sigma-depth", "0.1 mm"), "goes with the instrument camera"),
        (("--after", "first.csv", "--tilt-link", "2"), "goes with the instrument tilt, not 'distance'"),
        (("--instrument", "distance"), "anchor: needs three lengths"),
        (("--instrument", "along"), "direction: is missing"),
        (("--instrument", "along", "--direction", "0, 0, 1"), "out of the plane"),
        (("--instrument", "y", "--direction", "0, 0, 1"), "goes with the instrument along"),
        (("--instrument", "bar"), "bar: needs two places along the bar"),
        (("--instrument", "bar", "--bar", "0 m, 9 m"), "touches nothing again within the joint ranges; a shorter"),
        (("--instrument", "bar", "--bar", "0 mm, 0 mm"), "bar: needs two places along the bar"),
        (("--bar", "0 mm, 300 mm"), "goes with the instrument bar"),
        (("--instrument", "xy", "--bars", "2"), "bars: goes with the instrument bar"),
        (("--instrument", "bar", "--bar", "0 mm, 300 mm", "--bars", "5"), "bars: is from 1 to 4"),
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
