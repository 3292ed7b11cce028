"""The proof of motion logs proved: its mechanics against first principles, its causes, its halves, its scoring."""

import json
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from benchmarks.blind.answers import load
from benchmarks.motion.commands import main
from benchmarks.motion.generator.arms import FAMILIES, STEP, Arm, Rigid, draw_arm, mjcf, with_drives
from benchmarks.motion.generator.cases import Case, make_case, moved_of
from benchmarks.motion.generator.causes import KINDS
from benchmarks.motion.generator.files import truth_of
from benchmarks.motion.generator.moved import LARGE, Cause, Moved
from benchmarks.motion.generator.signals import low_passed, moving, rms
from benchmarks.motion.generator.sizes import sized
from benchmarks.motion.generator.trajectories import draw_reference
from benchmarks.motion.generator.unknowns import CLASSES, DEVELOPMENT, PROOF, About, draw_unknown, drawn_split, install
from benchmarks.motion.generator.world import declared_torque, simulate, world_of
from benchmarks.motion.names import in_class, is_alike
from benchmarks.motion.score import score, shown
from tests.benchmarks.judged import BENCHMARKS, JUDGED, no_templates, nothing_judged


def drawn(family: str, seed: int = 3, seconds: float = 6.0) -> tuple[Arm, Moved, np.ndarray]:
    rng = np.random.default_rng(seed)
    arm = draw_arm(family, rng)
    reference = draw_reference(arm, seconds, rng)
    load = rms(Rigid.of(arm).torque(reference.q, reference.velocity, reference.acceleration))
    least = load + 0.04 * load.max()
    return with_drives(arm, np.outer((0.2, 0.1, 0.01), least)), reference, load


def test_inverse_dynamics_are_those_of_mujoco():
    for family in FAMILIES:
        arm = draw_arm(family, np.random.default_rng(5))
        q, v, a = np.random.default_rng(1).uniform(-0.5, 0.5, (3, 4, arm.count))
        model = mujoco.MjModel.from_xml_string(mjcf(arm, drives=False))
        data = mujoco.MjData(model)
        for k in range(len(q)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            np.testing.assert_allclose(Rigid.of(arm).torque(q, v, a)[k], data.qfrc_inverse, atol=1e-9)


def test_drives_work_is_energy_and_nothing_else():
    """Of an arm without friction; the sum over steps converges with them."""
    arm, reference, _ = drawn("six_offset_wrist")
    arm = with_drives(arm, np.outer((0.0, 0.0, 0.05), np.ones(arm.count)))
    track = simulate(world_of(arm), arm, reference, declared_torque(arm, reference))
    model = mujoco.MjModel.from_xml_string(mjcf(arm))
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)

    def energy(k: int) -> float:
        data.qpos[:], data.qvel[:] = track.q[k], track.velocity[k]
        mujoco.mj_forward(model, data)
        return float(data.energy.sum())

    power = np.sum(track.drive * track.velocity, axis=1)
    work = STEP * (np.cumsum(power) - (power[0] + power) / 2.0)
    every = range(0, len(power), 100)
    gained = np.array([energy(k) - energy(0) for k in every])
    assert np.ptp(gained) > 20.0
    np.testing.assert_allclose(gained, work[::100], atol=0.01 * np.ptp(gained))


@pytest.mark.parametrize("effect", sorted(KINDS))
def test_a_cause_in_the_loop_takes_what_its_columns_say(effect: str):
    """Where a joint moves, in the band of slow things; the controller reacts, and that is in it."""
    arm, reference, _ = drawn("six_spherical_wrist", seconds=4.0)
    moved = moved_of(arm, _followed(arm, reference), 5)
    kind = KINDS[effect]
    cause = max(
        (sized(Cause(effect, *kind.draw(arm, np.random.default_rng(k))), [moved], 0.15) for k in range(4)),
        key=lambda item: item.share,
    )
    world = world_of(arm)
    kind.install(cause, world)
    track = simulate(world, arm, reference, declared_torque(arm, reference))
    result = moved_of(arm, track, 1)
    drive = [np.interp(track.time - world.delay[j], track.time, track.drive[:, j]) for j in range(arm.count)]
    part = slice(250, -250)
    without = low_passed(np.stack(drive, axis=1) - result.torque, 1.0 / STEP)[part]
    columns = KINDS[effect].columns(cause, result)
    own = low_passed(sum(s * c for s, c in zip(cause.sizes.values(), columns, strict=True)), 1.0 / STEP)[part]
    good = np.stack([moving(v, 1.0 / STEP) for v in result.velocity[part].T], axis=1)
    scale = rms(result.torque)
    left, before = ((np.where(good, item, 0.0) / scale) for item in (without - own, without))
    assert cause.share > 0.01
    assert float(rms(left).max()) < max(0.25 * float(rms(before).max()), 0.006)


