"""`linkwright plan`: its file and figures, the loop from `one of several` to a name, and wrong input in one line."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import linkwright as lw
from linkwright.core.arm.avoid.poses import meets
from linkwright.core.arm.avoid.regions import between, beyond
from linkwright.core.diagnose.plan.promise import Rival
from linkwright.results.planning import describe

ARM = Path(__file__).resolve().parents[3] / "examples" / "hidden-backlash" / "arm.yaml"
WELDING = ARM.parents[1] / "welding-arm" / "arm.yaml"
PLAY = [{"effect": "backlash", "at": 2, "total": "3 arcmin"}]


@pytest.mark.slow
def test_plan_record_plan_the_deciding_poses_record_named(linkwright, tmp_path):
    """From one side and under one load play looks like a drive that hardens; the deciding visits name it."""
    first, plan = tmp_path / "first.csv", tmp_path / "plan.csv"
    lw.simulate(ARM, poses=10, sides="one", payloads=["0 kg"], with_=PLAY).save(first)
    before = lw.diagnose(ARM, first)
    assert before.verdict == "alias_class"
    arguments = ("--poses", "10", "--payload", "0 kg", "--payload", "3 kg", "--out", str(plan))
    status, said, err = linkwright(
        "plan", str(ARM), "--after", str(first), *arguments, "--json", str(tmp_path / "p.json")
    )
    assert (status, err) == (0, "")
    content = json.loads((tmp_path / "p.json").read_text(encoding="utf-8"))
    names = {
        alternative.effect for finding in before.found.findings for alternative in (finding, *finding.alternatives)
    }
    assert {item["effect"] for item in content["shown"]} == names
    assert content["pairs_told"] == content["pairs"] > content["pairs_told_random"]
    assert "first.csv" in " ".join(said.split())
    assert "Every cause is told from every other" in " ".join(said.split())
    lines = plan.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "time_s,q1_deg,q2_deg,q3_deg,dir1,dir2,dir3,payload_kg,x_mm,y_mm"
    assert len(lines) == 31 == content["readings"] + 1
    second = lw.simulate(ARM, at=plan, with_=PLAY, seed=2)
    assert second.found.size == 30
    after = lw.diagnose(ARM, [lw.read_recording(first, ARM), second])
    assert after.verdict == "named"
    assert [(finding.effect, finding.at) for finding in after.found.findings] == [("backlash", (2,))]
    again = lw.plan(ARM, poses=10, after=before, payloads=["0 kg", 3.0])
    assert again.text() == plan.read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.usefixtures("bench")
def test_the_loop_goes_by_planes_that_are_touched(linkwright):
    """The same by commands alone, where a dial gauge touches planes: `simulate --at` touches what the plan names."""
    play, plan = "{effect: backlash, at: 2, total: 6 arcmin}", ("--out", "first-plan.csv")
    arm = str(WELDING)
    asked = ("--instrument", "plane", "--poses", "30", "--for", "backlash,joint_compliance")
    assert linkwright("plan", arm, *asked, *plan)[0] == 0
    for kind, other in (("same_point", "point"), ("bar", "bar")):
        status, _, err = linkwright("simulate", arm, "--at", "first-plan.csv", "--observe", kind, "--out", "no.csv")
        assert (status, err.count("\n")) == (2, 1)
        assert f"it needs a {other} in each row" in err
    made = ("--with", play, "--declare-sigma")
    first = ("simulate", arm, "--at", "first-plan.csv", "--observe", "plane", *made, "--out", "first.csv")
    assert linkwright(*first)[0] == 0
    planned, read = (Path(name).read_text().splitlines() for name in ("first-plan.csv", "first.csv"))
    assert planned[0] == read[0]
    assert [row.rpartition(",")[2] for row in planned] == [row.rpartition(",")[2] for row in read]
    before = lw.diagnose(arm, "first.csv")
    assert before.verdict == "alias_class"
    again = ("--after", "first.csv", "--poses", "12", "--payload", "0 kg", "--payload", "5 kg", "--out", "next.csv")
    # Within the ranges recorded few postures touch one line; a region to avoid opens the whole of them.
    assert linkwright("plan", arm, *again, "--avoid", "below y -9 m")[0] == 0
    assert linkwright("simulate", arm, "--at", "next.csv", *made, "--seed", "3", "--out", "second.csv")[0] == 0
    after = lw.diagnose(arm, ["first.csv", "second.csv"])
    assert after.verdict == "named"
    assert [(finding.effect, finding.at) for finding in after.found.findings] == [("backlash", (2,))]


@pytest.mark.slow
@pytest.mark.usefixtures("bench")
@pytest.mark.parametrize("instrument", ["same_point", "bar"])
def test_an_offset_is_named_where_few_touches_tell_where_a_point_is(instrument):
    """A point all of whose touches are held out together is no evidence against what was found."""
    arm = WELDING
    extra = {"bar": ["0 mm", "300 mm"]} if instrument == "bar" else {}
    lw.plan(arm, poses=30, instrument=instrument, for_=["joint_compliance", "backlash"], **extra).save("plan.csv")
    offset = {"effect": "encoder_offset", "at": 2, "offset": "0.05 deg"}
    result = lw.diagnose(arm, lw.simulate(arm, at="plan.csv", with_=[offset], declare_sigma=True))
    assert result.verdict == "named"
    assert [(finding.effect, finding.at) for finding in result.found.findings] == [("encoder_offset", (2,))]


@pytest.mark.slow
def test_after_two_recordings_what_neither_tells_is_planned(linkwright, tmp_path):
    """Both from one side without a load: together they leave open what each does, and what both show counts."""
    files = [tmp_path / "first.csv", tmp_path / "second.csv"]
    for seed, file in enumerate(files, start=1):
        lw.simulate(ARM, poses=10, sides="one", payloads=["0 kg"], with_=PLAY, seed=seed).save(file)
    status, said, err = linkwright(
        "plan", str(ARM), "--poses", "10", "--payload", "0 kg", "--payload", "3 kg",
        "--after", str(files[0]), "--after", str(files[1]), "--json", str(tmp_path / "both.json"),
    )  # fmt: skip
    assert (status, err) == (0, "")
    both = json.loads((tmp_path / "both.json").read_text(encoding="utf-8"))
    assert "first.csv + second.csv" in " ".join(said.split())
    assert both["pairs_told"] == both["pairs"] > 0
    assert {"backlash"} < {item["effect"] for item in both["shown"]}


@pytest.mark.slow
def test_figures_are_those_of_the_plan(tmp_path):
    """The same seed, the same plan; tables, picture and file agree."""
    result = lw.plan(ARM, poses=9, for_=["encoder_offset"], repeats=2, payloads=["1 kg"], seed=3)
    assert (
        result.to_json() == lw.plan(ARM, poses=9, for_=["encoder_offset"], repeats=2, payloads=[1.0], seed=3).to_json()
    )
    assert list(result.shown["unit"]) == ["mrad"] * 3
    assert list(result.visits.columns) == [
        "time_s", "q1_deg", "q2_deg", "q3_deg", "dir1", "dir2", "dir3", "payload_kg"
    ]  # fmt: skip
    assert len(result.visits) == 9
    assert len(repr(result)) < 250
    assert len(result.plot().data) == 2
    result.save(tmp_path / "plan.csv")
    assert len((tmp_path / "plan.csv").read_text(encoding="utf-8").splitlines()) == 19


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--poses", "5"), "from 8"),
        (("--poses", "9", "--for", "backlsh"), "did you mean 'backlash'"),
        (("--poses", "9", "--for", "backlash:7"), "from 1 to 3"),
        (("--poses", "9", "--instrument", "z"), "out of the plane"),
        (("--poses", "9", "--instrument", "tracking"), "tracker"),
        (("--poses", "9", "--avoid", "0 m, 0 m"), "two corners"),
        (("--poses", "9", "--avoid", "-3 m, -3 m, -3 m to 3 m, 3 m, 3 m"), "leaves 0 poses"),
        (("--poses", "9", "--payload", "-1 kg"), "not negative"),
        (("--poses", "9", "--sigma", "0 um"), "positive"),
        (("--poses", "9", "--frame", "loose"), "known or free"),
        (("--poses", "9", "--out", "-"), "name of a file"),
    ],
)
def test_wrong_input_is_one_line(linkwright, options, said):
    status, _, err = linkwright("plan", str(ARM), *options)
    assert status == 2
    assert err.count("\n") == 1
    assert said in err


@pytest.mark.slow
def test_after_a_recording_in_a_free_frame_that_leaves_nothing_open(tmp_path):
    """The frame stays free, everything is asked, and it is said."""
    first = tmp_path / "first.csv"
    lw.simulate(ARM, poses=12, frame_free=True).save(first)
    result = lw.plan(ARM, poses=8, repeats=1, after=first)
    assert (result.found.asked.frame, result.found.asked.tool) == ("free", "known")
    assert not result.found.asked.effects
    assert "leaves no names open" in repr(describe(result.found))


def test_what_nothing_shows_has_no_answer(linkwright):
    """Without temperatures nothing warms."""
    status, _, err = linkwright("plan", str(ARM), "--poses", "9", "--for", "thermal_expansion")
    assert status == 1
    assert "nothing of what is asked for" in err


def test_simulate_takes_poses_or_a_plan(linkwright, tmp_path):
    status, _, err = linkwright("simulate", str(ARM), "--out", str(tmp_path / "r.csv"))
    assert status == 2
    assert "--poses" in err


@pytest.mark.parametrize(
    ("option", "named"),
    [
        (("--payload", "heavy"), "--payload"),
        (("--instrument", "z"), "--instrument"),
        (("--avoid", "here"), "--avoid"),
        (("--sigma", "0 mm"), "--sigma"),
    ],
)
def test_wrong_input_is_told_before_what_was_recorded_is_diagnosed(linkwright, bench, monkeypatch, option, named):
    monkeypatch.setattr("linkwright.diagnose", lambda *_, **__: pytest.fail("diagnosed"))
    (bench / "r.csv").write_text("q1_deg,q2_deg,x_mm,y_mm\n0,0,700,0\n10,0,690,100\n")
    status, out, err = linkwright("plan", "arm.yaml", "--poses", "20", "--after", "r.csv", *option)
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert err.startswith(named)


def test_two_causes_that_are_both_asked_for_are_one_pair():
    """All pairs of causes and no more; one is told apart where each of the two is told from the other."""
    promise = lw.plan(ARM, poses=9, for_=["encoder_offset"], repeats=2, payloads=["1 kg"], seed=3).found.promise
    causes = {(item.effect, item.at) for item in promise.shown}
    named = [(cause, other) for item in promise.shown for cause in [(item.effect, item.at)] for other in item.others]
    both = sum(cause in causes and other in causes for cause, other in named)
    assert both > 0
    assert promise.pairs == len(named) - both // 2
    one = promise.shown[0]
    rival = Rival(*one.others[0], 1.0, math.inf)
    blind = replace(promise, shown=(replace(one, rivals=(rival,)), *promise.shown[1:]))
    none = replace(promise, shown=tuple(replace(item, rivals=()) for item in promise.shown))
    assert none.separated == none.pairs
    assert replace(blind, shown=(blind.shown[0],)).separated == len(one.others) - 1


def test_a_plan_takes_the_noise_of_a_recording_without_repeats(tmp_path):
    """Where nothing else tells it what was found leaves no more than that: 60 um each of x and y."""
    first = tmp_path / "first.csv"
    lw.simulate(ARM, poses=30, repeats=1, noise="60 um").save(first)
    result = lw.plan(ARM, poses=9, for_=["backlash"], after=first)
    assert result.found.after.sigma is None
    assert result.found.asked.sigma == pytest.approx(60e-6, rel=0.25)


def headline_of(found, random):
    """What is said of a plan beside such plans at random."""
    return describe(replace(found, random=tuple(random))).headline


def test_a_plan_that_is_no_better_than_random_poses_says_so():
    """Of causes told apart and of sizes by themselves; 629 of 819 is not more than 630 of them."""
    result = lw.plan(ARM, poses=9, for_=["encoder_offset"], repeats=2, payloads=["1 kg"], seed=3).found
    own = result.promise
    coarse = replace(own, shown=tuple(replace(item, smallest=2.0 * item.smallest) for item in own.shown))
    hard = [replace(item, rivals=tuple(replace(r, resolved_size=math.inf) for r in item.rivals)) for item in own.shown]
    worse = replace(own, shown=tuple(hard))
    assert 0 < worse.separated < own.separated
    assert headline_of(result, [own] * 3).endswith("and are no better than poses at random.")
    assert headline_of(result, [worse, own, worse]).endswith("and are no better than poses at random.")
    assert ", more than poses at random, and show sizes no smaller" in headline_of(result, [worse] * 3)
    both = replace(own, shown=tuple(replace(item, smallest=2.0 * item.smallest) for item in hard))
    assert headline_of(result, [both] * 3).endswith("apart and show sizes 2 times smaller than poses at random.")
    assert ", no more than poses at random, and show sizes 2 times smaller" in headline_of(result, [coarse] * 3)
    assert "random" not in headline_of(result, [])


@pytest.mark.slow
def test_a_plan_says_where_its_poses_were_taken_from(linkwright, tmp_path):
    """All of the joint ranges, or clear of a half-space by the option or the arm file."""
    arguments = ("--poses", "8", "--for", "encoder_offset", "--repeats", "1", "--payload", "1 kg")
    status, said, _ = linkwright("plan", str(ARM), *arguments)
    assert status == 0
    assert "whole of the joint ranges, and not checked for collisions" in " ".join(said.split())
    arm = tmp_path / "arm.yaml"
    arm.write_text(ARM.read_text(encoding="utf-8") + "avoid: [{below: {x: -0.1 m}}]\n", encoding="utf-8")
    out = tmp_path / "plan.csv"
    option = ("--avoid", "below y -50 mm", "--avoid", "0.6 m, 0.2 m to 1 m, 0.6 m", "--out", str(out))
    status, said, err = linkwright("plan", str(arm), *arguments, *option)
    assert (status, err) == (0, "")
    assert "kept clear of by joints, links and tip" in " ".join(said.split())
    model = lw.read_arm(arm).model
    regions = (*model.avoid, beyond("below", "y", -0.05), between((0.6, 0.2), (1.0, 0.6)))
    q = np.radians(pd.read_csv(out)[["q1_deg", "q2_deg", "q3_deg"]].to_numpy())
    assert not meets(model, q, regions).any()
    assert meets(model, np.radians([[0.0, -20.0, 0.0]]), regions).all()
