"""Sides and payloads that stand beside the wrong readings are told, by recordings of the textbook's kinematics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.diagnose.fitting.prepare import prepare
from linkwright.core.diagnose.options import Options
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.result import Diagnosis
from linkwright.core.diagnose.search.labels import mislabelled
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.sections.numeric import Array
from tests.diagnose.arm_of_drives import COMPLIANCE, SIGMA, arm_of_drives
from tests.diagnose.recorded import LENGTHS, planar_tip, sagging_tip, table, written

ARM = arm_of_drives()


def diagnosed(folder: Path, logged: Array | None, seed: int = 4) -> Diagnosis:
    """Lost motion of 0.5 mrad at joint 2, held by friction: half of it against the side of approach. Every pose is
    read twice; `logged` turns the sides that held into those that were written down."""
    rng = np.random.default_rng(seed)
    visits = 90
    stood = np.repeat(rng.uniform(-1.5, 1.5, (visits, 3)), 2, axis=0)
    sides = np.repeat(rng.choice([-1.0, 1.0], (visits, 3)), 2, axis=0)
    actual = stood - 0.25e-3 * sides * np.array([0.0, 1.0, 0.0])
    tip = planar_tip(actual) + SIGMA * rng.standard_normal((2 * visits, 2))
    said = sides if logged is None else sides[logged] if logged.dtype.kind == "i" else sides * logged
    columns = table(stood, tip, **{f"dir{k + 1}": said[:, k] for k in range(3)})
    (folder / "recording.yaml").write_text(f"sigma: {1e6 * SIGMA:g} um\n", encoding="utf-8")
    return diagnose(ARM, read_recording(written(folder / "recording.csv", columns), ARM, folder / "recording.yaml"))


ROWS = np.arange(180)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("logged", "said"),
    [
        (np.clip(ROWS - 2, 0, 179), "one visit late"),
        (np.clip(ROWS + 2, 0, 179), "one visit early"),
        (-np.ones((180, 1)), "with the opposite sign"),
    ],
)
def test_sides_beside_the_wrong_readings_are_told(tmp_path: Path, logged: Array, said: str) -> None:
    result = diagnosed(tmp_path, logged)
    assert result.verdict in ("unknown", "none")
    assert result.labels is not None
    assert said in result.labels.said
    assert [at for _, at in result.labels.named] == [(2,)]
    assert result.labels.said in result.sentence


def slack(folder: Path, columns: list[int], seed: int = 4) -> Diagnosis:
    """Lost motion held by friction at two joints, 0.3 and 0.6 mrad, joint by joint by the textbook; sides written down
    in another order of columns."""
    rng = np.random.default_rng(seed)
    visits = 90
    stood = np.repeat(rng.uniform(-1.5, 1.5, (visits, 3)), 2, axis=0)
    sides = np.repeat(rng.choice([-1.0, 1.0], (visits, 3)), 2, axis=0)
    tip = planar_tip(stood - np.array([0.0, 0.15e-3, 0.3e-3]) * sides)
    tip += SIGMA * rng.standard_normal(tip.shape)
    said = table(stood, tip, **{f"dir{k + 1}": sides[:, column] for k, column in enumerate(columns)})
    (folder / "recording.yaml").write_text(f"sigma: {1e6 * SIGMA:g} um\n", encoding="utf-8")
    return diagnose(ARM, read_recording(written(folder / "recording.csv", said), ARM, folder / "recording.yaml"))


@pytest.mark.slow
def test_sides_of_two_joints_in_each_others_columns_are_told(tmp_path: Path) -> None:
    result = slack(tmp_path, [0, 2, 1])
    assert result.verdict in ("unknown", "none")
    assert result.labels is not None
    assert result.labels.said == "the sides of joints 2 and 3 stand in each other's columns (dirN)"
    assert {at for _, at in result.labels.named} == {(2,), (3,)}
    assert result.labels.rms < 1.1 * np.sqrt(2.0) * SIGMA


def test_sides_in_their_own_columns_are_left_alone(tmp_path: Path) -> None:
    result = slack(tmp_path, [0, 1, 2])
    assert result.labels is None
    assert {finding.at for finding in result.findings} == {(2,), (3,)}


@pytest.mark.slow
def test_sides_that_are_right_are_left_alone(tmp_path: Path) -> None:
    result = diagnosed(tmp_path, None)
    assert result.labels is None
    assert [finding.at for finding in result.findings] == [(2,)]


@pytest.mark.slow
def test_sides_in_no_order_at_all_are_not_called_late(tmp_path: Path) -> None:
    """Sides written down at random: no shift of them explains anything."""
    assert diagnosed(tmp_path, np.random.default_rng(8).permutation(180)).labels is None


@pytest.mark.slow
def test_what_the_labels_do_not_touch_says_nothing_against_them(tmp_path: Path) -> None:
    """A zero that is off shows alike whatever the sides: put right or not, it leaves the noise."""
    rng = np.random.default_rng(7)
    stood = np.repeat(rng.uniform(-1.5, 1.5, (40, 3)), 2, axis=0)
    sides = np.repeat(rng.choice([-1.0, 1.0], (40, 3)), 2, axis=0)
    tip = planar_tip(stood + np.array([0.0, 0.5e-3, 0.0])) + SIGMA * rng.standard_normal((80, 2))
    columns = table(stood, tip, **{f"dir{k + 1}": sides[:, k] for k in range(3)})
    (tmp_path / "recording.yaml").write_text(f"sigma: {1e6 * SIGMA:g} um\n", encoding="utf-8")
    read = read_recording(written(tmp_path / "recording.csv", columns), ARM, tmp_path / "recording.yaml")
    floor = np.sqrt(2.0) * SIGMA
    logged = prepare(observe(ARM, read), Options(), floor).observed
    assert mislabelled(logged, read, Options(), floor, 20.0 * floor, lambda _: None) is None


def hung(folder: Path, wrong: str) -> Diagnosis:
    """One of three payloads at every visit, on drives of which the second gives 12 urad/(N*m) more than the file says;
    its column says it of another visit, or of another payload."""
    rng = np.random.default_rng(6)
    stood = np.repeat(rng.uniform(-1.5, 1.5, (40, 3)), 2, axis=0)
    payload = np.repeat(rng.choice([0.0, 3.0, 6.0], 40), 2)
    tip = sagging_tip(stood, 1.0 / (np.array(COMPLIANCE) + np.array([0.0, 1.2e-5, 0.0])), payload)
    tip += SIGMA * rng.standard_normal(tip.shape)
    swapped = {0.0: 6.0, 3.0: 3.0, 6.0: 0.0}
    said = {
        "late": np.roll(payload, 2),
        "swapped": np.array([swapped[item] for item in payload.tolist()]),
        "right": payload,
    }[wrong]
    columns = table(stood, tip, payload_kg=said)
    (folder / "recording.yaml").write_text(f"sigma: {1e6 * SIGMA:g} um\n", encoding="utf-8")
    arm = replace(ARM, gravity=(0.0, -9.81, 0.0))
    return diagnose(arm, read_recording(written(folder / "recording.csv", columns), arm, folder / "recording.yaml"))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ("late", "payload_kg was logged one visit late"),
        pytest.param("swapped", "payloads of 0 kg and 6 kg have changed places", marks=pytest.mark.slow),
    ],
)
def test_payloads_beside_the_wrong_readings_are_told(tmp_path: Path, wrong: str, said: str) -> None:
    result = hung(tmp_path, wrong)
    assert result.verdict in ("unknown", "none")
    assert result.labels is not None
    assert said in result.labels.said
    assert [at for _, at in result.labels.named] == [(2,)]
    assert result.labels.said in result.sentence


def test_payloads_that_are_right_are_left_alone(tmp_path: Path) -> None:
    result = hung(tmp_path, "right")
    assert result.labels is None
    assert [finding.at for finding in result.findings] == [(2,)]


MASSES = np.array([8.0, 5.0, 3.0])
"""kg of the links, each in its middle: their weight tells a payload's unit from drives that give more or less."""


