"""What is said of motion logs: one description for page, screen and Markdown, and JSON by the contract."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from linkwright.face.motion.log import unlike_arrays
from linkwright.json.motion import motion_json
from linkwright.markdown.described import markdown
from linkwright.output.files import json_text
from linkwright.report.charts.joints import joints_at_a_glance
from linkwright.report.charts.rollout import rolled_out_against_time
from linkwright.report.described import page_of
from linkwright.results.diagnoses.answer import MOST_WORDS
from linkwright.results.motion.answer import answer, to_do
from linkwright.results.motion.described import describe
from linkwright.screen.console import console
from linkwright.screen.described import show
from tests.diagnose.made_diagnosis import made_arm
from tests.linkwright.motion.made_motion import made_log, made_motion, made_rollout
from tests.linkwright.reports.test_report import Page

NOISY = ("q", "velocity", "measured", "before", "after", "friction")
VERDICTS = ("none", "named", "alias_class", "unknown", "insufficient_data")


def on_screen(diagnosis, capsys):
    show(console(), describe(diagnosis))
    return " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("verdict", VERDICTS)
def test_answer_is_short(verdict):
    """A sentence, whatever the verdict."""
    said = answer(made_motion(verdict))
    assert len(said.split()) <= MOST_WORDS
    assert said.endswith(".")


def test_a_p_value_that_no_draw_reached_is_a_bound(capsys):
    """Of 199 draws one more would be 0.005, of the lesser of two tests 0.01; what draws did reach is a share."""
    none, some = (on_screen(replace(made_motion(), gate_p=p), capsys) for p in (0.01, 0.02))
    assert "any mismatch at all: p ≤ 0.01" in none
    assert "any mismatch at all: p 0.02" in some


def test_answer_names_the_largest():
    """By what it adds to all joints together, with its size, its share and what remains."""
    said = answer(made_motion())
    assert said.startswith("Found: ")
    assert (
        "(joint 2), 13 N·m and 5 smaller causes (100 % of the mismatch). Error 12.5 → 0.2 N·m, the noise floor." in said
    )


def test_answer_says_what_is_not_explained():
    """First where names explain less than half of the mismatch: where, on what it depends; else beside the names."""
    result = made_motion("unknown")
    said = answer(result)
    assert said.startswith(
        "Found: dry (Coulomb) friction (joint 2) and 5 smaller causes (100 % of the 12.5 N·m mismatch). "
    )
    assert ". Not explained: 0.9 N·m at joint 3" in said
    said = answer(replace(result, rms_after=0.8 * result.rms_before))
    assert said.startswith("Not explained: 0.9 N·m at joint 3. It depends on the coordinate of joint")
    assert to_do(made_motion("unknown"))[0] == "To find the cause, turn joint 3 slowly both ways."


@pytest.mark.parametrize("verdict", VERDICTS)
def test_page(verdict):
    """Well-formed, small enough to be mailed, with a figure for each joint, and every finding's sentence."""
    diagnosis = made_motion(verdict)
    made = page_of(describe(diagnosis))
    page = Page(made)
    assert page.open == []
    assert len(made) <= 2_000_000
    assert [name for name in page.figures if name.startswith("torque-1-")] == [f"torque-1-{k}" for k in (1, 2, 3)]
    assert all(finding.reading in page.text for finding in diagnosis.findings)
    assert answer(diagnosis) in page.text


def test_page_of_many_joints_and_logs_stays_small():
    """Twelve joints in three logs, all noise, which packs worst."""
    diagnosis = made_motion()
    rng, trace = np.random.default_rng(1), diagnosis.traces[0]
    arm = replace(diagnosis.arm, joints=diagnosis.arm.joints * 4, links=diagnosis.arm.links * 4)
    noise = {name: rng.standard_normal((1500, 12)) for name in NOISY}
    wide = replace(trace, **noise, moves=np.ones((1500, 12), dtype=bool))
    joints = tuple(replace(diagnosis.per_joint[k % 3], joint=k + 1) for k in range(12))
    findings = tuple(replace(item, rms_explained=4 * item.rms_explained) for item in diagnosis.findings)
    many = replace(diagnosis, arm=arm, traces=(wide, wide, wide), per_joint=joints, findings=findings)
    made = page_of(describe(many))
    assert len(made) <= 2_000_000
    assert "2 more logs are not drawn" in Page(made).text


