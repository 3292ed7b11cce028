"""Motion logs under another convention than the arm's: refused in one line that says what to write, and read right
with it. Torques are those of two point masses on a vertical plane, by Lagrange's equations."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.motion.reading.read import read_log
from linkwright.core.units.quantities import InputError

LENGTHS, MASSES = (0.4, 0.3), (4.0, 2.0)


def arm() -> Arm:
    """Two rods whose masses are at their ends."""
    links = tuple(Link(length, mass=mass, center_of_mass=length) for length, mass in zip(LENGTHS, MASSES, strict=True))
    return Arm("planar", (Joint(), Joint()), links)


def motion(of_joint_2: tuple[float, float] = (0.9, -0.5)) -> dict[str, np.ndarray]:
    """q, speeds, torques with friction and noise, 20 s at 100 Hz; joint 2 moves by an amplitude about a middle."""
    time = np.arange(2000) / 100.0
    rates, amplitudes = np.array([0.9, 1.3]), np.array([1.1, of_joint_2[0]])
    phase = time[:, None] * rates
    q = amplitudes * np.sin(phase) + np.array([0.4, of_joint_2[1]])
    v, a = amplitudes * rates * np.cos(phase), -amplitudes * rates**2 * np.sin(phase)
    (l1, l2), (m1, m2) = LENGTHS, MASSES
    c, s = np.cos(q[:, 1]), np.sin(q[:, 1])
    coriolis = m2 * l1 * l2 * s
    gravity2 = m2 * 9.81 * l2 * np.cos(q.sum(axis=1))
    tau1 = (m1 * l1**2 + m2 * (l1**2 + 2 * l1 * l2 * c + l2**2)) * a[:, 0] + m2 * (l1 * l2 * c + l2**2) * a[:, 1]
    tau1 += -coriolis * (2 * v[:, 0] * v[:, 1] + v[:, 1] ** 2) + (m1 + m2) * 9.81 * l1 * np.cos(q[:, 0]) + gravity2
    tau2 = m2 * (l1 * l2 * c + l2**2) * a[:, 0] + m2 * l2**2 * a[:, 1] + coriolis * v[:, 0] ** 2 + gravity2
    noise = np.random.default_rng(1).normal(0.0, 0.1, (2000, 2))
    torque = np.stack([tau1, tau2], axis=1) + 1.5 * np.sign(v) + noise
    columns = {"t_s": time}
    for k in range(2):
        columns |= {f"q{k + 1}_rad": q[:, k], f"dq{k + 1}_radps": v[:, k], f"tau{k + 1}_Nm": torque[:, k]}
    return columns


def written(folder: Path, columns: dict[str, np.ndarray], settings: str = "") -> Path:
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(f"{x:.7g}" for x in row) for row in rows)]
    (folder / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "recording.yaml").write_text(f"observes: motion\n{settings}", encoding="utf-8")
    return folder / "log.csv"


def test_the_log_as_it_should_be(tmp_path):
    """And one of an arm whose file has wrong weights, which is no mistake of convention."""
    for factor in (1.0, 0.6, 1.5):
        links = tuple(replace(link, mass=factor * (link.mass or 0.0)) for link in arm().links)
        log = read_log(written(tmp_path, motion()), replace(arm(), links=links))
        assert (log.warnings, log.rejected) == ((), ())


MISTAKES = {
    "q2 counts the other way": (lambda c: c | {"q2_rad": -c["q2_rad"], "dq2_radps": -c["dq2_radps"]}, "q2_rad counts"),
    "tau1 counts the other way": (lambda c: c | {"tau1_Nm": -c["tau1_Nm"]}, "tau1_Nm counts the other way"),
    "a whole joint": (lambda c: c | {n: -c[n] for n in ("q2_rad", "dq2_radps", "tau2_Nm")}, "its torque too"),
    "all torques": (lambda c: c | {n: -c[n] for n in ("tau1_Nm", "tau2_Nm")}, "torques count the other way"),
    "a zero": (lambda c: c | {"q1_rad": c["q1_rad"] - np.pi / 2}, "q1_rad counts from another zero, 90 deg away"),
    "joints changed places": (
        lambda c: c | {"q1_rad": c["q2_rad"], "q2_rad": c["q1_rad"], "dq1_radps": c["dq2_radps"],
                       "dq2_radps": c["dq1_radps"]},
        "q1_rad and q2_rad have changed places",
    ),
    "torques changed places": (
        lambda c: c | {"tau1_Nm": c["tau2_Nm"], "tau2_Nm": c["tau1_Nm"]}, "tau1_Nm and tau2_Nm have changed places"),
    "two mistakes": (
        lambda c: c | {"q1_rad": c["q1_rad"] + np.pi / 2, "q2_rad": -c["q2_rad"], "dq2_radps": -c["dq2_radps"]},
        "another zero, -90 deg away",
    ),
    "speeds in degrees": (
        lambda c: c | {n: np.degrees(c[n]) for n in ("dq1_radps", "dq2_radps")}, "dq1_radps: is 57."),
    "speeds the other way": (lambda c: c | {"dq2_radps": -c["dq2_radps"]}, "dq2_radps: is -1"),
    "torques of the motors": (lambda c: c | {n: c[n] / 100.0 for n in ("tau1_Nm", "tau2_Nm")}, "gear_ratios: ["),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_are_named_with_what_to_write(tmp_path, name):
    """What the line says to write is written; then the log is read, and joints and torques are as they were meant."""
    change, said = MISTAKES[name]
    columns = change(motion())
    with pytest.raises(InputError) as caught:
        read_log(written(tmp_path, columns), arm())
    line = str(caught.value)
    assert said in line
    assert "\n" not in line
    settings = "".join(f"{item}\n" for item in re.findall(r"`((?:columns|gear_ratios): [^`]*)`", line)[:1])
    for _ in range(2):  # speeds are told of one joint after the other
        try:
            log = read_log(written(tmp_path, columns, settings), arm())
            break
        except InputError as error:
            more = re.findall(r"in `columns` of recording.yaml add (.*)$", str(error))[0]
            settings = settings.replace("}\n", f", {more}}}\n")
    given = motion()
    assert np.corrcoef(log.torque[:, 0], given["tau1_Nm"])[0, 1] > 0.99
    assert abs(np.corrcoef(log.q[:, 1], given["q2_rad"])[0, 1]) > 0.99


def test_a_mistake_that_leaves_the_weights_something(tmp_path):
    """Joint 2 moves little, so that the arm's own torques are not worthless with its sign wrong."""
    columns = motion((0.3, 0.1))
    read_log(written(tmp_path, columns), arm())
    with pytest.raises(InputError, match="q2_rad counts the other way"):
        read_log(written(tmp_path, columns | {n: -columns[n] for n in ("q2_rad", "dq2_radps")}), arm())