def _followed(arm: Arm, reference: Moved):
    return simulate(world_of(arm), arm, reference, declared_torque(arm, reference))


def test_unknown_classes_are_split_by_class():
    assert drawn_split() == (DEVELOPMENT, PROOF)
    assert set(DEVELOPMENT) | set(PROOF) == set(CLASSES)
    assert not set(DEVELOPMENT) & set(PROOF)
    assert min(len(DEVELOPMENT), len(PROOF)) >= 8


def test_no_unknown_class_has_a_template_in_what_judges_motion_logs():
    """Forms of what depends on nothing but the time are those of tips (diagnose/patterns), which no log is asked by."""
    no_templates(CLASSES, ({*JUDGED} - {"diagnose"}) | {"diagnose/motion"})
    asking = list((BENCHMARKS.parent / "diagnose" / "motion").rglob("*.py"))
    assert len(asking) > 20
    assert not [path for path in asking if "diagnose.patterns" in path.read_text(encoding="utf-8")]


def test_each_unknown_changes_the_torque_and_repeats_by_its_seed():
    arm, reference, load = drawn("scara", seconds=3.0)
    moved = moved_of(arm, _followed(arm, reference), 5)
    about = About(arm, rms(moved.torque), np.abs(moved.q).max(axis=0), np.abs(moved.velocity).max(axis=0), 3.0)
    forward = declared_torque(arm, reference)
    plain = simulate(world_of(arm), arm, reference, forward).drive
    still = []
    for name in CLASSES:
        unknown = draw_unknown(name, arm, 0.4, np.random.default_rng(2))
        tracks = []
        for _ in range(2):
            world = world_of(arm)
            install(unknown, world, about)
            tracks.append(simulate(world, arm, reference, forward).drive)
        np.testing.assert_array_equal(*tracks)
        if float(rms((tracks[0] - plain) / load).max()) < 1e-3:
            still.append(name)
    assert set(still) <= {"controller_saturates", "cable_that_snags", "brake_that_drags"}  # not in 3 s


@pytest.fixture(scope="module")
def null() -> Case:
    return make_case("00000", (7, 0, 0), "development", "null", "scara")


def test_inverse_dynamics_of_a_null_log_leave_its_noise_alone(null: Case):
    """By MuJoCo's own inverse of the arm with its friction, from the log as written."""
    assert null.causes == ()
    np.testing.assert_allclose(null.noise_rms, null.oracle_rms)
    logger = null.logger
    usual = 4.0 * np.hypot(logger.white, logger.slow) + 2.0 * logger.quantum + 0.01
    assert np.all(null.noise_rms / null.torque_rms < usual)
    model = mujoco.MjModel.from_xml_string(mjcf(null.arm))
    data, log = mujoco.MjData(model), null.logs[-1]
    time = np.arange(1.0, log.time[-1] - 1.0, 0.01)
    stamps, rows = np.unique(log.time, return_index=True)
    q = low_passed(np.stack([np.interp(time, stamps, x) for x in log.q[rows].T], axis=1), 100.0, 12.0)
    v = np.gradient(q, time, axis=0)
    a = np.gradient(v, time, axis=0)
    result = np.zeros_like(q)
    for k in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        result[k] = data.qfrc_inverse
    unit = 1.0 if logger.constants is None else np.array(logger.constants)
    torque = np.stack([np.interp(time, stamps, x) for x in (log.torque * unit)[rows].T], axis=1)
    left = low_passed(torque - result, 100.0)
    for j in range(null.arm.count):
        good = moving(v[:, j], 100.0)
        assert float(np.median(np.abs(left[good, j]))) < 2.0 * null.noise_rms[j]