def test_figures_hold_what_was_measured():
    """Measured, before and after over the same time, in N·m."""
    diagnosis = made_motion()
    figure = Page(page_of(describe(diagnosis))).figures["torque-1-2"]
    named = {line["name"]: line for line in figure["data"]}
    assert list(named) == ["measured", "before", "after"]
    time = np.array(named["measured"]["x"])
    trace = diagnosis.traces[0]
    for name in named:
        expected = np.interp(time, trace.time, getattr(trace, name)[:, 1])
        np.testing.assert_allclose(named[name]["y"], expected, atol=0.01)
    assert figure["layout"]["yaxis"]["title"]["text"] == "N·m"


def cards(diagnosis):
    """What is told and drawn of each joint at a glance, by its heading."""
    drawn = joints_at_a_glance(diagnosis)
    return dict(re.findall(r'<div class="card"><h3>(Joint \d+)</h3>(.*?)</div>', drawn, re.DOTALL))


def curve(svg, class_):
    """The points of the curves of a class in a drawing, one under another."""
    found = re.findall(rf'd="M([^"]*)" class="course {class_}"', svg)
    return [np.array([[float(x) for x in pair.split(",")] for pair in item.split("L")]) for item in found]


def test_each_joint_has_its_causes_at_a_glance():
    """The largest cause first with what it adds there; what is not explained, and where a joint stands still."""
    made = cards(made_motion("unknown"))
    assert list(made) == ["Joint 1", "Joint 2", "Joint 3"]
    assert "17.7 → 0.2 N·m</strong>. Dry (Coulomb) friction 14 N·m, viscous friction 7.1 N·m.</p>" in made["Joint 2"]
    assert "The rest is not explained. It depends on the coordinate of joint 3 and speed." in made["Joint 3"]
    assert "is not explained" not in made["Joint 1"]
    assert "(or 2 other names)" in cards(made_motion("alias_class"))["Joint 1"]
    assert "Nothing is missing." in cards(made_motion("none"))["Joint 2"]
    trace = made_motion().traces[0]
    still = replace(trace, moves=trace.moves & np.array([False, True, True]))
    assert cards(replace(made_motion(), traces=(still,)))["Joint 1"] == '<p class="lead">It does not move.</p>'


def test_friction_is_drawn_over_speed():
    """The law at each speed is that fitted, with a step where the joint turns; data are what the rest leaves. What is
    left is drawn where the model as given leaves most."""
    time, left, friction = re.findall(r"<figure>(.*?)</figure>", cards(made_motion())["Joint 2"], re.DOTALL)
    back, forth = curve(friction, "law")
    speed = np.concatenate((back, forth))[:, 0]
    assert "dots before" in friction
    # Both frames are linear: of a law f + d v each way, the slopes agree, and the step is 2 f.
    slopes = [np.polyfit(item[:, 0], item[:, 1], 1) for item in (back, forth)]
    assert slopes[0][0] == pytest.approx(slopes[1][0], rel=0.05)
    assert (np.diff(speed) > 0.0).all()
    step = slopes[0][1] - slopes[1][1]
    rise = -slopes[0][0] * (speed[-1] - speed[0])
    # 13 N·m each way, and 8 N·m s/rad over the speeds drawn (0.8 x 1.1 rad/s each way, less the edge bins' halves).
    assert step / rise == pytest.approx(2.0 * 13.0 / (8.0 * 2.0 * 0.88), rel=0.06)
    assert len(curve(time, "measured")) == len(curve(left, "after")) == 1
    assert np.ptp(curve(left, "before")[0][:, 1]) > 10.0 * np.ptp(curve(left, "after")[0][:, 1])


