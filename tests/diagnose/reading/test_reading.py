"""Recordings read: units, foreign files, and every cell that is no number named by its row."""

from __future__ import annotations

import contextlib
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.reading.columns import meaning_of
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.diagnose.residual.recorded_conditions import conditions_of
from linkwright.core.units.quantities import InputError
from tests.diagnose.recorded import planar_arm, planar_tip, poses, table, written

ARM = planar_arm()
Q = poses(30)
TIP = planar_tip(Q)


def slide() -> Arm:
    return Arm("rail", (Joint("prismatic", (1.0, 0.0, 0.0), (0.0, 1.0)),), (Link(0.2, mass=0.0),))


def test_a_plain_file(tmp_path: Path) -> None:
    read = read_recording(written(tmp_path / "r.csv", table(Q, TIP)), ARM)
    assert read.q == pytest.approx(Q, abs=1e-8)
    assert read.tip == pytest.approx(TIP, abs=1e-9)
    assert read.row.tolist() == list(range(2, 32))
    assert (read.time, read.sides, read.payload_mass, read.sigma) == (None, None, None, None)
    assert (read.frame, read.tool, read.rejected, read.warnings) == ("known", "known", (), ())


UNITS = {
    "q1_deg": math.radians(1), "q2_rad": 1.0, "time_s": 1.0, "time_min": 60.0, "time_h": 3600.0, "payload_kg": 1.0,
    "payload_g": 1e-3, "x_mm": 1e-3, "y_um": 1e-6, "z_m": 1.0, "x_in": 0.0254, "v1_deg_s": math.radians(1),
    "v2_rad_s": 1.0, "a1_deg_s2": math.radians(1), "tau1_Nm": 1.0, "tau3_kNm": 1e3, "fx_N": 1.0, "fy_kN": 1e3,
    "basex_mm": 1e-3, "c1_deg": math.radians(1), "j3_mrad": 1e-3, "q3_arcmin": math.radians(1 / 60), "dir2": 1.0,
    "qw": 1.0, "temperature_K": 1.0, "temperature_link2_K": 1.0,
}  # fmt: skip


@pytest.mark.parametrize("header", UNITS)
def test_units_of_headers(header: str) -> None:
    meaning = meaning_of(header, ARM, file="f")
    assert meaning is not None
    assert (meaning.factor, meaning.offset) == (pytest.approx(UNITS[header], rel=1e-12), 0.0)


def test_temperatures_are_absolute() -> None:
    celsius, fahrenheit = (meaning_of(f"temperature_{unit}", ARM, file="f") for unit in ("degC", "degF"))
    assert celsius is not None
    assert fahrenheit is not None
    assert 21.5 * celsius.factor + celsius.offset == pytest.approx(294.65)
    assert 212.0 * fahrenheit.factor + fahrenheit.offset == pytest.approx(373.15)


def test_slides_have_lengths() -> None:
    meaning = meaning_of("q1_mm", slide(), file="f")
    assert meaning is not None
    assert meaning.factor == pytest.approx(1e-3)
    for header in ("q1_deg", "v1_deg_s", "tau1_Nm"):
        with pytest.raises(InputError, match="is no unit of a"):
            meaning_of(header, slide(), file="f")


@pytest.mark.parametrize(
    ("header", "said"),
    [("q1", "q1_deg or q1_rad"), ("x", "x_mm or x_m"), ("q1_mm", "no unit of an angle"), ("payload", "payload_kg"),
     ("q4_deg", "has 3 joints"), ("temperature_C", "temperature_degC"), ("v1_deg", "v1_deg_s"),
     ("dir1_deg", "write dir1"), ("temperature_link9_degC", "3 links")],
)  # fmt: skip
def test_headers_without_their_unit_say_what_would_do(tmp_path: Path, header: str, said: str) -> None:
    columns = table(Q, TIP) | {header: ["0"] * 30}
    with pytest.raises(InputError, match=said):
        read_recording(written(tmp_path / "r.csv", columns), ARM)


@given(st.text(max_size=30))
def test_no_header_does_worse_than_an_input_error(header: str) -> None:
    with contextlib.suppress(InputError):
        meaning = meaning_of(header, ARM, file="f")
        assert meaning is None or math.isfinite(meaning.factor)


