"""Cameras that see a target, one of both on an arm of six joints by plain matrices, the other anywhere."""

from dataclasses import replace

import numpy as np
import pytest

from linkwright.core.arm.effects import Settings
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.answer.cameras import of_camera
from linkwright.core.diagnose.fitting.prepare import nuisances, prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.reading.write import recording_text, settings_text
from linkwright.core.diagnose.residual.noise import noise_floor
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.several.recordings import together
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.units.quantities import InputError
from tests.costs import slow_but
from tests.diagnose.instruments.six_joint_arm import Hand, seen_by_camera, session, six_joint_arm, transform

NOISE = (30e-6, 150e-6, 100e-6)
"""Across (m), in depth (m), of turns (rad)."""
BOTH = pytest.mark.parametrize("on_tool", [False, True])


@BOTH
@pytest.mark.parametrize("seed", slow_but([1, 2, 3, 4], 1))
def test_both_frames_are_found_however_they_are_turned(on_tool, seed):
    """Without noise, whatever the rotations, with depths that are 1 % too long: exactly."""
    hand = Hand(fixed=transform(seed), carried=transform(seed + 10, reach=0.1))
    q, payload = session(8, seed)
    seen = observe(six_joint_arm(), seen_by_camera(q, payload, hand, on_tool=on_tool, noise=(0, 0, 0), focal=0.01))

    assert np.abs(seen.residual).max() < 1e-10
    assert seen.sight.depth == pytest.approx(0.01, abs=1e-9)
    assert seen.alignment.rotation == pytest.approx(hand.fixed[:3, :3], abs=1e-9)
    assert seen.alignment.translation == pytest.approx(hand.fixed[:3, 3], abs=1e-9)
    assert seen.alignment.tool == pytest.approx(hand.carried[:3, 3], abs=1e-9)


@BOTH
def test_loads_act_at_the_tip_and_not_where_the_target_or_the_camera_sits(on_tool):
    """Soft drives in the file, a target 0.1 m beside the tip: what they give under the payload is the tip's."""
    soft = {1: 1e-5, 2: 3e-5, 3: 5e-5}
    q, payload = session(12, 7)
    arm = six_joint_arm()
    joints = [replace(joint, stiffness=1.0 / soft[k] if k in soft else None) for k, joint in enumerate(arm.joints, 1)]
    hand = Hand(compliance=soft, carried=transform(2, reach=0.1))
    seen = observe(
        replace(arm, joints=tuple(joints)), seen_by_camera(q, payload, hand, on_tool=on_tool, noise=(0, 0, 0))
    )

    rigid = observe(arm, seen.recording)
    assert np.abs(rigid.residual).max() > 1e-4
    assert np.abs(seen.residual).max() < 1e-7


def _error_of(on_tool, joint, orientation):
    """The standard error (rad) of a joint's zero beside both frames and the depths, by the declared noise."""
    q, payload = session(30, 4)
    recording = seen_by_camera(q, payload, Hand(), on_tool=on_tool, noise=(0, 0, 0))
    if not orientation:
        recording = replace(recording, orientation=None, seat="unused")
    seen = observe(six_joint_arm(), recording)
    beside, _ = nuisances(seen)
    scale = np.array([NOISE[0], NOISE[0], NOISE[1], *(NOISE[2],) * 3])[: seen.residual.shape[1]]
    moved = (seen.drive_moved(joint - 1) / scale).reshape(-1)
    other = (beside / scale[:, None]).reshape(len(moved), -1)
    other = other / np.maximum(np.linalg.norm(other, axis=0), 1e-300)
    left = moved - other @ np.linalg.lstsq(other, moved, rcond=1e-10)[0]
    return 1.0 / np.linalg.norm(left)


@BOTH
def test_turns_tell_more_and_nothing_tells_the_first_and_last_zero(on_tool):
    # A camera on the tool sees the target move when the tool turns, whether or not it reads how the target is turned.
    assert _error_of(on_tool, 4, True) < (0.97 if on_tool else 0.75) * _error_of(on_tool, 4, False)
    assert _error_of(on_tool, 3, True) < 20e-6
    # Which way the arm stands, and the last link: that is where the camera and the target are.
    assert min(_error_of(on_tool, joint, True) for joint in (1, 6)) > 1.0