def test_slides_are_told_in_newtons(capsys):
    """A slide's drive gives a force."""
    arm = made_arm()
    arm = replace(arm, joints=(*arm.joints[:2], replace(arm.joints[2], type="prismatic", range=(0.0, 0.5))))
    diagnosis = made_motion(arm=arm)
    assert "5.8 N 0.2 N" in on_screen(diagnosis, capsys)
    assert [item["unit"] for item in motion_json(diagnosis)["per_joint"]] == ["N*m", "N*m", "N"]


def test_screen_and_markdown_say_the_same(capsys):
    """The same figures stand on both; what is detail stands in Markdown alone."""
    diagnosis = made_motion("alias_class")
    screen, page = on_screen(diagnosis, capsys), markdown(describe(diagnosis))
    for said in ("12.5 N·m", "12.3 to 13.7 N·m", "every third stretch of 5 s"):
        assert said in screen
        assert said in page
    assert "exactly alike" in screen
    assert "2.5 nats less" in screen
    assert "evidence in nats" in page
    assert "evidence in nats" not in screen


def test_json_by_the_contract():
    """Figures in N·m by joint; alternatives are what the logs cannot tell, each once and never the finding itself."""
    diagnosis = made_motion("alias_class")
    content = json.loads(json_text(motion_json(diagnosis)))
    assert (content["observes"], content["rms_unit"], content["verdict"]) == ("motion", "N*m", "alias_class")
    first = content["per_joint"][0]
    keys = {"joint", "rms_before", "rms_after", "rms_after_held_out", "noise_floor", "share_of_torque"}
    assert keys <= first.keys()
    assert first["rms_before"] == pytest.approx(diagnosis.per_joint[0].before)
    finding = content["missing"][0]
    assert finding["effect"] == "friction_coulomb"
    assert finding["at"] == [1]
    assert finding["parameters"]["torque_1"]["value"] == pytest.approx(9.0)
    assert finding["parameters"]["torque_1"]["unit"] == "N*m"
    assert finding["parameters"]["torque_1"]["ci95"] == pytest.approx([8.55, 9.45])
    assert finding["alternatives"] == [["torque_offset", [1]], ["friction_asymmetry", [1]], ["friction_load", [1]]]
    assert finding["alternatives_detail"][0]["worse_nats"] == 0.0
    assert finding["evidence_nats"] == 420.0
    assert content["unknown"] is None
    assert content["rejected_rows"] == [7]


def test_json_of_the_unknown():
    """Where it sits and on what it depends."""
    content = motion_json(made_motion("unknown"))
    assert content["unknown"]["joints"] == [3]
    assert content["unknown"]["depends_on"] == ["q3", "speed"]
    assert content["where"]["depends_on"] == ["q3", "speed"]
    assert content["where"]["joint"] == 2


def test_what_one_log_alone_has_is_not_in_the_file(capsys):
    """What is left beside it and what the file leaves stand apart."""
    assert "arm file alone" not in on_screen(made_motion(), capsys)
    own = replace(made_motion(), rms_after=1.4, rms_held_out=1.5, rms_with_own=(0.21, 0.22))
    screen = on_screen(own, capsys)
    assert "with what was found 0.21 N·m" in screen
    assert "on motion not fitted 0.22 N·m" in screen
    assert "by the arm file alone 1.4 N·m" in screen
    content = motion_json(own)
    assert (content["rms_after"], content["rms_with_own"]) == (1.4, 0.21)


def test_several_logs_are_told_apart(capsys):
    """Each log's own figures; rows with the file they stand in."""
    made = made_motion()
    other = replace(made.logs[0], file="loaded.csv", rejected=())
    of_logs = (made.of_logs[0], replace(made.of_logs[0], name="loaded.csv", file="loaded.csv", rejected=()))
    diagnosis = replace(made, logs=(made.logs[0], other), of_logs=of_logs)
    screen = on_screen(diagnosis, capsys)
    assert "Row 7 of log.csv is set aside" in screen
    content = motion_json(diagnosis)
    assert [item["name"] for item in content["logs"]] == ["log.csv", "loaded.csv"]
    assert content["rejected_rows_detail"] == [{"log": "log.csv", "row": 7, "reason": "torque 2 is 1e282 N*m"}]