@pytest.mark.parametrize("missing", ["q2_deg", "x_mm", "y_mm"])
def test_a_missing_column_is_named_with_what_there_is(tmp_path: Path, missing: str) -> None:
    columns = table(Q, TIP)
    del columns[missing]
    with pytest.raises(InputError) as refused:
        read_recording(written(tmp_path / "r.csv", columns), ARM)
    assert missing in str(refused.value)
    assert "q1_deg" in str(refused.value)


def test_without_a_tip_it_is_said_what_else_a_file_may_be_of(tmp_path: Path) -> None:
    """Another instrument, or a motion log whose torques were not recognised."""
    columns = {name: cells for name, cells in table(Q, TIP).items() if name not in ("x_mm", "y_mm", "z_mm")}
    with pytest.raises(InputError, match=r"observes: along.*a motion log has torques \(tau1_Nm\) or currents"):
        read_recording(written(tmp_path / "r.csv", columns), ARM)


@pytest.mark.parametrize(
    ("text", "said"),
    [("", "is empty"), ("q1_deg,q2_deg,q3_deg,x_mm,y_mm\n", "no rows"), ("1,2,3\n4,5,6\n", "no header"),
     ("x_mm,x_mm\n1,2\n", "occurs twice"), ("a\0b\n1\n", "NUL"), ('q1_deg,"x_mm\n1,2\n', "no table"),
     ("q1_deg,x_mm\n1,2,3\n", "no row has the 2 cells")],
)  # fmt: skip
def test_what_is_no_table(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "r.csv").write_text(text)
    with pytest.raises(InputError, match=said):
        read_recording(tmp_path / "r.csv", ARM)


def test_files_that_are_not_there(tmp_path: Path) -> None:
    for name in ("no.csv", "no.parquet"):
        with pytest.raises(InputError, match="no such file"):
            read_recording(tmp_path / name, ARM)
    (tmp_path / "bad.parquet").write_text("x")
    with pytest.raises(InputError, match="parquet"):
        read_recording(tmp_path / "bad.parquet", ARM)


@pytest.mark.parametrize(
    ("cell", "said"),
    [("", "is blank"), ("nan", "is nan"), ("inf", "is inf"), ("-Infinity", "is -Infinity"), ("abc", "not a number"),
     ("1_0", "not a number"), ("#REF!", "not a number")],
)  # fmt: skip
def test_cells_without_a_number_cost_their_row(tmp_path: Path, cell: str, said: str) -> None:
    columns = table(Q, TIP, payload_kg=np.full(30, 2.0))
    columns["q2_deg"][4] = columns["x_mm"][9] = columns["payload_kg"][29] = cell
    read = read_recording(written(tmp_path / "r.csv", columns), ARM)
    assert [item.row for item in read.rejected] == [6, 11, 31]
    assert all(said in item.reason for item in read.rejected)
    for name, each in zip(("q2_deg", "x_mm", "payload_kg"), read.rejected, strict=True):
        assert name in each.reason
    assert read.size == 27
    assert not {6, 11, 31} & set(read.row.tolist())
    assert np.isfinite(read.q).all()


def test_short_and_long_rows_are_named(tmp_path: Path) -> None:
    path = written(tmp_path / "r.csv", table(Q, TIP))
    lines = path.read_text().splitlines()
    lines[3] = ",".join(lines[3].split(",")[:3])
    lines[7] += ",1,2"
    path.write_text("\n".join(lines))
    read = read_recording(path, ARM)
    assert [item.row for item in read.rejected] == [4, 8]
    assert "3 cells" in read.rejected[0].reason
    assert read.q[2] == pytest.approx(Q[3], abs=1e-8)


def test_mostly_blank_columns_are_not_used_and_said(tmp_path: Path) -> None:
    columns = table(Q, TIP) | {"temperature_degC": [""] * 25 + ["21"] * 5}
    read = read_recording(written(tmp_path / "r.csv", columns), ARM)
    assert read.temperature is None
    assert read.size == 30
    assert any("temperature_degC is not used" in sentence for sentence in read.warnings)


def test_words_after_a_known_name_make_a_stranger(tmp_path: Path) -> None:
    columns = table(Q, TIP) | {"x_mean_of_ten": ["1"] * 30}
    read = read_recording(written(tmp_path / "r.csv", columns), ARM)
    assert read.other["x_mean_of_ten"].tolist() == [1.0] * 30
    assert any("x_mean_of_ten is not used" in sentence for sentence in read.warnings)


