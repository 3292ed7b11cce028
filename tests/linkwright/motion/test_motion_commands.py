"""Motion logs through the same commands and functions as recordings of a tip, from a URDF to what is written."""

import functools
import json
import re
import shutil
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import linkwright as lw
from linkwright.cli import run
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics
from linkwright.face.motion.diagnosis import MotionDiagnosis
from tests.linkwright.motion.made_motion import made_log, made_motion, made_rollout

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "motion-log"
URDF, LOG, OTHER = (str(EXAMPLE / name) for name in ("robot.urdf", "log.csv", "other.csv"))
COULOMB, VISCOUS = (7.0, 9.0, 4.0, 1.2), (5.0, 6.0, 2.5, 0.4)


@pytest.fixture(scope="module")
def diagnosed(tmp_path_factory):
    """The folder that `diagnose` leaves of the example, whose logs are MuJoCo's, and the result in Python that it is
    written of."""
    folder, results, diagnose = tmp_path_factory.mktemp("motion") / "found", [], lw.diagnose

    @functools.wraps(diagnose)
    def kept(*given, **more):
        results.append(diagnose(*given, **more))
        return results[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lw, "diagnose", kept)
        assert run(["diagnose", URDF, LOG, "--out", str(folder), "--quiet"]) == 0
    (result,) = results
    return folder, result


@pytest.fixture(scope="module")
def found(diagnosed):
    """The folder."""
    return diagnosed[0]


@pytest.fixture(scope="module")
def content(found):
    """Its diagnosis.json."""
    return json.loads((found / "diagnosis.json").read_text(encoding="utf-8"))


def test_the_folder_is_that_of_a_diagnosis(found):
    """A page, the corrected arm, the figures."""
    assert {item.name for item in found.iterdir()} == {"report.html", "arm.yaml", "diagnosis.json"}


def test_what_was_concealed_is_named(content):
    """Dry and viscous friction at every joint with their sizes, the gripper, the rotor."""
    assert content["observes"] == "motion"
    assert content["verdict"] in ("named", "alias_class")
    named = {(item["effect"], tuple(item["at"])): item for item in content["missing"]}
    for joint in range(1, 5):
        for effect, name, sizes in (("coulomb", "torque", COULOMB), ("viscous", "coefficient", VISCOUS)):
            value = named[f"friction_{effect}", (joint,)]["parameters"][f"{name}_{joint}"]["value"]
            assert value == pytest.approx(sizes[joint - 1], rel=0.05)
    load = named["payload", ()]["parameters"]["mass"]
    assert load["ci95"][0] - 0.02 < 1.6 < load["ci95"][1] + 0.02
    assert named["armature", (2,)]["parameters"]["inertia_2"]["value"] == pytest.approx(0.9, rel=0.05)


def test_what_is_left_is_noise_on_motion_that_was_not_fitted(content, found):
    """Joint by joint, and as the written arm says on another log, where the model as given leaves a hundred times as
    much."""
    for item in content["per_joint"]:
        assert item["rms_after_held_out"] < 0.05 * item["rms_before"]
    written = content["written_arm"]
    assert written["rms"] <= 1.1 * written["promised"]
    arm = lw.read_arm(found / "arm.yaml")
    assert lw.predict(arm, OTHER).rms < 0.01 * lw.predict(URDF, OTHER).rms


def test_predict_says_what_is_left_of_each_joint(found, tmp_path, capsys):
    """On the screen and in JSON, by the contract."""
    assert run(["predict", str(found / "arm.yaml"), OTHER, "--json", str(tmp_path / "p.json")]) == 0
    assert "RMS of all joints together, nothing fitted" in capsys.readouterr().out
    told = json.loads((tmp_path / "p.json").read_text(encoding="utf-8"))
    assert [item["joint"] for item in told["per_joint"]] == [1, 2, 3, 4]
    assert all(0.0 < item["share_of_torque"] < 0.02 for item in told["per_joint"])
    assert told["rms"] == pytest.approx(np.sqrt(np.mean([item["rms"] ** 2 for item in told["per_joint"]])))


