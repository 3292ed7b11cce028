"""Motion logs of a UR10e under another convention: joints that bear no weight are not judged, those that do are, though
friction is a third of their torque and their masses are a tenth off."""

from __future__ import annotations

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.descriptions.imported import import_robot
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import inverse_dynamics
from linkwright.core.diagnose.motion.reading.read import read_log
from linkwright.core.units.quantities import InputError
from tests.arm.motion.robots import UR10E, urdf_of

CONSTANTS = np.array([15.0, 13.0, 11.0, 10.5, 11.0, 11.5])
MIDDLE = np.array([0.3, -1.2, 0.9, -0.8, 0.5, 0.2])


@pytest.fixture(scope="module")
def arm(tmp_path_factory) -> Arm:
    path = tmp_path_factory.mktemp("ur") / "ur10e.urdf"
    path.write_text(urdf_of(UR10E), encoding="utf-8")
    return import_robot(path).arm


@pytest.fixture(scope="module")
def columns(arm) -> dict[str, np.ndarray]:
    """Twenty seconds of all joints, in currents."""
    time = np.arange(1000) / 50.0
    rates = np.array([0.7, 0.55, 0.8, 1.1, 0.9, 1.3])
    phase = rates * time[:, None] + np.arange(6)
    q, v, a = 0.8 * np.sin(phase) + MIDDLE, 0.8 * rates * np.cos(phase), -0.8 * rates**2 * np.sin(phase)
    torque = 1.1 * inverse_dynamics(Motion(arm, time, q, v, a))
    friction = np.array([25.0, 25.0, 12.0, 3.0, 3.0, 3.0])
    torque += friction * np.sign(v) + friction * v + np.random.default_rng(3).normal(0.0, 0.3, torque.shape)
    each = {"q{}_rad": q, "dq{}_radps": v, "current{}_A": torque / CONSTANTS}
    return {"t_s": time} | {name.format(k + 1): values[:, k] for name, values in each.items() for k in range(6)}


def read(folder, arm, columns):
    lines = [",".join(columns), *(",".join(f"{x:.7g}" for x in row) for row in zip(*columns.values(), strict=True))]
    (folder / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "recording.yaml").write_text(
        f"observes: motion\ntorque_constants: {CONSTANTS.tolist()}\n", encoding="utf-8"
    )
    return read_log(folder / "log.csv", arm)


def swapped(columns, one, other, *kinds):
    """Columns of two joints in each other's place."""
    pairs = [(kind.format(one), kind.format(other)) for kind in kinds]
    return columns | {a: columns[b] for a, b in pairs} | {b: columns[a] for a, b in pairs}


Q, DQ, CURRENT = "q{}_rad", "dq{}_radps", "current{}_A"
MISTAKES = {
    "a joint": (
        lambda c: c | {n: -c[n] for n in ("q2_rad", "dq2_radps")},
        "q2_rad counts the other way; write `columns: {q2_rad: -q2_rad, dq2_radps: -dq2_radps}` in recording.yaml",
    ),
    "a current": (
        lambda c: c | {"current3_A": -c["current3_A"]},
        "current3_A counts the other way; write `columns: {current3_A: -current3_A}` in recording.yaml",
    ),
    "a zero": (
        lambda c: c | {"q2_rad": c["q2_rad"] + np.pi / 2},
        "q2_rad counts from another zero, -90 deg away; write `columns: {q2_rad: q2_rad - 1.57079633}` in recording.ya"
        "ml",
    ),
    "two joints": (
        lambda c: swapped(c, 1, 2, Q, DQ, CURRENT),
        "q1_rad and q2_rad have changed places, their torques too; write `columns: {q1_rad: q2_rad, q2_rad: q1_rad, "
        "dq1_radps: dq2_radps, dq2_radps: dq1_radps, current1_A: current2_A, current2_A: current1_A}` in "
        "recording.yaml",
    ),
    "two coordinates": (
        lambda c: swapped(c, 2, 3, Q, DQ),
        "q2_rad and q3_rad have changed places; write `columns: {q2_rad: q3_rad, q3_rad: q2_rad, dq2_radps: dq3_radps, "
        "dq3_radps: dq2_radps}` in recording.yaml",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_one_mistake_is_the_whole_line(tmp_path, arm, columns, name):
    """Nothing is proposed beside it of joints that bear no weight."""
    change, said = MISTAKES[name]
    with pytest.raises(InputError) as caught:
        read(tmp_path, arm, change(columns))
    assert str(caught.value).endswith(f"goes against the arm's weights: {said}")


def test_two_joints_of_one_plane(tmp_path, arm, columns):
    """Bodies of other weights explain all but a hundredth of it: a doubt, and no refusal.

    It lowers the logs of the shares by 2.5. Sound logs of the table of mistakes come to 2.8.
    """
    log = read(tmp_path, arm, swapped(columns, 2, 3, Q, DQ, CURRENT))
    (doubt,) = (said for said in log.warnings if "leave doubt" in said)
    assert "leave doubt: q2_rad and q3_rad have changed places, their torques too" in doubt
    assert "write `columns: {q2_rad: q3_rad, q3_rad: q2_rad" in doubt


def turned(columns, *names):
    return columns | {name: -columns[name] for name in names}


SEVERAL = {
    "two joints with their currents": (
        ("q2_rad", "dq2_radps", "current2_A", "q3_rad", "dq3_radps", "current3_A"),
        "q2_rad counts the other way, its torque too and q3_rad counts the other way, its torque too; write",
    ),
    "two currents": (
        ("current2_A", "current3_A"),
        "current2_A counts the other way and current3_A counts the other way; write",
    ),
    "a joint, and another's current": (
        ("q3_rad", "dq3_radps", "current2_A"),
        "q3_rad counts the other way and current2_A counts the other way; write",
    ),
}


@pytest.mark.parametrize("name", SEVERAL)
def test_several_mistakes_are_told_together(tmp_path, arm, columns, name):
    """Though a few of them alone leave the log no likelier."""
    names, said = SEVERAL[name]
    with pytest.raises(InputError) as caught:
        read(tmp_path, arm, turned(columns, *names))
    assert f"goes against the arm's weights: {said}" in str(caught.value)


def test_currents_of_motors(tmp_path, arm, columns):
    """Gears are told at joints that bear weight; those of the others are taken for alike, and not for 1."""
    with pytest.raises(InputError) as caught:
        read(tmp_path, arm, columns | {f"current{k}_A": columns[f"current{k}_A"] / 100.0 for k in range(1, 7)})
    line = str(caught.value)
    assert "at joint 2" in line
    assert "the gears' own figures, of all joints" in line
    assert all(30.0 < float(item) < 150.0 for item in line.partition("`gear_ratios: [")[2].partition("]")[0].split(","))


def test_the_log_as_it_should_be(tmp_path, arm, columns):
    """And one with drives that carry what the arm file leaves out, so that its weights are worth nothing."""
    assert read(tmp_path, arm, columns).warnings == ()
    balanced = columns["current2_A"] + 200.0 * np.sin(columns["q2_rad"]) / CONSTANTS[1]
    rubbing = columns["current3_A"] + 60.0 * np.sign(columns["dq3_radps"]) / CONSTANTS[2]
    log = read(tmp_path, arm, columns | {"current2_A": balanced, "current3_A": rubbing})
    assert (log.warnings, log.rejected) == ((), ())