def test_unknown_columns_are_said_and_kept(tmp_path: Path) -> None:
    columns = table(Q, TIP) | {"payoad_kg": ["1"] * 30, "note": ["a"] * 30}
    read = read_recording(written(tmp_path / "r.csv", columns), ARM)
    assert read.other["payoad_kg"].tolist() == [1.0] * 30
    assert any("did you mean 'payload_kg'" in sentence for sentence in read.warnings)
    assert any(sentence.startswith("note ") for sentence in read.warnings)


def test_everything_that_a_recording_can_hold(tmp_path: Path) -> None:
    further = {
        "time_s": 100.0 + np.arange(30.0), "payload_kg": np.repeat([0.0, 5.0, 0.0], 10),
        "temperature_degC": np.linspace(20, 30, 30), "temperature_link2_degC": np.linspace(25, 35, 30),
        "dir1": np.ones(30), "dir3": -np.ones(30), "fx_N": np.linspace(1, 2, 30), "fy_N": np.linspace(3, 4, 30),
        "basex_mm": np.linspace(0, 1, 30), "basey_mm": np.linspace(1, 2, 30),
        **{f"{base}{k}_{unit}": np.linspace(0, k, 30) for k in (1, 2, 3)
           for base, unit in (("c", "deg"), ("j", "deg"), ("v", "deg_s"), ("a", "deg_s2"), ("tau", "Nm"))},
        "qw": np.ones(30), "qx": np.zeros(30), "qy": np.zeros(30), "qz": np.zeros(30),
    }  # fmt: skip
    read = read_recording(written(tmp_path / "r.csv", table(Q, TIP, **further)), ARM)
    assert read.time is not None
    assert read.time == pytest.approx(np.arange(30.0))
    for name, columns in (("commanded", 3), ("joint_side", 3), ("velocity", 3), ("acceleration", 3), ("torque", 3),
                          ("force", 3), ("base_target", 3), ("sides", 3), ("link_temperature", 3)):  # fmt: skip
        assert getattr(read, name).shape == (30, columns), name
    assert read.sides is not None
    assert read.sides[0].tolist() == [1.0, 0.0, -1.0]
    assert read.orientation is not None
    assert read.orientation[7] == pytest.approx(np.eye(3))
    assert read.velocity is not None
    assert read.velocity[-1] == pytest.approx(np.radians([1, 2, 3]))
    held = conditions_of(read, ARM)
    assert held.warming is not None
    assert held.warming[1] == pytest.approx(np.linspace(5, 15, 30), abs=1e-5)
    assert held.warming[0] == pytest.approx(np.linspace(0, 10, 30), abs=1e-5)
    assert held.loaded_for is not None
    assert np.asarray(held.loaded_for).tolist() == pytest.approx([*range(10), *range(10), *range(10)])
    assert held.sides is not None
    assert held.velocities is not None


def test_conditions_that_nobody_knows_are_none(tmp_path: Path) -> None:
    """But for how far each joint had gone since the reading before, which the order of the rows tells."""
    held = conditions_of(read_recording(written(tmp_path / "r.csv", table(Q, TIP)), ARM), ARM)
    assert all(getattr(held, name) is None for name in vars(held) if name != "last_moves")
    assert held.last_moves is not None
    moves = np.array(held.last_moves).T
    assert np.all(moves[0] == 0.0)
    assert moves[1:] == pytest.approx(np.diff(Q, axis=0), abs=1e-6)


def test_a_row_set_aside_was_still_the_reading_before(tmp_path: Path) -> None:
    recording = read_recording(written(tmp_path / "r.csv", table(Q, TIP)), ARM)
    fewer = recording.without([RejectedRow(5, "a test")])
    assert fewer.row.tolist()[2:4] == [4, 6]
    assert fewer.last_moves is not None
    assert fewer.last_moves[3] == pytest.approx(Q[4] - Q[3], abs=1e-6)


