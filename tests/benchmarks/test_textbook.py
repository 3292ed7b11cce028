"""The textbook's least squares: what it is given, it gives back; its torques are MuJoCo's."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from benchmarks.canonical import cells
from benchmarks.real.table.row import Figures, Row, mean_ratio, shown, summary
from benchmarks.real.textbook import single, tips, torques
from benchmarks.real.textbook.chain import Chain, from_arm_file, from_urdf, transform, turned

URDF = """<robot name="two">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0.2 0.01 -0.02" rpy="0.1 0.2 -0.3"/><mass value="3"/>
    <inertia ixx="0.02" iyy="0.05" izz="0.06" ixy="0.002" ixz="-0.001" iyz="0.003"/></inertial></link>
  <link name="fore"><inertial><origin xyz="0.1 0.0 0.03"/><mass value="1.5"/>
    <inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="hand"><inertial><origin xyz="0.05 0.02 0" rpy="0 0 0.5"/><mass value="0.7"/>
    <inertia ixx="0.001" iyy="0.002" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j1" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.3" rpy="0.2 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="j2" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="0.4 0 0.1" rpy="0 0.4 0.1"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="j3" type="prismatic"><parent link="fore"/><child link="hand"/><origin xyz="0.2 0 0" rpy="0 0 0.7"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""


@pytest.fixture
def urdf(tmp_path: Path) -> Path:
    path = tmp_path / "robot.urdf"
    path.write_text(URDF, encoding="utf-8")
    return path


@pytest.mark.parametrize("moving", [("j1", "j2", "j3"), ("j1", "j2")])
def test_torques_are_mujocos(urdf: Path, moving: tuple[str, ...]):
    """What a slide that stands still carries is a part of the link before it."""
    chain = from_urdf(urdf, moving)
    model = mujoco.MjModel.from_xml_string(URDF)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)  # no joint has an end here
    data = mujoco.MjData(model)
    rng = np.random.default_rng(3)
    for _ in range(5):
        q, v, a = rng.normal(size=(3, len(moving)))
        for state, values in ((data.qpos, q), (data.qvel, v), (data.qacc, a)):
            state[:] = 0.0
            state[: len(moving)] = values
        mujoco.mj_inverse(model, data)
        mine = torques.nominal(chain).torque(q[None], v[None], a[None])[0]
        assert mine == pytest.approx(data.qfrc_inverse[: len(moving)], abs=1e-9)