def test_a_diagnosis_in_python(diagnosed, content):
    """The same as the command's: tables with units, a line, the corrected arm."""
    dia = diagnosed[1]
    assert repr(dia).startswith("<MotionDiagnosis: ")
    assert dia.verdict == content["verdict"]
    assert dia.rms_held_out == pytest.approx(content["rms_after_held_out"])
    row = dia.findings[(dia.findings["effect"] == "friction_coulomb") & (dia.findings["at"] == (2,))].iloc[0]
    assert (row["parameter"], row["unit"]) == ("torque_2", "N*m")
    assert row["low"] < row["value"] < row["high"]
    assert list(dia.per_joint["joint"]) == [1, 2, 3, 4]
    assert lw.predict(dia.corrected, LOG).rms == pytest.approx(dia.found.written.rms, rel=1e-3)
    assert {"t_s", "before2_Nm", "after2_Nm"} <= set(dia.residuals.columns)


def test_questions_of_a_tip_are_one_line(capsys, found):
    """Frame, units and designs go with recordings of a tip; kinds do not mix; a file counts once."""
    tip = str(EXAMPLE.parent / "hidden-backlash" / "recording.csv")
    for words, said in (
        (["diagnose", URDF, LOG, OTHER, "--units"], "--units: goes with recordings of a tip"),
        (["diagnose", URDF, LOG, LOG], "is named twice"),
        (["diagnose", str(EXAMPLE.parent / "hidden-backlash" / "arm.yaml"), tip, "--rollout"], "goes with motion logs"),
        (["simulate", URDF, "--motion", "10 s", "--poses", "3", "--out", str(found / "x.csv")], "goes without poses"),
    ):
        assert run(words) == 2, words
        assert said in capsys.readouterr().err, words
    arm = lw.read_arm(EXAMPLE.parent / "hidden-backlash" / "arm.yaml")
    with pytest.raises(lw.InputError, match="frame: goes with recordings of a tip"):
        lw.predict(URDF, OTHER, frame="free")
    currents = lw.read_log(LOG, URDF).table.rename(
        columns=lambda name: name.replace("tau", "current").replace("Nm", "A")
    )
    with pytest.raises(lw.InputError, match="torque_constants: is missing"):
        lw.predict(URDF, currents)
    with pytest.raises(lw.InputError, match="holds nothing of the tip"):
        lw.plan(arm, poses=10, after=lw.read_log(LOG, URDF))
    assert run(["diagnose", str(EXAMPLE.parent / "hidden-backlash" / "arm.yaml"), tip, LOG]) == 2


def test_a_rollout_without_mujoco_is_one_line(monkeypatch, capsys):
    """Said before anything is computed, with what to type."""
    monkeypatch.setitem(sys.modules, "mujoco", None)
    assert run(["diagnose", URDF, LOG, "--rollout"]) == 2
    assert "rollout: a rollout needs mujoco, not installed here: pip install" in capsys.readouterr().err


def test_a_rollout_is_a_table_in_python():
    """A row a joint, as in JSON; none where nobody asked."""
    found = made_motion(rollout=made_rollout(made_log()))
    dia = MotionDiagnosis(lw.Arm.of(found.arm), (), found)
    first = dia.rollout.iloc[0]
    assert (first["joint"], first["q_end_before"], first["dq_after"]) == (1, 0.2, 0.004)
    assert MotionDiagnosis(lw.Arm.of(found.arm), (), made_motion()).rollout is None


def test_a_design_that_friction_does_not_change_is_no_answer():
    """What loads the drives alone moves no tip."""
    rubs = made_motion()
    dia = MotionDiagnosis(lw.Arm.of(rubs.arm), (), rubs)
    problem = lw.Problem(lw.read_arm(EXAMPLE.parent / "welding-arm" / "arm.yaml"), choose={"same": ["size"]})
    with pytest.raises(lw.NoAnswer, match="moves no tip"):
        lw.redesign(problem, dia)