@BOTH
def test_what_moves_a_joint_moves_the_reading_to_first_order(on_tool):
    q, payload = session(8, 6)
    given = seen_by_camera(q, payload, Hand(), on_tool=on_tool, noise=(0, 0, 0))
    _, names = nuisances(seen := observe(six_joint_arm(), given))
    assert names[-1] == "depths of the camera"
    assert sum("seat" in name for name in names) == 3
    for joint in range(1, 7):
        real = seen_by_camera(q, payload, Hand(zeros={joint: 1e-5}), on_tool=on_tool, noise=(0, 0, 0))
        moved = real.tip - given.tip
        assert seen.drive_moved(joint - 1)[:, :3] * 1e-5 == pytest.approx(moved, abs=1e-9)


@pytest.mark.slow
def test_a_camera_on_the_tool_names_a_zero_and_a_soft_drive():
    hand = Hand(zeros={3: 8e-4}, compliance={2: 2e-5})
    q, payload = session(30, 3)
    result = diagnose(six_joint_arm(), seen_by_camera(q, payload, hand, on_tool=True, noise=NOISE))

    results = {finding.effect: finding for finding in result.findings}
    assert {(name, item.at) for name, item in results.items()} == {("encoder_offset", (3,)), ("joint_compliance", (2,))}
    low, high = results["encoder_offset"].parameters[0].interval
    assert low < 8e-4 < high
    assert high - low < 2.5e-4  # with room for causes too small to be named beside two findings
    low, high = results["joint_compliance"].parameters[0].interval
    assert low < 2e-5 < high
    assert {("encoder_offset", (1,)), ("encoder_offset", (6,))} <= set(result.invisible)
    assert "It does not show 6 of the 6 ways" in " ".join(result.notes)
    assert "both the camera and the target are" in result.notes[0]


def test_depth_is_noisier_and_weighs_less():
    q, payload = session(150, 9)
    recording = seen_by_camera(q, payload, Hand(), on_tool=True, noise=NOISE)
    sigma = noise_floor(recording, six_joint_arm()).sigma
    assert sigma == pytest.approx((NOISE[0], NOISE[0], NOISE[1]), rel=0.2)
    declared = replace(recording.kept(np.arange(300) % 2 == 0), sigma=1e-4, sigma_axes=(2e-5, 3e-5, 4e-4))
    assert noise_floor(declared, six_joint_arm()).sigma == pytest.approx((2e-5, 3e-5, 4e-4))


def test_a_focal_length_that_is_off_is_said_and_blamed_on_no_joint():
    q, payload = session(30, 3)
    recording = seen_by_camera(q, payload, Hand(), on_tool=False, noise=NOISE, focal=-0.004, sigma_angle=3e-4)
    arm = six_joint_arm()
    prepared = prepare(observe(arm, recording), Options())
    said = of_camera(prepared, [], noise_floor(recording, arm))
    (depths,) = [item for item in said if "too short" in item]
    low, high = (float(part) for part in depths.split("(")[1].split(" %")[0].split(" to "))
    assert low < 0.4 < high
    assert high - low < 0.05
    assert any("sigma_angle): chance does not explain" in item for item in said)
    # Turns count for no better than declared.
    assert prepared.observed.scale[prepared.observed.turn_columns] == pytest.approx(3e-4)
    assert np.linalg.norm(prepared.vector) < 1.3 * np.sqrt(len(prepared.vector))


