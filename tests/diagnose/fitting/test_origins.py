"""Fixed transforms that nobody knows: arms put together here by plain matrices, with a drive that gives unseen."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import linkwright as lw
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.diagnose.fitting.origins import located
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.several.recordings import together

Array = NDArray[np.float64]
NOISE, SOFT = 20e-6, 30e-6
FLAT = np.array([1.1, 0.48])
"""1.2 m from the end of link 1."""
SPACE, TURN = np.array([0.9, -0.4, 0.69]), Rotation.from_rotvec(math.radians(70.0) * np.array([1.0, 2.0, 2.0]) / 3.0)


def _turned(angle: float) -> Array:
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def planar_tip(q: Array, mass: float) -> Array:
    """500 mm, then 1.2 m and 70 deg that nobody knows, then 600 and 400 mm; drive 2 gives 30 urad/(N m)."""
    given = 0.0
    for _ in range(6):
        second = q[0] + math.radians(70.0) + q[1] + given
        elbow = _turned(q[0]) @ (np.array([0.5, 0.0]) + FLAT)
        tip = elbow + _turned(second) @ (np.array([0.6, 0.0]) + _turned(q[2]) @ np.array([0.4, 0.0]))
        given = SOFT * (tip - elbow)[0] * -9.81 * mass
    return tip


AXES = np.array([[0, 0, 1], [0, 1, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0]], dtype=float)
STEPS = np.array([[0.1, 0, 0.4], [0, 0, 0.45], [0.3, 0, 0], [0.2, 0, 0], [0.2, 0, 0], [0.1, 0, 0.05]])


def spatial_tip(q: Array, mass: float) -> Array:
    """Six joints, 1.2 m and 70 deg that nobody knows in front of the fourth; drive 2 gives."""
    given = 0.0
    for _ in range(7):
        at, frame = np.zeros(3), np.eye(3)
        for k in range(6):
            if k == 3:
                at, frame = at + frame @ SPACE, frame @ TURN.as_matrix()
            if k == 1:
                shoulder, axis = at, frame @ AXES[k]
            turn = q[k] + (given if k == 1 else 0.0)
            frame = frame @ Rotation.from_rotvec(turn * AXES[k]).as_matrix()
            at = at + frame @ STEPS[k]
        given = SOFT * float(axis @ np.cross(at - shoulder, [0.0, 0.0, -9.81 * mass]))
    return at


def planar_file(origin: str = "free") -> str:
    links = [f"link: {{length: {length} mm, rigid: true, mass: 0 kg}}" for length in (500, 600, 400)]
    joint = "  - joint: {range: [-180 deg, 180 deg]}"
    lines = ["chain:", joint, f"    {links[0]}", joint, f"    origin: {origin}", f"    {links[1]}", joint]
    return "\n".join([*lines, f"    {links[2]}"]) + "\n"


def spatial_file() -> str:
    lines = ["gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]", "chain:"]
    for k, (axis, step) in enumerate(zip(AXES.tolist(), STEPS, strict=True)):
        size = float(np.linalg.norm(step))
        along = f"direction: {(step / size).tolist()}, length: {1e3 * size:.12g} mm"
        lines.append(f"  - joint: {{axis: {axis}, range: [-180 deg, 180 deg]}}")
        lines += ["    origin: free"] if k == 3 else []
        lines.append(f"    link: {{{along}, rigid: true, mass: 0 kg}}")
    return "\n".join(lines) + "\n"


def recorded(file: Path, q: Array, mass: Array, tip: Array) -> Path:
    names = [f"q{k}_deg" for k in range(1, q.shape[1] + 1)]
    names += ["payload_kg", *(f"{axis}_mm" for axis in "xyz"[: tip.shape[1]])]
    rows = np.column_stack([np.degrees(q), mass, 1e3 * tip])
    file.write_text("\n".join([",".join(names), *(",".join(f"{v:.9g}" for v in row) for row in rows.tolist())]) + "\n")
    return file


def planar_recording(folder: Path, poses: int = 40, seed: int = 3) -> Path:
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-1.8, 1.8, (poses, 3)), 2, axis=0)
    mass = np.repeat(np.where(np.arange(poses) % 2, 5.0, 0.0), 2)
    tip = np.array([planar_tip(*item) for item in zip(q, mass.tolist(), strict=True)])
    return recorded(folder / f"r{seed}.csv", q, mass, tip + rng.normal(0.0, NOISE, tip.shape))


def test_a_planar_arms_unknown_transform_is_found_with_what_is_left_out(tmp_path: Path) -> None:
    arm = tmp_path / "arm.yaml"
    arm.write_text(planar_file())
    result = lw.diagnose(arm, planar_recording(tmp_path)).found
    (origin,) = result.origins
    truth = {"x": FLAT[0], "y": FLAT[1], "yaw": math.radians(70.0)}
    assert {parameter.parameter for parameter in origin.parameters} == set(truth)
    for item in origin.parameters:
        low, high = item.interval
        assert abs(item.value - truth[item.parameter]) <= high - low, "twice the 95 % interval"
        assert 0.0 < high - low < 100e-6
    (soft,) = result.findings
    assert (soft.effect, soft.at) == ("joint_compliance", (2,))
    assert soft.parameters[0].value == pytest.approx(SOFT, rel=0.02)
    # The transform's own shift and turn: a zero of either encoder, and the length of the link before it.
    assert set(origin.swallowed) == {("encoder_offset", (1,)), ("encoder_offset", (2,)), ("link_length", (1,))}
    assert not result.corrected.unknown_origins
    assert result.written is not None
    assert result.written.rms == pytest.approx(result.rms_promised, rel=1e-3)


@pytest.mark.slow
def test_a_transform_in_space_is_found(tmp_path: Path) -> None:
    arm, rng, poses = tmp_path / "arm.yaml", np.random.default_rng(4), 36
    arm.write_text(spatial_file())
    q = np.repeat(rng.uniform(-2.0, 2.0, (poses, 6)), 2, axis=0)
    mass = np.repeat(np.where(np.arange(poses) % 2, 6.0, 0.0), 2)
    tip = np.array([spatial_tip(*item) for item in zip(q, mass.tolist(), strict=True)])
    file = recorded(tmp_path / "r.csv", q, mass, tip + rng.normal(0.0, NOISE, tip.shape))
    dia = lw.diagnose(arm, file)
    (origin,) = dia.found.origins
    truth = dict(zip(("x", "y", "z", "roll", "pitch", "yaw"), (*SPACE, *TURN.as_euler("xyz")), strict=True))
    for parameter in origin.parameters:
        low, high = parameter.interval
        assert abs(parameter.value - truth[parameter.parameter]) <= high - low
        assert 0.0 < high - low < 100e-6
    assert [(finding.effect, finding.at) for finding in dia.found.findings] == [("joint_compliance", (2,))]
    assert {("encoder_offset", (4,)), ("link_length", (3,))} <= set(origin.swallowed)
    held = json.loads(dia.to_json())["origins"][0]
    assert held["joint"] == 4
    assert held["xyz_mm"] == pytest.approx((1e3 * SPACE).tolist(), abs=0.1)


def test_beside_a_free_frame_it_is_sought_from_many_turns(tmp_path: Path) -> None:
    """No closed form there: the frame is free by two metres and a right turn too."""
    arm = tmp_path / "arm.yaml"
    arm.write_text(planar_file())
    rng = np.random.default_rng(5)
    q = rng.uniform(-1.8, 1.8, (40, 3))
    tip = np.array([planar_tip(item, 0.0) for item in q]) @ _turned(1.5).T + np.array([2.0, -1.0])
    file = recorded(tmp_path / "r.csv", q, np.zeros(40), tip)
    (tmp_path / "r.yaml").write_text("frame: free\n")
    model = read_arm(arm)
    joint = located(model, read_recording(file, model)).joints[1]
    # About a first joint whose zero the frame takes up, the transform is told but for that turn: what is rigid is its
    # distance from the end of link 1 along it, and where the elbow is seen from the shoulder.
    elbow = np.array([0.5, 0.0]) + np.array(joint.origin_translation[:2])
    assert float(np.linalg.norm(elbow)) == pytest.approx(float(np.linalg.norm(FLAT + np.array([0.5, 0.0]))), abs=1e-6)


def test_what_cannot_be_told_of_it_is_not_bounded(tmp_path: Path) -> None:
    """A frame that may be turned about the base takes up the transform's turn with its place: no interval is tight."""
    arm = tmp_path / "arm.yaml"
    arm.write_text(planar_file())
    rng = np.random.default_rng(5)
    q = np.repeat(rng.uniform(-1.8, 1.8, (16, 3)), 2, axis=0)
    tip = np.array([planar_tip(item, 0.0) for item in q]) + rng.normal(0.0, NOISE, (32, 2))
    file = recorded(tmp_path / "r.csv", q, np.zeros(32), tip)
    (tmp_path / "r.yaml").write_text("frame: free\n")
    result = lw.diagnose(arm, file).found
    assert result.verdict == "none"
    assert all(math.isinf(end) for parameter in result.origins[0].parameters for end in parameter.interval)
    assert "which the data do not bound" in result.sentence
    assert "`frame: known`" in result.sentence