def dated(arm, folder, months, joint, before, after, change):
    """Logs of a joint whose dry friction is `before`, from the `change`th on `after`."""
    files = []
    for number in range(months):
        friction = {"effect": "friction_coulomb", "at": joint, "torque": f"{after if number >= change else before} N*m"}
        log = lw.simulate(arm, motion="8 s", with_=[friction], torques="0.1 N*m", seed=number + 1)
        file = folder / f"month-{number + 1:02d}.csv"
        _, settings = log.save(file)
        with settings.open("a", encoding="utf-8") as stream:
            stream.write(f"date: 2026-{number + 1:02d}-05\n")
        files.append(str(file))
    return files


TWO_DRIVES = """\
name: two drives in a vertical plane
chain:
  - {joint: {range: [-90 deg, 90 deg]}, link: {length: 400 mm, rigid: true, mass: 4 kg}}
  - {joint: {range: [-120 deg, 120 deg]}, link: {length: 300 mm, rigid: true, mass: 3 kg}}
"""


@pytest.fixture(scope="module")
def arm_and_months(tmp_path_factory):
    """The file of a small arm, and six months of its second joint, whose friction rises by 30 % in the fourth."""
    folder = tmp_path_factory.mktemp("months")
    arm = folder / "arm.yaml"
    arm.write_text(TWO_DRIVES, encoding="utf-8")
    return str(arm), dated(lw.read_arm(arm), folder, 6, 2, 4.0, 5.2, 3)


def test_compare_says_what_changed(arm_and_months, tmp_path, capsys):
    """The friction that rose, with sizes in both; what was there before is the same."""
    arm, months = arm_and_months
    assert run(["compare", arm, months[0], months[-1], "--json", str(tmp_path / "compared.json")]) == 0
    said = capsys.readouterr().out
    (rose,) = json.loads((tmp_path / "compared.json").read_text(encoding="utf-8"))["changes"]
    before, after = rose["first"]["value"], rose["second"]["value"]
    assert [before, after] == pytest.approx([4.0, 5.2], abs=0.03)
    sizes = f"torque from {before:.3g} N·m to {after:.3g} N·m."
    assert said.startswith(f"Changed: dry (Coulomb) friction (joint 2), {sizes}")
    assert "Nothing else differs between the logs by more than" in said
    same = lw.compare(arm, months[0], months[1])
    assert "Nothing that was fitted changed beyond doubt." in same.sentence


def test_watch_says_since_when(arm_and_months, tmp_path, capsys):
    """By how much, as a share, and between which dates; the page has its chart."""
    arm, months = arm_and_months
    assert run(["watch", arm, *months, "--out", str(tmp_path / "watched")]) == 0
    said = capsys.readouterr().out
    by = r"torque by \+1\.[12]\d* N·m \(\+(29|30|31) %\) between 2026-03-05 and 2026-04-05"
    assert re.search(rf"dry \(Coulomb\) friction \(joint 2\): {by}", said)
    told = json.loads((tmp_path / "watched" / "result.json").read_text(encoding="utf-8"))
    assert told["observes"] == "motion"
    assert told["alarms"][0]["change"] == pytest.approx(1.2, abs=0.05)
    undated = shutil.copy(months[0], tmp_path / "undated.csv")
    with pytest.raises(lw.InputError, match="date"):
        lw.watch(arm, [*months[1:3], undated])


def test_a_planned_motion_tells_apart_more_than_one_at_random(tmp_path, capsys):
    """Written, simulated, and read again; nothing to tell apart is no answer."""
    plan, log = tmp_path / "plan.csv", tmp_path / "log.csv"
    words = ["plan", URDF, "--instrument", "motion", "--for", "friction_load:2,friction_place:2", "--seconds", "10"]
    assert run([*words, "--out", str(plan), "--json", str(tmp_path / "plan.json")]) == 0
    told = json.loads((tmp_path / "plan.json").read_text(encoding="utf-8"))
    worst = told["apart"][0]
    assert {worst["effect"], worst["other"]} == {"friction_load", "friction_place"}
    assert worst["share"] > worst["random"]
    for joint in told["joints"]:
        assert joint["fastest_radps"] <= 1.001 * joint["limit_radps"]
    friction = "{effect: friction_load, at: 2, share: 0.08}"
    assert run(["simulate", URDF, "--motion", str(plan), "--with", friction, "--out", str(log)]) == 0
    assert lw.read_log(log, URDF).found.size == told["samples"]
    capsys.readouterr()
    assert run(["plan", URDF, "--instrument", "motion", "--for", "link_bending"]) == 1
    assert "no two causes" in capsys.readouterr().err


