"""Error budgets against first principles: one lever, uniform tolerances, ISO 9283's repeatability."""

import itertools
import math

import numpy as np
import pytest

import linkwright as lw
from linkwright.core.arm.errors.lost_motion import farthest_by_fan, played
from linkwright.core.arm.errors.model import PoseArrays
from linkwright.core.optimize.budget.parts import parts_of, reach_of_repeatability
from linkwright.core.optimize.budget.sample import Draws, errors

LEVER = {
    "name": "lever",
    "gravity": ["0 m/s^2", "-10 m/s^2", "0 m/s^2"],
    "chain": [
        {"joint": {"range": ["0 deg", "90 deg"]}, "link": {"length": "500 mm", "rigid": True, "mass": "0 kg"}},
    ],
    "payload": {"mass": "2 kg"},
}
OFFSET = {"effect": "encoder_offset", "offset": "1 mrad"}


def lever(**joint):
    """A lever of half a metre that holds 2 kg."""
    chain = [{"joint": {**LEVER["chain"][0]["joint"], **joint}, "link": LEVER["chain"][0]["link"]}]
    return lw.Arm(**{**LEVER, "chain": chain})


def spread(share, draws):
    """Three standard deviations of which share of uniform draws lies below a quantile."""
    return 3.0 * math.sqrt(share * (1.0 - share) / draws)


def test_a_uniform_angle_on_a_lever():
    """|s| w L with s uniform: its quantile of 95 % is 0.95 w L, its root mean square w L / sqrt 3."""
    result = lw.budget(lever(), sheet={"tolerances": [OFFSET], "draws": 4000}).found
    assert result.worst / 0.5e-3 == pytest.approx(0.95, abs=spread(0.95, 4000))
    assert result.median / 0.5e-3 == pytest.approx(0.5, abs=spread(0.5, 4000))
    assert result.average == pytest.approx(0.5e-3 / math.sqrt(3.0), rel=0.02)
    assert result.nominal == 0.0
    assert result.worst < result.worst_upper < 0.5e-3


def test_the_average_is_over_the_workspace_and_not_over_its_corners():
    """Six equal links that turn all round are sqrt(6) links long in the mean square, and fold up at every corner."""
    whole = {"range": ["-180 deg", "180 deg"]}
    arm = lw.Arm(**{**LEVER, "chain": [{"joint": whole, "link": LEVER["chain"][0]["link"]}] * 6})
    result = lw.budget(arm, sheet={"tolerances": [{**OFFSET, "at": 1}], "draws": 1000}).found
    # Three standard deviations of the mean square of 64 poses, of which each has that of an exponential.
    assert result.average == pytest.approx(0.5e-3 * math.sqrt(6.0 / 3.0), rel=0.5 * 3.0 / math.sqrt(64.0))


def test_an_angle_drawn_anew_at_every_pose_meets_its_bound_somewhere():
    """Over N poses the worst of uniform draws has the quantile 0.95^(1/N)."""
    result = lw.budget(lever(), sheet={"tolerances": [{**OFFSET, "each_time": True}], "draws": 2000}).found
    assert result.poses > 20
    share = 0.95 ** (1.0 / result.poses)
    assert share - 0.01 < result.worst / 0.5e-3 <= 1.0
    assert result.average == pytest.approx(0.5e-3 / math.sqrt(3.0), rel=0.02)
    assert [cause.name for cause in result.causes] == ["encoder_offset, each time"]


def test_a_drive_of_uncertain_stiffness():
    """Level, 10 N*m over k (1 + w s): 95 % of arms keep what s = -0.9 gives, which grows by 0.244 ds there; as on
    paper it is that of `evaluate`."""
    arm = lever(stiffness="1 kN*m/rad")
    sheet = {"uncertain": {"stiffness": "20 %"}, "draws": 1000}
    several = [lw.budget(arm, sheet={**sheet, "seed": seed}).found for seed in range(8)]
    result = several[0]
    droop = 20.0 * 0.5 * 0.5 / 1e3
    assert result.nominal == pytest.approx(droop, rel=1e-9)
    assert result.nominal == pytest.approx(lw.evaluate(arm).found.max_error, rel=1e-9)
    worst = sum(item.worst for item in several) / 8.0
    assert worst == pytest.approx(droop / (1.0 - 0.2 * 0.9), rel=0.244 * 2.0 * spread(0.95, 8000))
    assert result.pose[0] == pytest.approx(0.0, abs=1e-6)


def test_the_average_is_over_poses_spread_evenly():
    """A droop that goes with cos q over a quarter turn has the root mean square 1/sqrt 2 of its greatest, though the
    worst pose is looked at as well. (64 poses of a sequence of low discrepancy: some 1/64 off.)"""
    result = lw.budget(lever(stiffness="1 kN*m/rad"), sheet={"draws": 20}).found
    assert result.average == pytest.approx(result.nominal / math.sqrt(2.0), rel=0.02)