def lifted(said: float, *, softens: float = 0.0) -> Diagnosis:
    """One of three payloads at every visit, on drives as the file has them or, per N*m, softer by `softens`; the column
    says so many times the payload's kilograms."""
    rng = np.random.default_rng(1)
    q = np.repeat(rng.uniform(-2.0, 2.0, (40, 3)), 2, axis=0)
    payload = np.repeat(rng.choice([0.0, 2.0, 5.0], 40), 2)
    turned = np.zeros_like(q)
    for _ in range(20):
        out = np.cos(np.cumsum(q + turned, axis=1)) * LENGTHS
        end = np.cumsum(out, axis=1)
        middle, begin = end - 0.5 * out, end - out
        links = [(middle[:, k:] - begin[:, k : k + 1]) @ MASSES[k:] for k in range(3)]
        torque = 9.81 * (np.stack(links, axis=1) + payload[:, None] * (end[:, 2:] - begin))
        turned = -np.array(COMPLIANCE) * torque * (1.0 + softens * np.abs(torque))
    tip = planar_tip(q + turned) + SIGMA * rng.standard_normal((80, 2))
    links = tuple(replace(link, mass=float(mass)) for link, mass in zip(ARM.links, MASSES, strict=True))
    arm = replace(ARM, links=links, gravity=(0.0, -9.81, 0.0))
    return diagnose(arm, Recording("r.csv", q, tip, np.arange(1, 81), payload_mass=said * payload))


@pytest.mark.parametrize(
    ("said", "unit"),
    [
        (1.0 / 0.45359237, "payload_kg holds lb"),
        pytest.param(0.45359237, "payload_kg was taken for lb and converted", marks=pytest.mark.slow),
    ],
)
def test_payloads_in_another_unit_are_told(said: float, unit: str) -> None:
    result = lifted(said)
    assert result.labels is not None
    assert result.labels.said == unit
    assert result.labels.named == ()
    assert f"It looks as if {unit}: with that put right, nothing is missing" in result.sentence


@pytest.mark.slow
def test_drives_that_soften_under_load_are_no_other_unit() -> None:
    result = lifted(1.0, softens=0.01)
    assert result.verdict == "unknown"
    assert result.labels is None