def test_a_foreign_file(tmp_path: Path) -> None:
    columns = {
        "Stamp": [f"202007141639{k:02d}" for k in range(30)],
        **{f"Joint {k + 1} [rad]": [f"{x:.9f}".replace(".", ",") for x in Q[:, k]] for k in range(3)},
        "pos (2)": [f"{1e3 * y:.6f}".replace(".", ",") for y in TIP[:, 1]],
        "pos (1)": [f"{1e3 * x + 12.5:.6f}".replace(".", ",") for x in TIP[:, 0]],
        "visit": [str(k) for k in range(30)],
    }
    path = written(tmp_path / "log.csv", columns, ";")
    path.write_text("Made by a robot\n# units: none\n" + path.read_text())
    (tmp_path / "log.yaml").write_text(
        "columns:\n"
        '  q1_deg: "Joint 1 [rad]*57.29577951308232"\n'
        "  q2_rad: Joint 2 [rad]\n"
        "  q3_rad: -(0 - Joint 3 [rad])\n"
        "  x_mm: pos (1) - 12.5\n"
        "  y_m: pos (2)/10**3\n"
        "  time_s: Stamp\n"
        "skip_rows: 1\ncomment: '#'\nseparator: ';'\ndecimal: ','\n"
        'time_format: "%Y%m%d%H%M%S"\nrows: visit >= 10\nsigma: 15 um\nframe: free\ntool: free\n'
    )
    read = read_recording(path, ARM)
    assert read.q == pytest.approx(Q[10:], abs=1e-8)
    assert read.tip == pytest.approx(TIP[10:], abs=1e-8)
    assert read.time is not None
    assert read.time == pytest.approx(np.arange(20.0))
    assert read.row.tolist() == list(range(14, 34))
    assert (read.sigma, read.frame, read.tool) == (pytest.approx(15e-6), "free", "free")
    assert any("20 of 30 rows" in sentence for sentence in read.warnings)
    assert read.settings == str(tmp_path / "log.yaml")


@pytest.mark.parametrize(
    ("text", "said"),
    [("columns: {q1_dge: x_mm}", "write q1_deg"), ("columns: {payoad_kg: x_mm}", "did you mean 'payload_kg'"),
     ("columns: {q1_deg: sin(x_mm)}", "position 1"), ("columns: {q1_deg: [1]}", "needs a formula"),
     ("colums: {}", "did you mean 'columns'"), ("sigma: 15", "needs a unit"),
     ("sigma: 0 um", "positive"), ("frame: fixed", "not one of"), ("rows: x_mm > 1e9", "no row of"),
     ("rows: x_mm", "comparison"), ("ignore: [nothing]", "no column"),
     ("time_format: '%Y'\ncolumns: {time_s: x_mm+1}", "one column"),
     ("separator: ab", "one character"), ("encoding: klingon", "no encoding"),
     ("columns: {q1_deg: q1_deg, q1_rad: q1_deg}", "given twice")],
)  # fmt: skip
def test_settings_that_are_wrong(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "recording.yaml").write_text(text)
    with pytest.raises(InputError, match=said):
        read_recording(written(tmp_path / "r.csv", table(Q, TIP)), ARM)


def test_an_arm_beside_its_recording_is_not_its_settings(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text("chain: []")
    assert read_recording(written(tmp_path / "arm.csv", table(Q, TIP)), ARM).settings == ""


def test_a_formula_that_cannot_be_computed_costs_its_row(tmp_path: Path) -> None:
    columns = table(Q, TIP) | {"u": ["1"] * 12 + ["0"] + ["1"] * 17}
    (tmp_path / "recording.yaml").write_text("columns: {payload_kg: 1/u}")
    read = read_recording(written(tmp_path / "r.csv", columns), ARM)
    assert [item.row for item in read.rejected] == [14]
    assert "1/u" in read.rejected[0].reason


def test_parquet_is_read_like_csv(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    import pandas as pd

    columns = {name: np.array(values, dtype=float) for name, values in table(Q, TIP).items()}
    columns["q1_deg"][3] = math.nan
    pd.DataFrame(columns).to_parquet(tmp_path / "r.parquet")
    read = read_recording(tmp_path / "r.parquet", ARM)
    assert read.q == pytest.approx(np.delete(Q, 3, axis=0), abs=1e-8)
    assert [item.row for item in read.rejected] == [4]


def test_euler_angles_turn_about_fixed_axes(tmp_path: Path) -> None:
    columns = table(Q, TIP, rx_deg=np.full(30, 90.0), ry_deg=np.zeros(30), rz_deg=np.full(30, 90.0))
    read = read_recording(written(tmp_path / "r.csv", columns), ARM)
    assert read.orientation is not None
    # z turned 90 deg about x is -y, and that turned 90 deg about the fixed z is x.
    assert read.orientation[0] @ [0.0, 0.0, 1.0] == pytest.approx([1.0, 0.0, 0.0])