def test_few_poses_hold_the_worst_of_many():
    """Of drawn arms of three joints in space, at 20,000 poses instead."""
    bend = {"length": "300 mm", "rigid": True, "mass": "2 kg"}
    chain = [
        {"joint": {"range": ["-90 deg", "90 deg"], "axis": "z"}, "link": {**bend, "direction": [0, 0, 1]}},
        {"joint": {"range": ["-90 deg", "90 deg"], "axis": "y", "stiffness": "5 kN*m/rad"}, "link": bend},
        {"joint": {"range": ["-90 deg", "90 deg"], "axis": "y", "backlash": "0.5 mrad"}, "link": bend},
    ]
    arm = lw.Arm(chain=chain, gravity=["0 m/s^2", "0 m/s^2", "-9.81 m/s^2"])
    content = {"tolerances": [OFFSET, {"effect": "link_length", "length": "0.4 mm"}], "draws": 60}
    result = lw.budget(arm, sheet=content).found
    draw = np.random.default_rng(2)
    poses = np.array([draw.uniform(*joint.range, 20_000) for joint in arm.model.joints]).T
    parts = parts_of(arm.model, result.sheet, poses, (arm.model.payload,))
    worst = np.sort(errors(parts, Draws(20, 60, parts.states)).max(axis=1))
    assert worst[56] <= 1.01 * result.worst  # the 57th of 60: 95 %
    assert worst[56] >= 0.97 * result.worst


def test_play_that_is_uncertain():
    """Half of a backlash b (1 + w s) either way."""
    result = lw.budget(lever(backlash="4 mrad"), sheet={"uncertain": {"backlash": "50 %"}, "draws": 4000}).found
    assert result.nominal == pytest.approx(1e-3, rel=1e-9)
    assert result.worst == pytest.approx(1e-3 * (1.0 + 0.5 * 0.9), rel=0.5 * 2.0 * spread(0.95, 4000))


def test_warmth_lengthens():
    """Aluminium's figure of the catalogue times length and 5 K, either way."""
    link = {"length": "500 mm", "section": {"shape": "circle", "diameter": "50 mm"}, "material": "aluminium-6061-t6"}
    arm = lw.Arm(chain=[{"joint": {"range": ["0 deg", "90 deg"]}, "link": link}], gravity=["0 m/s^2"] * 3)
    result = lw.budget(arm, sheet={"temperature": "5 K", "draws": 2000}).found
    grown = lw.materials["aluminium-6061-t6"].at("20 degC").thermal_expansion * 5.0 * 0.5
    assert result.worst == pytest.approx(0.95 * grown, rel=2.0 * spread(0.95, 2000))


@pytest.mark.parametrize("planar", [True, False])
def test_repeatability_is_that_of_iso_9283(planar):
    """Mean distance from the mean position and three of its standard deviations, of what is drawn."""
    draws = np.random.default_rng(1).standard_normal((400_000, 2 if planar else 3))
    away = np.linalg.norm(draws, axis=1)
    assert reach_of_repeatability(planar) == pytest.approx(away.mean() + 3.0 * away.std(), rel=0.005)
    arm = lever() if planar else lever(axis="y").replace("gravity", ["0 m/s^2", "0 m/s^2", "-10 m/s^2"])
    result = lw.budget(arm, sheet={"repeatability": "0.1 mm", "draws": 500}).found
    scatter = 0.1e-3 / reach_of_repeatability(planar)
    assert result.average == pytest.approx(scatter * math.sqrt(2.0 if planar else 3.0), rel=0.02)


TWO = [
    {"joint": {"range": ["-90 deg", "90 deg"], "backlash": "1 mrad"}, "link": {"length": "400 mm", "mass": "1 kg"}},
    {"joint": {"range": ["10 deg", "120 deg"], "backlash": "1 mrad"}, "link": {"length": "300 mm", "mass": "1 kg"}},
]


def test_mean_squares_of_independent_causes_add_up():
    """Without play: all of them together are the root of the sum of squares (within what draws scatter by)."""
    chain = [{**item, "joint": {"range": item["joint"]["range"]}} for item in TWO]
    sheet = {"tolerances": [OFFSET, {"effect": "link_length", "length": "0.3 mm"}], "repeatability": "0.2 mm"}
    result = lw.budget(lw.Arm(chain=chain), sheet={**sheet, "draws": 4000}).found
    assert sum(cause.share for cause in result.causes) == pytest.approx(1.0)
    assert result.average == pytest.approx(math.sqrt(sum(cause.average**2 for cause in result.causes)), rel=0.02)
    alone = lw.budget(lw.Arm(chain=chain), sheet={"tolerances": [OFFSET], "draws": 4000}).found
    same = next(cause for cause in result.causes if cause.name == "encoder_offset")
    assert alone.average == pytest.approx(same.average, rel=1e-12)  # the same draws, whatever else is drawn