def test_degrees_taken_for_radians(tmp_path):
    """Small motions, for which the numbers are no angles beyond a turn."""
    columns = motion()
    wrong = columns | {f"q{k}_rad": np.degrees(columns[f"q{k}_rad"]) for k in (1, 2)}
    del wrong["dq1_radps"], wrong["dq2_radps"]
    with pytest.raises(InputError, match="q1_rad, q2_rad seem to be in deg"):
        read_log(written(tmp_path, wrong), arm())
    read_log(written(tmp_path, wrong, "columns: {q1_rad: q1_rad/57.29578, q2_rad: q2_rad/57.29578}\n"), arm())


def test_gravity_from_another_side(tmp_path):
    """An arm file that leaves out how the arm stands: x up. The zero of the first joint would explain it as well."""
    other = replace(arm(), gravity=(-9.81, 0.0, 0.0))
    with pytest.raises(
        InputError, match=r"gravity acts along -y of the base frame \(write `gravity: \[0 m/s\^2, -9.81"
    ):
        read_log(written(tmp_path, motion()), other)


def test_a_drive_that_was_not_logged_tells_nothing(tmp_path):
    """The other one does."""
    columns = {name: values for name, values in motion().items() if name != "tau1_Nm"}
    read_log(written(tmp_path, columns), arm())
    with pytest.raises(InputError, match="tau2_Nm counts the other way"):
        read_log(written(tmp_path, columns | {"tau2_Nm": -columns["tau2_Nm"]}), arm())


def test_currents_of_unknown_constants(tmp_path):
    """Their sign is told, their size is not."""
    columns = {name.replace("tau", "current").replace("_Nm", "_A"): values for name, values in motion().items()}
    for scale in (0.01, 5.0):
        scaled = columns | {name: scale * columns[name] for name in ("current1_A", "current2_A")}
        log = read_log(written(tmp_path, scaled, "torque_constants: free\n"), arm())
        assert log.torque[:, 0] == pytest.approx(scaled["current1_A"], rel=1e-6)
    with pytest.raises(InputError, match="current1_A counts the other way"):
        read_log(written(tmp_path, columns | {"current1_A": -columns["current1_A"]}), arm())


def test_a_clock_that_counts_milliseconds(tmp_path):
    """Samples that seem seconds apart, with speeds a thousand times what the coordinates go by in a second."""
    columns = motion()
    log = read_log(written(tmp_path, columns), arm())
    columns["t_s"] = 1000.0 * columns["t_s"]
    with pytest.raises(InputError, match="clock that counts ms") as refused:
        read_log(written(tmp_path, columns), arm())
    remedy = re.search(r"write `(columns: {t_s: .*?})`", str(refused.value))
    assert remedy is not None
    assert read_log(written(tmp_path, columns, remedy[1]), arm()).time == pytest.approx(log.time)
    poses = {name: column[::500] for name, column in columns.items()}  # that are no motion tell no clock
    more = {name: np.tile(column, 6) for name, column in poses.items() if name != "t_s"}
    still = {"t_s": 5.0 * np.arange(len(more["q1_rad"])), **more}
    assert read_log(written(tmp_path, still), arm()).size == len(still["t_s"])


def test_coordinates_of_motors_go_beyond_the_joints_ranges(tmp_path):
    """To dynamics alone a gear of 50 looks like degrees. A range that the motion passes a little refuses nothing."""
    narrow, wide = (replace(arm(), joints=tuple(Joint(range=(-0.4, 0.4 + by)) for _ in range(2))) for by in (0.0, 1.2))
    columns = motion()
    read_log(written(tmp_path, columns), narrow)
    of_motors = {name: column * 50.0 if name[0] in "qd" else column / 50.0 for name, column in columns.items()}
    of_motors["t_s"] = columns["t_s"]
    with pytest.raises(InputError, match=r"q1_rad: goes through 1\d\d rad, and joint 1 .* 2 at most: .* of the motor"):
        read_log(written(tmp_path, of_motors), wide)


def test_a_drive_that_bears_nothing_of_the_weights_is_said(tmp_path):
    """A torque of noise, of a current's size or of a sensor that is dead: no name of physics without a word."""
    columns = motion()
    assert not any("next to nothing" in said for said in read_log(written(tmp_path, columns), arm()).warnings)
    columns["tau2_Nm"] = np.random.default_rng(2).normal(0.0, 0.01, 2000)
    (said,) = (each for each in read_log(written(tmp_path, columns), arm()).warnings if "next to nothing" in each)
    assert re.search(r"\(RMS: tau2_Nm 0\.0\d+ for \d\)", said)
