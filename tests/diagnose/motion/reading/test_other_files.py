"""Motion logs as other programs write them: bags, MCAP, LeRobot, exports of controllers; by the libraries' writers."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from mcap.writer import CompressionType

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.motion.log import CURRENT, MotionLog
from linkwright.core.diagnose.motion.reading.read import is_motion_log, logs_from, read_log
from linkwright.core.diagnose.reading.files import table_of
from linkwright.core.diagnose.reading.settings import ReadingSettings
from linkwright.core.units.quantities import InputError
from tests.diagnose.reading.bags_written import write_bag, write_json_mcap, write_mcap

NAMES = ("shoulder_joint", "elbow_joint")
START = 1.7e9


def arm(names: tuple[str, ...] = NAMES) -> Arm:
    joints = tuple(Joint(name=name, range=(-2.0, 2.0)) for name in names)
    return Arm("planar", joints, tuple(Link(0.4, mass=0.0) for _ in names))


def motion(count: int = 300, rate: float = 100.0) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    time = np.arange(count) / rate
    q = np.stack([np.sin(1.3 * time), 0.7 * np.cos(2.1 * time)], axis=1)
    speed = np.stack([1.3 * np.cos(1.3 * time), -1.47 * np.sin(2.1 * time)], axis=1)
    return time, q, speed, 9.0 * np.cos(q) + np.sign(speed)


def states(order: tuple[int, ...] = (0, 1), names: tuple[str, ...] = NAMES) -> list:
    """Joint states with speeds, the joints in this order."""
    time, q, speed, torque = motion()
    order = list(order)
    rows = zip(time + START, q[:, order], speed[:, order], torque[:, order], strict=True)
    return [(t, [names[k] for k in order], p, v, e) for t, p, v, e in rows]


def without_speeds(messages: list) -> list:
    return [(t, names, p, e) for t, names, p, _, e in messages]


def is_the_motion(log: MotionLog, abs: float = 1e-6) -> None:
    time, q, speed, torque = motion()
    assert log.time == pytest.approx(time, abs=1e-6)
    assert log.q == pytest.approx(q, abs=abs)
    assert log.torque == pytest.approx(torque, abs=abs)
    if log.velocity is not None:
        assert log.velocity == pytest.approx(speed, abs=abs)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
@pytest.mark.parametrize("compression", [CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD])
def test_an_mcap_of_ros_2(tmp_path, order, compression):
    """Joints go by their names, whatever their order in the message."""
    path = write_mcap(tmp_path / "log.mcap", states(order), compression=compression)
    assert is_motion_log(path, arm())
    log = read_log(path, arm())
    is_the_motion(log)
    assert log.velocity is not None
    assert any("rad, as ROS has it" in warning for warning in log.warnings)


def test_an_mcap_without_ros(tmp_path):
    is_the_motion(read_log(write_json_mcap(tmp_path / "log.mcap", without_speeds(states())), arm()))


@pytest.mark.parametrize("ros", [1, 2])
def test_bags(tmp_path, ros):
    name = "log.bag" if ros == 1 else "log"
    is_the_motion(
        read_log(write_bag(tmp_path / name, {"/joint_states": without_speeds(states((1, 0)))}, ros=ros), arm())
    )


def test_a_topic_of_another_rate_is_joined_by_time(tmp_path):
    """Between its own messages in proportion; where it is silent there is nothing."""
    time, *_ = motion()
    payload = [(START + t, 1e-6 * t) for t in np.arange(0.0, 2.0, 0.05)]
    log = read_log(write_mcap(tmp_path / "log.mcap", states(), payload=payload), arm())
    assert log.payload_mass is not None
    assert log.payload_mass[:195] == pytest.approx(1e-6 * time[:195], abs=1e-12)
    assert any(
        "/payload is read at the instants of /joint_states (20 Hz and 100 Hz)" in warning for warning in log.warnings
    )


def test_a_bag_that_breaks_off_is_read_as_far_as_it_goes(tmp_path):
    path = write_mcap(tmp_path / "log.mcap", states(), compression=CompressionType.NONE)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    log = read_log(path, arm())
    assert 100 < log.size < 200
    assert any("breaks off" in warning for warning in log.warnings)


def test_joints_of_other_names_go_by_their_place_and_it_is_said(tmp_path):
    log = read_log(write_mcap(tmp_path / "log.mcap", states(names=("axis_a", "axis_b"))), arm())
    is_the_motion(log)
    assert any("the arm has no joint axis_a" in warning for warning in log.warnings)


def test_a_prefix_before_the_joints_names_is_none_of_theirs(tmp_path):
    log = read_log(
        write_mcap(tmp_path / "log.mcap", states((1, 0), names=("r1_shoulder_joint", "r1_elbow_joint"))), arm()
    )
    is_the_motion(log)


def test_an_arm_with_other_joints_than_the_log(tmp_path):
    """Some of its joints are in the log, one is not; or there are too many to go by their place."""
    path = write_mcap(tmp_path / "log.mcap", states())
    with pytest.raises(InputError, match="q3: is missing: 'planar' has 3 joints, and the log has 2"):
        read_log(path, arm((*NAMES, "wrist_joint")))
    with pytest.raises(InputError, match="q1, q2, q3: are missing: 'planar' has 3 joints, and the log has 0"):
        read_log(path, arm(("a", "b", "c")))


def test_two_robots_in_one_bag(tmp_path):
    both = {"/left/joint_states": without_speeds(states()), "/right/joint_states": without_speeds(states())}
    path = write_bag(tmp_path / "log", both)
    assert is_motion_log(path, arm())  # so that what reads it says what is wrong
    with pytest.raises(InputError, match="are these two robots in one file"):
        read_log(path, arm())
    (tmp_path / "recording.yaml").write_text("observes: motion\ntopics: /right/joint_states\n", encoding="utf-8")
    is_the_motion(read_log(path, arm()))
    (tmp_path / "recording.yaml").write_text("observes: motion\ntopics: /middle\n", encoding="utf-8")
    with pytest.raises(InputError, match="there is no /middle; the bag has /left/joint_states, /right/joint_states"):
        read_log(path, arm())


@pytest.mark.parametrize("content", [b"", b"\x89MCAP0\r\n", b"#ROSBAG V2.0\n", b"SQLite format 3\0", b"\x00" * 300])
@pytest.mark.parametrize("name", ["log.mcap", "log.bag", "log.db3"])
def test_what_is_no_bag_is_one_line(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        read_log(tmp_path / name, arm())
    assert "\n" not in str(caught.value)


def test_what_a_missing_library_would_need(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "mcap.reader", None)
    monkeypatch.setitem(__import__("sys").modules, "rosbags.highlevel", None)
    for path in (
        write_mcap(tmp_path / "log.mcap", states()),
        write_bag(tmp_path / "log", {"/joint_states": without_speeds(states())}),
    ):
        with pytest.raises(InputError, match=r"pip install '?mcap.* '?rosbags"):
            read_log(path, arm())


def lerobot(folder: Path, *, episodes: int = 1, named: bool = True) -> Path:
    """A data set as LeRobot lays it out (version 2.1), the torques in `observation.effort`."""
    time, q, _, torque = motion()
    frames = [
        pd.DataFrame(
            {
                "observation.state": list(np.degrees(q)),
                "observation.effort": list(torque),
                "action": list(np.degrees(q) + 0.1),
                "timestamp": time,
                "frame_index": np.arange(len(time)),
                "episode_index": np.full(len(time), number),
            }
        )
        for number in range(episodes)
    ]
    data = folder / "data" / "chunk-000"
    data.mkdir(parents=True)
    (folder / "meta").mkdir()
    names = {"motors": list(NAMES)} if episodes == 1 else [f"{name}.pos" for name in NAMES]
    features = {name: {"names": names} for name in ("observation.state", "observation.effort", "action")}
    if named:
        (folder / "meta" / "info.json").write_text(json.dumps({"features": features}), encoding="utf-8")
    pd.concat(frames).to_parquet(data / "episode_000000.parquet")
    return data / "episode_000000.parquet"


@pytest.mark.parametrize("named", [True, False])
def test_lerobot(tmp_path, named):
    log = read_log(lerobot(tmp_path, named=named), arm())
    is_the_motion(log)
    assert log.commanded is not None
    assert log.commanded == pytest.approx(motion()[1] + np.radians(0.1), abs=1e-6)


def test_episodes_stand_one_after_another(tmp_path):
    log = read_log(lerobot(tmp_path, episodes=2), arm())
    assert log.size == 600
    assert np.diff(log.time).max() == pytest.approx(10.0)
    assert any("2 episodes" in warning for warning in log.warnings)


def from_text(folder: Path, columns: dict[str, np.ndarray], settings: str = "") -> MotionLog:
    path = folder / "export.csv"
    pd.DataFrame(columns).to_csv(path, index=False)
    if settings:
        (folder / "recording.yaml").write_text(settings, encoding="utf-8")
    assert is_motion_log(path, arm())
    return read_log(path, arm())


def numbered(pattern: str, values: np.ndarray, first: int = 0) -> dict[str, np.ndarray]:
    return {pattern.format(k + first): values[:, k] for k in range(values.shape[1])}


TIME, Q, SPEED, TORQUE = motion()
EXPORTS = {
    # UR's RTDE client (github.com/UniversalRobots/RTDE_Python_Client_Library, record.py).
    "ur": {"timestamp": TIME + 1234.5, **numbered("target_q_{}", Q), **numbered("actual_q_{}", Q),
           **numbered("actual_qd_{}", SPEED), **numbered("actual_current_{}", TORQUE),
           **numbered("target_moment_{}", Q), **numbered("actual_TCP_pose_{}", Q)},
    # libfranka's RobotState by field (frankaemika.github.io/libfranka).
    "franka": {"time": TIME * 1e3, **numbered("q[{}]", Q), **numbered("q_d[{}]", Q), **numbered("dq[{}]", SPEED),
               **numbered("tau_J[{}]", TORQUE), **numbered("tau_J_d[{}]", Q), **numbered("theta[{}]", Q + 0.01),
               **numbered("tau_ext_hat_filtered[{}]", Q)},
    # rostopic echo -p (wiki.ros.org/rostopic).
    "rostopic": {"%time": (START + TIME) * 1e9, "field.header.seq": TIME, "field.header.stamp": (START + TIME) * 1e9,
                 "field.name0": [NAMES[1]] * 300, "field.name1": [NAMES[0]] * 300,
                 **numbered("field.position{}", Q[:, ::-1]), **numbered("field.velocity{}", SPEED[:, ::-1]),
                 **numbered("field.effort{}", TORQUE[:, ::-1])},
    # bagpy and rosbag_pandas: stamps in two columns.
    "stamps": {"/joint_states.header.stamp.secs": np.floor(START + TIME),
               "/joint_states.header.stamp.nsecs": np.round((START + TIME) % 1.0 * 1e9),
               **numbered("/joint_states.position[{}]", Q), **numbered("/joint_states.effort[{}]", TORQUE)},
    # PlotJuggler's export of a bag (github.com/facontidavide/PlotJuggler).
    "plotjuggler": {"__time": START + TIME, **{f"/joint_states/{n}/position": Q[:, k] for k, n in enumerate(NAMES)},
                    **{f"/joint_states/{n}/effort": TORQUE[:, k] for k, n in enumerate(NAMES)}},
    # KUKA's Robot Sensor Interface: AIPos in degrees, MACur in A.
    "kuka": {"time": TIME, **numbered("AIPos.A{}", np.degrees(Q), 1), **numbered("ASPos.A{}", np.degrees(Q), 1),
             **numbered("MACur.A{}", TORQUE, 1)},
    # ur_msgs/RobotStateRTMsg (docs.ros.org/en/hydro/api/ur_msgs), by rostopic echo -p.
    "ur_msgs": {"%time": (START + TIME) * 1e9, **numbered("field.q_target{}", Q), **numbered("field.q_actual{}", Q),
                **numbered("field.qd_actual{}", SPEED), **numbered("field.i_target{}", Q),
                **numbered("field.i_actual{}", TORQUE), **numbered("field.m_target{}", Q)},
    # MuJoCo's mjData (github.com/google-deepmind/mujoco, include/mujoco/mjdata.h).
    "mujoco": {"time": TIME, **numbered("qpos_{}", Q), **numbered("qvel_{}", SPEED),
               **numbered("qfrc_bias_{}", Q), **numbered("qfrc_actuator_{}", TORQUE), **numbered("ctrl_{}", Q)},
    "german": {"Zeit [s]": TIME, **numbered("Achse {} Winkel [deg]", np.degrees(Q), 1),
               **numbered("Achse {} Moment [Nm]", TORQUE, 1)},
    "plain": {"Time [ms]": TIME * 1e3, **numbered("Joint {} position (deg)", np.degrees(Q), 1),
              **numbered("Joint {} torque [Nm]", TORQUE, 1)},
}  # fmt: skip


@pytest.mark.parametrize("name", EXPORTS)
def test_exports(tmp_path, name):
    log = from_text(tmp_path, EXPORTS[name])
    is_the_motion(log)
    assert (log.drive is CURRENT) == (name in ("ur", "ur_msgs", "kuka"))
    assert any("taken for ours" in warning for warning in log.warnings)


def test_an_export_of_several_topics_has_rows_of_each(tmp_path):
    """PlotJuggler leaves the cells of the others blank."""
    table = pd.DataFrame(EXPORTS["plotjuggler"])
    other = pd.DataFrame({"__time": START + TIME + 0.003, "/imu/x": TIME})
    log = from_text(tmp_path, dict(pd.concat([table, other]).sort_values("__time")))
    is_the_motion(log)
    assert any("300 rows hold nothing of the joints" in warning for warning in log.warnings)


def test_settings_for_some_columns_leave_the_others_known(tmp_path):
    """The sign of one joint is written, the rest is taken as before."""
    turned = EXPORTS["plotjuggler"] | {"/joint_states/elbow_joint/position": -Q[:, 1]}
    settings = 'observes: motion\ncolumns: {q2_rad: "-`/joint_states/elbow_joint/position`"}\n'
    is_the_motion(from_text(tmp_path, turned, settings))


def test_settings_may_call_foreign_columns_by_our_names(tmp_path):
    """As refusals do, whose remedies people copy."""
    turned = EXPORTS["plotjuggler"] | {"/joint_states/elbow_joint/position": -Q[:, 1]}
    is_the_motion(from_text(tmp_path, turned, "observes: motion\ncolumns: {q2_rad: -q2_rad}\n"))


def test_a_controllers_own_place_of_the_tip_is_no_measurement(tmp_path):
    """It follows from the joint angles: such a log is one of motion."""
    is_the_motion(from_text(tmp_path, EXPORTS["ur"]))
    poses = numbered("O_T_EE[{}]", np.zeros((300, 16)))
    is_the_motion(from_text(tmp_path, EXPORTS["franka"] | poses))


def test_degrees_where_radians_would_leave_the_joints_ranges(tmp_path):
    """Small angles in degrees are told by the arm's ranges."""
    export = {"time": TIME, **numbered("J{}", np.full_like(Q, 4.0) + Q, 1), **numbered("torque_{}", TORQUE, 1)}
    log = from_text(tmp_path, export)
    assert log.q == pytest.approx(np.radians(4.0 + Q), abs=1e-6)
    assert any("as radians joint 1 would be beyond its range" in warning for warning in log.warnings)


def test_a_data_frame():
    log = logs_from([(table_of(pd.DataFrame(EXPORTS["plotjuggler"]), "DataFrame"), ReadingSettings())], arm())[0]
    is_the_motion(log)
    assert log.file == "DataFrame"
