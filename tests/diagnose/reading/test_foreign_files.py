"""Files as other people's programs write them, and what is said where they cannot be read."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.recording import Recording
from linkwright.core.units.quantities import InputError
from tests.diagnose.recorded import planar_arm, planar_tip, poses, table, written

ARM = planar_arm((0.4, 0.3))
HEADER = ("q1_deg", "q2_deg", "x_mm", "y_mm")
ANGLES = poses(30, joints=2)
TIPS = planar_tip(ANGLES, (0.4, 0.3))
BODY = [
    [f"{value:.5f}" for value in (*np.degrees(q).tolist(), *(1e3 * tip).tolist())]
    for q, tip in zip(ANGLES, TIPS, strict=True)
]


def text(separator: str, header: str | None = None, decimal: str = ".") -> str:
    lines = [separator.join(HEADER) if header is None else header]
    lines += [separator.join(row).replace(".", decimal) for row in BODY]
    return "\n".join(lines) + "\n"


def read(folder: Path, content: str | bytes, settings: str = "") -> Recording:
    raw = content.encode() if isinstance(content, str) else content
    (folder / "r.csv").write_bytes(raw)
    (folder / "recording.yaml").write_text(settings)
    return read_recording(folder / "r.csv", ARM)


UNREAD = text(",").partition("\n")[2]


@pytest.mark.parametrize(
    ("content", "settings"),
    [
        (text(" ", "# q1_deg q2_deg x_mm y_mm"), ""),  # numpy.savetxt
        (text(",", "# q1_deg,q2_deg,x_mm,y_mm"), ""),
        (text(",", "#q1_deg,q2_deg,x_mm,y_mm"), ""),
        ("   q1_deg    q2_deg   x_mm  y_mm\n" + "\n".join("  " + "    ".join(row) for row in BODY), ""),
        ("sep=;\r\n" + text(";").replace("\n", "\r\n"), ""),
        (text(";", decimal=","), 'decimal: ","'),
        (text(","), "# nothing to say\n\n"),
        (UNREAD, "names: [q1_deg, q2_deg, x_mm, y_mm]"),
        (UNREAD, "names: [a, b, u, v]\ncolumns: {q1_deg: a, q2_deg: b, x_mm: u, y_mm: v}"),
        (text(",").replace("-", "\N{MINUS SIGN}"), ""),
        (text(",").encode("utf-16"), "encoding: utf-16"),
        (text(",").encode("utf-16"), ""),
        (text(";", decimal=","), ""),
        (("Messung Gelenk\n\n" + text(";", decimal=",")).replace("Gelenk", "Länge").encode("latin-1"), ""),
        (text(",", "\ufeffq1_deg,q2_deg,x_mm,y_mm"), ""),
    ],
)
def test_layouts_that_are_read(tmp_path: Path, content: str | bytes, settings: str) -> None:
    result = read(tmp_path, content, settings)
    assert result.rejected == ()
    assert result.q == pytest.approx(ANGLES, abs=1e-6)
    assert result.tip == pytest.approx(TIPS, abs=1e-7)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"PK\x03\x04\x14\x00\x06\x00", "Excel"),
        (b"\x1f\x8b\x08\x00", "gzip"),
        (text(",").encode("utf-16-le"), "utf-16"),
        (UNREAD, "names"),
        (text(",", "J1,J2,X(mm),Y(mm)"), "columns: {q1_deg: FORMULA}"),
    ],
)
def test_what_cannot_be_read_says_what_would_do(tmp_path: Path, content: str | bytes, said: str) -> None:
    with pytest.raises(InputError) as refused:
        read(tmp_path, content)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(("cell", "decimal"), [("-1.234.567,5", ","), ("-1,234,567.5", ".")])
def test_thousands(tmp_path: Path, cell: str, decimal: str) -> None:
    lines = [f"{line};{cell if k else 'far'}" for k, line in enumerate(text(";", decimal=decimal).splitlines())]
    assert read(tmp_path, "\n".join(lines), f'decimal: "{decimal}"').other["far"].tolist() == [-1234567.5] * 30


def test_a_comma_that_parts_no_thousands_is_no_number(tmp_path: Path) -> None:
    result = read(tmp_path, text(";") + "1,5;0.0;700.0;0.0\n")
    assert [item.row for item in result.rejected] == [32]
    assert "not a number" in result.rejected[0].reason


def test_a_column_that_occurs_twice_gets_a_number(tmp_path: Path) -> None:
    lines = ["a,b,x,y,x,y", *(",".join((*row[:2], "0", "0", *row[2:])) for row in BODY)]
    settings = "columns: {q1_deg: a, q2_deg: b, x_mm: x.1, y_mm: y.1}"
    assert read(tmp_path, "\n".join(lines), settings).tip == pytest.approx(TIPS, abs=1e-7)
    with pytest.raises(InputError, match="occurs twice"):
        read(tmp_path, text(",", "q1_deg,q1_deg,x_mm,y_mm"))


def test_sides_in_words(tmp_path: Path) -> None:
    words = ("+", "-", "pos", "neg", "1", "-1")
    lines = [",".join((*HEADER, "dir1", "came from")), *(
        ",".join((*row, words[k % 6], words[(k + 1) % 6])) for k, row in enumerate(BODY))]  # fmt: skip
    result = read(tmp_path, "\n".join(lines), "columns: {dir2: came from}")
    assert result.sides is not None
    assert result.sides[:, 0].tolist() == [1.0, -1.0] * 15
    assert result.sides[:, 1].tolist() == [-1.0, 1.0] * 15


def test_sides_that_are_nought_or_one_are_said(tmp_path: Path) -> None:
    lines = [",".join((*HEADER, "dir1")), *(",".join((*row, str(k % 2))) for k, row in enumerate(BODY))]
    assert any("columns: {dir1: 2*dir1 - 1}" in warning for warning in read(tmp_path, "\n".join(lines)).warnings)


def test_time_stamps_are_read_by_themselves_where_nothing_else_could_be_meant(tmp_path: Path) -> None:
    """Those of ISO 8601 are; of a day and a month in any order the format is asked for."""

    def stamped(form: str) -> str:
        return "\n".join([",".join(("time_s", *HEADER)), *(
            ",".join((form.format(k), *row)) for k, row in enumerate(BODY))])  # fmt: skip

    result = read(tmp_path, stamped("2024-05-04 10:{:02d}:00"))
    assert result.time is not None
    assert np.diff(result.time).tolist() == [60.0] * (len(BODY) - 1)
    assert any("`time_format`" in warning for warning in read(tmp_path, stamped("04/05/2024 10:{:02d}")).warnings)


def test_what_our_columns_are_made_of_is_no_further_column(tmp_path: Path) -> None:
    lines = ["a,b,u,v,w", *(",".join((*row, str(k))) for k, row in enumerate(BODY))]
    result = read(tmp_path, "\n".join(lines), "columns: {q1_deg: a, q2_deg: b, x_mm: u, y_mm: v}")
    assert list(result.other) == ["w"]


def test_angles_from_0_to_360_come_back_into_the_range(tmp_path: Path) -> None:
    q = ANGLES.copy()
    path = written(tmp_path / "r.csv", table(np.mod(q, 2.0 * math.pi), planar_tip(q, (0.4, 0.3))))
    result = read_recording(path, ARM)
    assert result.q == pytest.approx(q, abs=1e-6)
    assert sum("whole turn" in warning for warning in result.warnings) == 2
    assert result.last_moves is not None
    assert result.last_moves[1:] == pytest.approx(np.diff(q, axis=0), abs=1e-6)


def test_an_angle_that_goes_on_beyond_half_a_turn_is_left(tmp_path: Path) -> None:
    """170 to 190 deg is one journey; taken apart at 180 deg it would be two."""
    arm = Arm("lever", (Joint(),), (Link(0.2, mass=0.0),))
    q = np.radians(np.linspace(170.0, 190.0, 30))[:, None]
    path = written(tmp_path / "r.csv", table(q, planar_tip(q, (0.2,))))
    assert read_recording(path, arm).q == pytest.approx(q, abs=1e-6)


def test_a_command_a_whole_turn_away_from_its_encoder(tmp_path: Path) -> None:
    q = poses(30)
    commands = {f"c{k + 1}_deg": np.degrees(q[:, k]) + 360.0 * (k == 1) + 0.01 for k in range(3)}
    result = read_recording(written(tmp_path / "r.csv", table(q, planar_tip(q), **commands)), planar_arm())
    assert result.commanded == pytest.approx(q + math.radians(0.01), abs=1e-5)


SCARA = """
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - joint: {type: revolute}
    dh: {a: 350 mm, d: 380 mm}
    link: {rigid: true, mass: 6 kg}
  - joint: {type: revolute}
    dh: {a: 300 mm, alpha: 180 deg}
    link: {rigid: true, mass: 4 kg}
  - joint: {type: prismatic, axis: z, range: [0 mm, 200 mm]}
    link: {rigid: true, mass: 1 kg, length: 0 mm}
"""


def test_a_scara_measured_from_above(tmp_path: Path) -> None:
    """Its slide moves the tip along z alone, so a camera's x and y will do; a slide that leans needs z."""
    (tmp_path / "arm.yaml").write_text(SCARA)
    q, down = ANGLES, np.linspace(0.0, 150.0, 30)
    tip = planar_tip(q, (0.35, 0.3))
    columns = table(q, tip) | {"q3_mm": [f"{value:.4f}" for value in down]}
    result = read_recording(written(tmp_path / "r.csv", columns), read_arm(tmp_path / "arm.yaml"))
    assert result.rejected == ()
    assert result.tip.shape == (30, 2)
    (tmp_path / "arm.yaml").write_text(SCARA.replace("axis: z", "axis: [1, 0, 1]"))
    with pytest.raises(InputError, match="z: is missing"):
        read_recording(tmp_path / "r.csv", read_arm(tmp_path / "arm.yaml"))