def test_friction_and_bodies_come_back(urdf: Path):
    """A motion that the model itself made: friction and rotors exactly, and torques of another motion."""
    chain = from_urdf(urdf, ("j1", "j2", "j3"))
    rng = np.random.default_rng(5)
    body = torques.bodies(chain) * rng.uniform(0.9, 1.1, (3, 10))
    drive = np.array([[0.8, 0.5, 0.1, 0.05], [0.6, 0.3, -0.2, 0.03], [2.0, 4.0, 0.5, 0.2]])
    true = torques.Identification(chain, body, drive, np.zeros(3))
    time = np.arange(0.0, 25.0, 0.01)

    def motion(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        waves = np.random.default_rng(seed)
        w = 2 * np.pi * waves.uniform(0.1, 0.8, (4, 3))
        a, p = waves.uniform(0.1, 0.35, (4, 3)), waves.uniform(0, 6, (4, 3))
        phase = time[:, None, None] * w + p
        return (a * np.sin(phase)).sum(1), (a * w * np.cos(phase)).sum(1), -(a * w**2 * np.sin(phase)).sum(1)

    log = torques.Log(time, motion(1)[0], true.torque(*motion(1)))
    fitted = torques.identified(chain, [log], 8.0)
    assert fitted.drive[:, :2] == pytest.approx(drive[:, :2], rel=0.02)
    other = motion(2)
    wrong = fitted.torque(*other) - true.torque(*other)
    given = torques.nominal(chain).torque(*other) - true.torque(*other)
    assert np.sqrt((wrong**2).mean(0)) == pytest.approx(np.zeros(3), abs=0.02 * np.sqrt((given**2).mean()))


def _chain(folder: Path) -> Chain:
    path = folder / "arm.yaml"
    path.write_text(cells.arm_text(), encoding="utf-8")
    return from_arm_file(path)


def test_calibration_carries_over(tmp_path: Path):
    """Axes that are turned and shifted by up to a usual size, drives that give: other poses, another frame and tool."""
    chain, rng = _chain(tmp_path), np.random.default_rng(2)
    weighed = Chain(
        chain.fixed, chain.axes, chain.slides, chain.gravity, np.array(cells.MASSES), chain.centre, chain.inertia, True
    )
    stations = np.stack([transform(turned(rng.normal(0, 1e-3, 3)), rng.normal(0, 1e-3, 3)) for _ in range(6)])
    stations[0] = np.eye(4)
    true = tips.Calibration(weighed, stations, np.array([1e-6, 2e-6, 4e-6, 0, 0, 0, 5e-7]), True)
    low, high = np.deg2rad(np.array(cells.RANGES)).T * 0.5

    def measured(seed: int) -> tips.Poses:
        draw = np.random.default_rng(seed)
        frame = transform(turned(np.array([0.1, -0.2, draw.uniform(-3, 3)])), draw.normal(0, 0.5, 3))
        q = draw.uniform(low, high, (150, 6))
        where = tips.places(true, tips.Setup(frame, draw.normal(0, 0.1, 3)), q)
        return tips.Poses(q, where + 1e-5 * draw.standard_normal(where.shape))

    for arm in (weighed, chain):
        book = tips.calibrated(arm, [measured(7)])
        left = tips.rms(tips.seated(book, measured(8))[1])
        given = tips.rms(tips.seated(tips.nominal(arm), measured(8))[1])
        assert given > 1e-3
        assert left < 4e-5 + 0.01 * given


def test_a_pair_of_setups_is_fitted_together(tmp_path: Path):
    """An arm as its file says leaves the noise in either frame."""
    chain = _chain(tmp_path)
    rng = np.random.default_rng(4)
    parts: list[tips.Poses] = []
    for turn in (0.3, -2.0):
        q = rng.uniform(-1.0, 1.0, (60, 6))
        setup = tips.Setup(transform(turned(np.array([0.0, 0.0, turn])), (0.1, 0.2, 0.3)), np.array([0.1, 0.0, 0.05]))
        parts.append(tips.Poses(q, tips.places(tips.nominal(chain), setup, q) + 1e-5 * rng.standard_normal((60, 3))))
    assert tips.calibrated(chain, parts).rms == pytest.approx(np.sqrt(3.0) * 1e-5, rel=0.15)


def test_a_spring_and_a_slope_come_back():
    """One joint, one column."""
    q, force = np.full(20, 0.8), np.column_stack([np.zeros(20), np.linspace(-3, 3, 20)])
    true = single.Spring(0.1, 2e-3, 0.04)
    tip = -true.left(q, np.zeros((20, 2)), force)
    found = single.spring(q, tip, force, 0.1)
    assert (found.middle, found.compliance) == pytest.approx((2e-3, 0.04), rel=1e-6)
    warm = np.linspace(20.0, 40.0, 30)
    rise = single.slope(warm, 3e-5 * warm + 0.2)
    assert rise == pytest.approx(3e-5)
    assert single.left(warm, 3e-5 * warm + 0.2, rise) == pytest.approx(0.0, abs=1e-12)


def _row(textbook: float, ours: float, seen: Figures, changed: bool = True, promised: float = 1.0) -> Row:
    return Row("arm", "a", "b", Figures(2.0, textbook, ours), seen, "named, 3 names", changed, promised)


def test_a_miss_says_why():
    """By the figures alone; what does not miss says nothing."""
    fine = Figures(2.0, 1.0, 1.0)
    assert _row(1.0, 1.0, fine).reason == ""
    assert _row(1.0, 2.0, Figures(2.0, 1.0, 2.0), changed=False).reason.startswith("no file was written")
    assert "was promised" in _row(1.0, 1.5, Figures(2.0, 1.0, 1.2)).reason
    assert _row(1.0, 1.5, Figures(2.0, 1.0, 1.2), promised=1.2).reason.startswith("a cause is missing")
    assert _row(1.0, 2.5, fine).reason.startswith("worse than the given file")
    assert _row(1.0, 1.5, fine).reason.startswith("does not carry over")
    assert "**0.50**" in shown(_row(1.0, 0.5, fine))
    rows = [_row(1.0, 0.5, fine), _row(1.0, 2.0, fine)]
    assert mean_ratio(rows) == pytest.approx(1.0)
    assert summary(rows).startswith("2 rows: 1 above 1.05")