def test_currents_without_constants_are_a_warning(capsys):
    """What is given in N·m is in A then; the first thing to do is to write them down."""
    made = made_motion()
    currents = replace(made, logs=(replace(made.logs[0], torque_constants_free=True),))
    assert "WARNING: Nobody says the torque constants of log.csv" in on_screen(currents, capsys)
    assert to_do(currents)[0].startswith("Write the torque constants into recording.yaml")
    assert "WARNING" not in on_screen(made, capsys)


def test_a_joint_that_stood_still_is_told(capsys):
    """No figure is given of it on the page, the screen or in JSON, and the joint where most is left is another."""
    made, nan = made_motion(), float("nan")
    still = replace(made.per_joint[0], before=nan, after=nan, held_out=nan, floor=nan, share=nan)
    diagnosis = replace(made, per_joint=(still, *made.per_joint[1:]))
    assert re.search(r"1 (– ){5}stood still", on_screen(diagnosis, capsys))
    assert "stood still or not logged" in page_of(describe(diagnosis))
    assert not re.search(r"\bnan\b", markdown(describe(diagnosis)))
    content = json.loads(json_text(motion_json(diagnosis)))
    assert content["per_joint"][0]["rms_before"] is None
    assert content["where"]["joint"] == 2
    too_little = replace(made, per_joint=tuple(replace(still, joint=item.joint) for item in made.per_joint))
    assert "still" not in on_screen(too_little, capsys)


def test_a_motion_that_reads_back_otherwise_is_told():
    """Digits that a file does not hold are no difference; a figure that is lost is one, as is another number of
    samples."""
    meant = made_log()
    rounded = replace(meant, torque=meant.torque * (1.0 + 1e-7))
    assert not list(unlike_arrays(meant, rounded, "time", "q", "torque"))
    torque = meant.torque.copy()
    torque[3, 1] = np.nan
    assert list(unlike_arrays(meant, replace(meant, torque=torque), "q", "torque")) == ["another torque"]
    assert list(unlike_arrays(meant, replace(meant, time=meant.time[1:]), "time", "q")) == ["another time"]


def test_a_rollout_is_told_and_drawn(capsys):
    """Degrees at the ends before and after, what left its range, what acts beside the file, and a picture a joint."""
    diagnosis = made_motion(rollout=made_rollout(made_log()))
    said = on_screen(diagnosis, capsys)
    assert "1 11.5 ° 0.115 °" in said  # 0.2 rad, 0.002 rad
    assert "1 before" in said
    assert "friction that grows with the load" in said
    drawn = rolled_out_against_time(diagnosis.arm, diagnosis.rollout)
    assert drawn.count("<svg") == diagnosis.arm.size
    for name in ("measured", "before", "after"):
        assert drawn.count(f'class="course {name}"') == 12 * diagnosis.arm.size
    assert "nan" not in drawn
    assert "Rollout" in page_of(describe(diagnosis))


def test_a_rollout_in_json():
    held = motion_json(made_motion(rollout=made_rollout(made_log())))["rollout"]
    assert held["left_range"] == {"before": 1, "after": 0, "held_out": 0}
    assert held["beside_mjcf"] == ["friction_load"]
    assert held["per_joint"][1]["before"] == {"q": 0.2, "q_end": 0.4, "dq": 0.8, "dq_end": 1.0}
    assert motion_json(made_motion())["rollout"] is None


def test_why_nothing_was_simulated_is_told(capsys):
    lacks = replace(
        made_rollout(made_log()), windows=0, per_joint=(), traces=(), lacks="the torque of joint 2 was not logged"
    )
    said = on_screen(made_motion(rollout=lacks), capsys)
    assert "Nothing was simulated: the torque of joint 2 was not logged." in said