def test_generator_imports_nothing_that_is_judged():
    """Nor does all that these imports reach within benchmarks; only what asks touches the tool, by its command line."""
    nothing_judged("motion", asks={"run.py", "predicted.py"})


def test_truths_are_sealed_and_answers_are_scored(tmp_path):
    """Made, sealed, answered rightly, wrongly and not at all."""
    root, answers = tmp_path / "a", tmp_path / "answers"
    made = ["make", "--cases", "2", "--seed", "11", "--half", "development", "--out", str(root), "--jobs", "1"]
    assert main(made) == 0
    truths = {p.stem: json.loads(p.read_text()) for p in (root / "truth").glob("*.json")}
    assert sorted(t["kind"] for t in truths.values()) == ["null", "one"]
    assert sorted(p.name for p in (root / "cases" / "00001").iterdir())[:2] == ["arm.yaml", "recording-1.csv"]
    answers.mkdir()
    for name, truth in truths.items():
        (answers / f"{name}.json").write_text(json.dumps(answered(truth)))
    given = load(root, answers)
    right = score(given[0], given[1], {}, *given[2:])
    assert all(t.met for t in right.targets if t.met is not None and "intervals" not in t.what)
    assert all(inside.share == 1.0 for title, table in right.tables if "intervals" in title for _, inside in table)
    assert "2 cases of the development half" in shown(right)
    assert not right.misses
    for path in answers.glob("*.json"):
        wrong = json.loads(path.read_text())
        wrong["diagnosis"] |= {"verdict": "named", "missing": [{"effect": "spring", "at": [9], "parameters": {}}]}
        path.write_text(json.dumps(wrong))
    given = load(root, answers)
    bad = score(given[0], given[1], {}, *given[2:])
    assert not any(t.met for t in bad.targets)
    assert len(bad.misses) == 2


def answered(truth: dict) -> dict:
    """The right answer to a case."""
    missing = [
        {
            "effect": e["effect"],
            "at": e["at"],
            "alternatives": [],
            "parameters": {n: p | {"ci95": [p["value"] - 1e-9, p["value"] + 1e-9]} for n, p in e["parameters"].items()},
        }
        for e in truth["effects"]
        if e["large"]
    ]
    diagnosis = {"verdict": "named" if missing else "none", "missing": missing, "unknown": None, "where": {}}
    return {"case": truth["case"], "status": 0, "seconds": 1.0, "error": "", "diagnosis": diagnosis}


def test_names_count_by_place_and_alternatives():
    truth = {"joints": 6, "effects": [{"effect": "friction_stribeck", "at": [2]}]}
    true = truth["effects"][0]
    assert in_class({"effect": "friction_stribeck", "at": [2]}, true, truth)
    assert not in_class({"effect": "friction_stribeck", "at": [3]}, true, truth)
    for alternative in (["friction_stribeck", [2]], [["armature", [1]], ["friction_stribeck", [2]]]):
        assert in_class({"effect": "spring", "at": [1], "alternatives": [alternative]}, true, truth)
    assert is_alike({"effect": "friction_reversal", "at": [2]}, truth)
    assert not is_alike({"effect": "friction_reversal", "at": [1]}, truth)
    tip = {"joints": 6, "effects": [{"effect": "payload", "at": []}]}
    assert in_class({"effect": "link_inertial", "at": [6]}, tip["effects"][0], tip)
    assert not in_class({"effect": "link_inertial", "at": [5]}, tip["effects"][0], tip)
    assert is_alike({"effect": "link_inertial", "at": [5]}, tip)


def test_a_large_cause_is_large_and_a_case_repeats(null):
    again = make_case("00000", (7, 0, 0), "development", "null", "scara")
    np.testing.assert_array_equal(null.logs[0].torque, again.logs[0].torque)
    case = make_case("00001", (7, 0, 1), "development", "one", "scara")
    large = [cause for cause in case.causes if cause.large]
    assert len(large) == 1
    assert large[0].share >= LARGE
    assert truth_of(replace(case, name="00001"))["effects"][0]["large"]