def test_a_target_not_printed_to_scale_is_the_instruments_scale():
    q, payload = session(20, 3)
    arm = six_joint_arm()
    for on_tool in (False, True):
        recording = seen_by_camera(q, payload, Hand(), on_tool=on_tool, noise=(0, 0, 0), print_scale=1e-3)
        prepared = observe(arm, recording)
        column = prepared.signature("instrument_scale", Settings((), {"scale": 1e-3}))
        beside, _ = nuisances(prepared)
        design = beside.reshape(column.size, -1)
        size = np.maximum(np.linalg.norm(design, axis=0), 1e-300)
        left = prepared.residual.reshape(-1) - column.reshape(-1)
        left -= design / size @ np.linalg.lstsq(design / size, left, rcond=1e-10)[0]
        assert np.abs(left).max() < 2e-6
        assert np.abs(column).max() > 1e-3


ARM = """
name: six joints
gravity: [0 m/s^2, 0 m/s^2, -9.80665 m/s^2]
chain:
""" + "".join(
    f"  - joint: {{range: [-86 deg, 86 deg], axis: {list(axis)}}}\n"
    f"    link: {{length: {length} m, rigid: true, mass: 0 kg}}\n"
    for axis, length in zip(
        ((0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0)),
        (0.15, 0.45, 0.1, 0.35, 0.08, 0.1),
        strict=True,
    )
)


@pytest.fixture
def files(tmp_path):
    """The arm, a recording of a camera on its tool, and its settings."""
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    arm = read_arm(tmp_path / "arm.yaml")
    q, payload = session(10, 8)
    made = seen_by_camera(q, payload, Hand(), on_tool=True, noise=NOISE, sigma=1e-4)
    made = replace(made, sigma_axes=(3e-5, 3e-5, 1.5e-4), sigma_angle=1e-4)
    (tmp_path / "seen.csv").write_text(recording_text(made, arm), encoding="utf-8")
    (tmp_path / "seen.yaml").write_text(settings_text(made), encoding="utf-8")
    return tmp_path, arm, made


def test_a_recording_of_a_camera_is_written_and_read_again(files):
    folder, arm, made = files
    read = read_recording(folder / "seen.csv", arm)
    assert read.instrument == made.instrument
    assert (read.frame, read.tool, read.seat) == ("free", "free", "free")
    assert read.tip == pytest.approx(made.tip, abs=1e-8)
    assert read.orientation == pytest.approx(made.orientation, abs=1e-8)
    assert read.sigma_axes == pytest.approx(made.sigma_axes)
    assert read.sigma_angle == pytest.approx(1e-4, rel=1e-6)
    assert not read.warnings


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("on_tool", "fixed", "on_tool leaves"),
        ("camera: on_tool", "camera: ceiling", "no place of a camera"),
        ("camera: on_tool\n", "", "is missing"),
        ("observes: camera", "observes: [camera, distance]\nanchor: free", "a recording of its own"),
        ("observes: camera\ncamera: on_tool", "observes: position", "goes with `observes: camera`"),
    ],
)
def test_settings_that_cannot_be_meant_are_refused_in_a_line(files, before, after, said):
    folder, arm, _ = files
    settings = folder / "seen.yaml"
    text = settings.read_text(encoding="utf-8")
    assert before in text
    settings.write_text(text.replace(before, after), encoding="utf-8")
    with pytest.raises(InputError, match=said):
        read_recording(folder / "seen.csv", arm)


def test_a_camera_goes_with_cameras(files):
    folder, arm, made = files
    read = read_recording(folder / "seen.csv", arm)
    both = together([made, read], arm, names=["one", "other"])
    seen = observe(arm, both)
    assert seen.residual.shape == (40, 6)
    assert np.abs(seen.residual).max() < 2e-3
    tracker = replace(read, slots=None, orientation=None)
    with pytest.raises(InputError, match="diagnose them apart"):
        together([read, tracker], arm)


def test_without_orientations_it_is_said(files):
    folder, arm, _ = files
    lines = (folder / "seen.csv").read_text(encoding="utf-8").splitlines()
    short = "\n".join(",".join(line.split(",")[:-4]) for line in lines) + "\n"
    (folder / "seen.csv").write_text(short, encoding="utf-8")
    read = read_recording(folder / "seen.csv", arm)
    assert read.seat == "unused"
    assert any("There are no orientations" in warning for warning in read.warnings)
    assert np.abs(observe(arm, read).residual).max() < 1e-3