def test_a_better_part_is_worth_what_the_budget_with_it_says():
    """By the same draws; those that bring most for a euro go first, those without a price last."""
    arm = lw.Arm(chain=TWO)
    sheet = {"tolerances": [OFFSET, {"effect": "link_length", "length": "0.3 mm"}], "draws": 400}
    parts = [
        {"part": "gear", "at": 1, "joint": {"backlash": "0.2 mrad"}, "price": "100 EUR"},
        {"part": "homing", "at": 2, "tolerances": [{**OFFSET, "at": [2], "offset": "0.1 mrad"}]},
        {"part": "jig", "tolerances": [{**OFFSET, "offset": "0.1 mrad"}], "price": "20 EUR"},
    ]
    result = lw.budget(arm, sheet={**sheet, "better": parts}).found
    gains = {option.name: option for option in result.options}
    assert [option.name for option in result.options] == ["jig", "gear", "homing"]
    with_gear = lw.budget(arm.replace("chain[1].joint.backlash", "0.2 mrad"), sheet=sheet).found
    # The poses are those of the arm as it is, so other poses of the better arm may count a little differently.
    assert gains["gear"].worst == pytest.approx(result.worst - with_gear.worst, rel=0.05)
    assert gains["gear"].per_euro == pytest.approx(gains["gear"].worst / 100.0)
    assert gains["homing"].per_euro is None
    assert gains["jig"].worst > gains["homing"].worst > 0.0
    halved = {item.owner: item.worst for item in result.halved}
    assert halved[("joint", 0)] > halved[("joint", 1)] > 0.0


def arrays(rows, plays, discs, seed=5):
    """Random play in space."""
    draw = np.random.default_rng(seed)
    normals = draw.standard_normal((rows, discs, 3))
    return PoseArrays(
        draw.standard_normal((rows, 3)),
        draw.standard_normal((rows, plays, 3)),
        np.zeros((rows, plays)),
        normals / np.linalg.norm(normals, axis=2, keepdims=True),
        np.zeros((rows, discs, 3)),
        np.ones(rows),
    )


def test_intervals_alone_reach_farthest_at_a_vertex():
    """Of all their vertices."""
    given = arrays(60, 6, 0)
    result = played(given, np.zeros(0), "worst", planar=False)
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=6)))
    points = given.vector[:, None] + np.einsum("ck,nki->nci", signs, given.intervals)
    assert result.error == pytest.approx(np.linalg.norm(points, axis=2).max(axis=1), rel=1e-12)
    again = given.vector + np.einsum("nk,nki->ni", result.signs, given.intervals)
    assert np.linalg.norm(again, axis=1) == pytest.approx(result.error, rel=1e-12)


def test_one_climb_from_a_fan_reaches_as_far_as_many():
    """Never farther than what the many find by more than rounding, and hardly ever less."""
    given, radii = arrays(150, 4, 3), np.array([0.3, 0.7, 0.2])
    many, one = played(given, radii, "worst", planar=False).error, farthest_by_fan(given, radii)
    assert (one <= many * (1.0 + 1e-6)).all()
    assert np.mean(one >= many * (1.0 - 1e-4)) > 0.98
    assert (one >= many * 0.99).all()


@pytest.mark.parametrize(
    ("sheet", "words"),
    [
        ({"tolerances": [{"effect": "encoder_ofset", "offset": "1 mrad"}]}, "tolerances[1].effect: there is no effect"),
        ({"tolerances": [{"effect": "backlash", "total": "1 mrad"}]}, "backlash is no tolerance; those are"),
        ({"tolerances": [{**OFFSET, "offset": 1}]}, ""),
        ({"tolerances": [{**OFFSET, "sigma": "1 mrad"}]}, "unknown key 'sigma'"),
        ({"tolerance": [OFFSET]}, "did you mean 'tolerances'"),
        ({"repeatability": "-1 mm"}, "repeatability: cannot be negative"),
        ({"share": 1.5}, "share: is from 50 % to below 100 %"),
        ({"draws": 3}, "draws: needs 20 to 20000"),
        ({"better": [{"part": "gear"}]}, "better[1]: changes nothing"),
        ({"better": [{"part": "gear", "joint": {"backlash": "1 mrad"}}]}, "at: is missing"),
        ({"better": [{"part": "gear", "at": 3, "joint": {"backlash": "1 mrad"}}]}, "from 1 to 2"),
        ({"better": [{"part": "gear", "at": 1, "joint": {"backlas": "1 mrad"}}]}, "did you mean 'backlash'"),
        (
            {"better": [{"part": "gear", "at": 1, "joint": {"backlash": "0 mrad"}, "price": "0 EUR"}]},
            "must be positive",
        ),
    ],
)
def test_what_is_wrong_is_one_line(sheet, words):
    """With key and what would do."""
    with pytest.raises(lw.InputError) as error:
        lw.budget(lw.Arm(chain=TWO), sheet=sheet)
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_an_arm_without_any_data_of_errors_is_told_so():
    """An imported one, say."""
    with pytest.raises(lw.InputError, match="has no data of anything that errs; give stiffness"):
        lw.budget(lw.import_arm("examples/urdf/tabletop.urdf", tip="tip").arm)