def test_several_recordings_share_it(tmp_path: Path) -> None:
    arm = tmp_path / "arm.yaml"
    arm.write_text(planar_file("{xyz: [free, 480 mm, 0 mm], rpy: [0 deg, 0 deg, free]}"))
    model = read_arm(arm)
    parts = [read_recording(planar_recording(tmp_path, 15, seed), model) for seed in (6, 7)]
    joint = located(model, together(parts, model)).joints[1]
    assert joint.origin_translation[0] == pytest.approx(FLAT[0], abs=2e-3)
    assert joint.origin_translation[1] == 0.48
    assert math.atan2(joint.origin_rotation[1][0], joint.origin_rotation[0][0]) == pytest.approx(
        math.radians(70.0), abs=2e-3
    )


@pytest.mark.parametrize("origin", ["free", "{xyz: free, rpy: [0 deg, 0 deg, 30 deg]}", "{xyz: [1 m, 0 m], rpy: free}"])
def test_what_is_free_is_read_and_written_back(tmp_path: Path, origin: str) -> None:
    file = tmp_path / "arm.yaml"
    file.write_text(planar_file(origin))
    arm = read_arm(file)
    file.write_text(arm_to_yaml(arm))
    assert read_arm(file) == arm
    assert arm.unknown_origins == (1,)


def test_whoever_must_know_it_says_what_to_do(tmp_path: Path) -> None:
    file = tmp_path / "arm.yaml"
    file.write_text(planar_file())
    recording = planar_recording(tmp_path, 4)
    for asked in (
        lambda: lw.evaluate(file),
        lambda: lw.compensate(file),
        lambda: lw.predict(file, recording),
        lambda: lw.evaluate(lw.read_arm(file)),
        lambda: lw.simulate(file),
        lambda: lw.simulate(lw.read_arm(file)),
        lambda: lw.Problem(lw.read_arm(file)),
    ):
        with pytest.raises(lw.InputError, match=r"chain\[2\].origin.*linkwright diagnose"):
            asked()
    (tmp_path / "problem.yaml").write_text("arm: arm.yaml\n")
    with pytest.raises(lw.InputError, match="linkwright diagnose"):
        lw.read_problem(tmp_path / "problem.yaml")
    file.write_text(planar_file().replace("link: {length: 500 mm, rigid", "link: {rigid"))
    with pytest.raises(lw.InputError, match=r"chain\[1\].link.length: is missing; the next joint's origin is free"):
        read_arm(file)