def test_a_log_says_how_far_it_tells_names(tmp_path, capsys):
    """Before a diagnosis, in plain words; what goes together is said."""
    words = ["plan", URDF, "--instrument", "motion", "--at", LOG, "--for", "payload,link_inertial:4,friction_viscous:1"]
    assert run([*words, "--json", str(tmp_path / "told.json")]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "1 of 3 names are told" in said
    assert "Intervals hold if all 3 causes listed were there at once" in said
    assert "They count white noise alone." in said
    assert "cannot be told: goes with" in said
    told = {
        item["effect"]: item for item in json.loads((tmp_path / "told.json").read_text(encoding="utf-8"))["expected"]
    }
    assert told["payload"]["goes_with"] == ["link_inertial", [4]]
    assert told["friction_viscous"]["shown"]
    assert told["friction_viscous"]["random"] is None
    assert run(["plan", URDF, "--poses", "10", "--at", LOG]) == 2
    assert "--instrument motion" in capsys.readouterr().err


UNWEIGHED = """<mujoco><asset><mesh name="f" file="fore.stl"/></asset><worldbody><body name="upper" pos="0 0 0.3">
  <inertial pos="0.16 0 0" mass="2.5" diaginertia="0.003 0.028 0.028"/><joint name="a" axis="0 1 0" range="-90 90"/>
  <body name="fore" pos="0.35 0 0"><joint name="b" axis="0 1 0" range="-90 90"/>{}<site name="tip" pos="0.3 0 0"/>
</body></body></worldbody></mujoco>"""


def test_a_log_tells_what_a_link_of_unknown_mass_weighs(tmp_path):
    """Its mesh is not there: 1.5 kg, known to the file that the log is made with alone."""
    weighed, unread = tmp_path / "weighed.xml", tmp_path / "unread.xml"
    weighed.write_text(UNWEIGHED.format('<inertial pos="0.12 0 0" mass="1.5" diaginertia="0.001 0.012 0.012"/>'))
    unread.write_text(UNWEIGHED.format('<geom type="mesh" mesh="f"/>'))
    time, draw = np.arange(2000) / 100.0, np.random.default_rng(4)
    waves = [(0.8, 0.7, 0.3, 2.9), (0.6, 1.1, 0.3, 2.3)]  # of each joint two: amplitude (rad) and rate (rad/s)

    def moved(order):
        return np.stack(
            [
                sum(size * rate**order * np.sin(rate * time + order * np.pi / 2) for size, rate in (each[:2], each[2:]))
                for each in waves
            ],
            axis=1,
        )

    q, v, a = (moved(order) for order in range(3))
    torque = inverse_dynamics(Motion(lw.read_arm(weighed).model, np.zeros(len(q)), q, v, a))
    torque = torque + 0.3 * np.tanh(v / 0.01) + 0.02 * draw.standard_normal(q.shape)
    columns = {"t_s": time} | {f"{name}{k + 1}_{unit}": values[:, k] for k in (0, 1) for name, unit, values in (
        ("q", "rad", q), ("dq", "radps", v), ("tau", "Nm", torque))}  # fmt: skip
    result = lw.diagnose(unread, pd.DataFrame(columns))
    said = " ".join(result.logs[0].found.warnings)
    assert "Not there as a closed STL: fore.stl. The weight of fore is unknown; write <inertial " in said
    assert "The mass of link 2 is unknown. It counts as 0 kg" in said
    masses = result.findings.query("parameter.str.startswith('mass')")
    assert list(masses["value"]) == [pytest.approx(1.5, rel=0.05)]
    assert result.rms_held_out < 0.05 * result.rms_before
    result.corrected.save(tmp_path / "arm.yaml")
    assert lw.predict(tmp_path / "arm.yaml", pd.DataFrame(columns)).rms == pytest.approx(result.rms_after, rel=0.2)
