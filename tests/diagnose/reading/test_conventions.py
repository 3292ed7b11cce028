"""Mistakes of convention put into clean recordings: each named with its remedy, and none where there is none.

The arm in space is an elbow and a wrist of plain rotation matrices, written here and not taken from the code.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.recording import Recording
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError
from tests.costs import slow_but
from tests.diagnose.recorded import planar_arm, planar_tip, poses, table, written

Spoil = Callable[[Array, Array], tuple[Array, Array]]

ARM = """
gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]
chain:
  - {joint: {type: revolute, axis: z}, link: {length: 400 mm, direction: [0, 0, 1], rigid: true, mass: 1 kg}}
  - {joint: {type: revolute, axis: y}, link: {length: 500 mm, rigid: true, mass: 1 kg}}
  - {joint: {type: revolute, axis: y}, link: {length: 450 mm, rigid: true, mass: 1 kg}}
  - {joint: {type: revolute, axis: x}, link: {length: 100 mm, rigid: true, mass: 1 kg}}
  - {joint: {type: revolute, axis: y}, link: {length: 80 mm, rigid: true, mass: 1 kg}}
tool: {xyz: [20 mm, 0 mm, 90 mm]}
"""
LINKS = ((0.0, 0.0, 0.4), (0.5, 0.0, 0.0), (0.45, 0.0, 0.0), (0.1, 0.0, 0.0), (0.1, 0.0, 0.09))


def space_tip(q: Array) -> Array:
    """Tips (N, 3), m: each link after the rotations of the joints up to it."""
    turn, tip = Rotation.identity(len(q)), np.zeros((len(q), 3))
    for k, (axis, link) in enumerate(zip("zyyxy", LINKS, strict=True)):
        turn = turn * Rotation.from_euler(axis, q[:, k : k + 1])
        tip = tip + turn.apply(link)
    return tip


def clean(seed: int = 5, count: int = 60) -> tuple[Array, Array]:
    """Joint angles and tips with 50 um of noise and half a milliradian of physics that nobody modelled."""
    q = poses(count, seed, joints=5)
    noise = np.random.default_rng(seed + 1).normal(0.0, 5e-5, (count, 3))
    return q, space_tip(q + 5e-4 * np.cos(q)) + noise


def read(folder: Path, q: Array, tip: Array, settings: str = "frame: known\n") -> Recording:
    (folder / "arm.yaml").write_text(ARM)
    (folder / "recording.yaml").write_text(settings)
    return read_recording(written(folder / "r.csv", table(q, tip)), read_arm(folder / "arm.yaml"))


def free(tip: Array) -> Array:
    """The same points seen from a tripod."""
    return Rotation.from_euler("xyz", [0.1, -0.2, 2.0]).apply(tip - [2.0, 1.0, 0.3])


def times(*factors: float) -> Spoil:
    return lambda q, tip: (q * factors, tip)


def plus(*angles: float) -> Spoil:
    return lambda q, tip: (q + np.radians(angles), tip)


def on_tip(change: Callable[[Array], Array]) -> Spoil:
    return lambda q, tip: (q, change(tip))


def on_joints(change: Callable[[Array], Array]) -> Spoil:
    return lambda q, tip: (change(q), tip)


SPOILT: list[tuple[Spoil, str, str]] = [
    (times(1, 1, -1, 1, 1), "q3_deg counts the other way", "columns: {q3_deg: -q3_deg}"),
    (times(1, -1, -1, 1, 1), "q2_deg, q3_deg count the other way", "columns: {q2_deg: -q2_deg, q3_deg: -q3_deg}"),
    (plus(0, 0, 90, 0, 0), "q3_deg counts from another zero, -90 deg away", "columns: {q3_deg: q3_deg - 90}"),
    (plus(0, 90, -90, 0, 0), "q2_deg counts from another zero, -90 deg away and q3_deg", "q3_deg: q3_deg + 90}"),
    (
        on_joints(lambda q: np.stack([q[:, 0], q[:, 1], q[:, 1] + q[:, 2], q[:, 3], q[:, 4]], axis=1)),
        "q3_deg holds q2_deg as well",
        "columns: {q3_deg: q3_deg - q2_deg}",
    ),
    (
        on_joints(lambda q: q[:, [0, 2, 1, 3, 4]]),
        "q2_deg and q3_deg have changed places",
        "columns: {q2_deg: q3_deg, q3_deg: q2_deg}",
    ),
    (on_tip(lambda tip: np.roll(tip, 2, axis=0)), "the tips stand 2 rows later", "than the joints that they belong to"),
    (
        on_tip(lambda tip: np.roll(tip, -1, axis=0)),
        "the tips stand 1 row earlier",
        "than the joints that they belong to",
    ),
    (on_tip(lambda tip: tip[::-1]), "the tips stand in the opposite order", ""),
]


@pytest.mark.parametrize(("spoil", "said", "remedy"), SPOILT)
@pytest.mark.parametrize("frame", ["known", "free"])
def test_a_mistake_is_named_with_its_remedy(tmp_path: Path, spoil: Spoil, said: str, remedy: str, frame: str) -> None:
    q, tip = spoil(*clean())
    if frame == "free" and "q2_deg, q3_deg count" in said:
        said, remedy = "count the other way", ""  # this arm turned over as a whole, joints 1 and 5, does as well
    settings = f"frame: {frame}\ntool: {frame}\n"
    with pytest.raises(InputError) as refused:
        read(tmp_path, q, free(tip) if frame == "free" else tip, settings)
    assert said in str(refused.value)
    assert remedy in str(refused.value)


@pytest.mark.parametrize(("spoil", "said", "remedy"), SPOILT[:6])
def test_the_remedy_mends_it(tmp_path: Path, spoil: Spoil, said: str, remedy: str) -> None:
    """What the message says to write, written, leaves the recording as it was."""
    del said
    true, tip = clean()
    q, _ = spoil(true, tip)
    if "columns" in remedy:
        result = read(tmp_path, q, tip, remedy)
        assert result.q == pytest.approx(true, abs=1e-6)
        assert result.rejected == ()


def test_axes_that_changed_places(tmp_path: Path) -> None:
    q, tip = clean()
    with pytest.raises(InputError, match=r"left-handed.*columns: \{x_mm: y_mm, y_mm: x_mm\}"):
        read(tmp_path, q, tip[:, [1, 0, 2]])
    with pytest.raises(InputError, match=r"left-handed.*columns: \{y_mm: -y_mm\}"):
        read(tmp_path, q, tip * [1.0, -1.0, 1.0])
    with pytest.raises(InputError, match="left-handed"):
        read(tmp_path, q, free(tip * [1.0, -1.0, 1.0]), "frame: free\ntool: free\n")


ROWS = ((0, 160, 90, 0), (-425, 0, 0, 30), (-392, 0, 0, 0), (0, 109, 90, 0), (0, 95, -90, -90), (0, 82, 0, 0))
"""a and d (mm), alpha and theta (deg)."""


@pytest.mark.parametrize("meant", ["standard", "modified"])
@pytest.mark.parametrize("frame", ["known", "free"])
def test_rows_of_dh_in_the_other_convention(tmp_path: Path, meant: str, frame: str) -> None:
    """Tips by the four motions of each row, about and along z and x, in the order of the convention that is meant."""
    q = poses(60, 3, joints=6)
    turn, tip = Rotation.identity(len(q)), np.zeros((len(q), 3))
    for k, (a, d, alpha, theta) in enumerate(ROWS):
        about_x, along_x = Rotation.from_euler("x", alpha, degrees=True), np.array([1e-3 * a, 0.0, 0.0])
        about_z, along_z = (
            Rotation.from_euler("z", q[:, k : k + 1] + math.radians(theta)),
            np.array([0.0, 0.0, 1e-3 * d]),
        )
        steps = [(about_z, along_z), (about_x, along_x)]
        for about, along in steps if meant == "standard" else reversed(steps):
            turn, tip = turn * about, tip + turn.apply(along)
    said = {"standard": "modified", "modified": "standard"}[meant]
    rows = [
        f"  - {{joint: {{}}, dh: {{a: {a} mm, d: {d} mm, alpha: {alpha} deg, theta: {theta} deg, convention: {{}}}}}}\n"
        for a, d, alpha, theta in ROWS
    ]
    (tmp_path / "recording.yaml").write_text(f"frame: {frame}\ntool: {frame}\n")
    path = written(tmp_path / "r.csv", table(q, free(tip) if frame == "free" else tip))
    for convention in (said, meant):
        arm = tmp_path / f"{convention}.yaml"
        arm.write_text("chain:\n" + "".join(row.replace("convention: {}", f"convention: {convention}") for row in rows))
    with pytest.raises(InputError, match=f"the arm file's dh are meant with `convention: {meant}` in each"):
        read_recording(path, read_arm(tmp_path / f"{said}.yaml"))
    assert read_recording(path, read_arm(tmp_path / f"{meant}.yaml")).rejected == ()


def test_tips_in_any_other_order(tmp_path: Path) -> None:
    q, tip = clean()
    order = np.random.default_rng(1).permutation(len(q))
    with pytest.raises(InputError, match="stand in another order than the joints"):
        read(tmp_path, q, tip[order])


def test_a_zero_at_an_odd_angle(tmp_path: Path) -> None:
    q, tip = clean()
    q[:, 2] += math.radians(37.0)
    with pytest.raises(InputError, match=r"q3_deg counts from another zero, -3[67]\.\d+ deg away"):
        read(tmp_path, q, tip)


@pytest.mark.parametrize("degree", slow_but([0.0, 1.0], 1.0))
def test_another_zero_of_the_last_joint_is_no_longer_tool(tmp_path: Path, degree: float) -> None:
    """In the plane a tool of 424 mm would do as well as a quarter turn of the last link; one that was forgotten is told
    as a tool, be it a little longer than the link or shorter."""
    q = poses(60)
    (tmp_path / "recording.yaml").write_text("frame: known\n")
    path = written(tmp_path / "r.csv", table(q + np.radians([0.0, 0.0, 90.0 + degree]), planar_tip(q)))
    with pytest.raises(InputError, match=r"q3_deg counts from another zero, -90 deg away.*q3_deg: q3_deg - 90"):
        read_recording(path, planar_arm())
    for further in (0.2, 0.35):
        path = written(tmp_path / "r.csv", table(q, planar_tip(q, (0.4, 0.42, 0.3 + further))))
        with pytest.raises(InputError, match="does not hold the arm file's tip"):
            read_recording(path, planar_arm())


def test_what_belongs_to_another_arm_is_refused(tmp_path: Path) -> None:
    q = poses(60)
    anywhere = np.random.default_rng(2).uniform(-1.0, 1.0, (len(q), 2))
    (tmp_path / "recording.yaml").write_text("frame: known\n")
    with pytest.raises(InputError, match="belong together"):
        read_recording(written(tmp_path / "r.csv", table(q, anywhere)), planar_arm())


@pytest.mark.slow
def test_what_belongs_to_another_arm_in_space_is_refused(tmp_path: Path) -> None:
    q, _ = clean()
    anywhere = np.random.default_rng(2).uniform(-1.0, 1.0, (len(q), 3))
    with pytest.raises(InputError, match="belong together"):
        read(tmp_path, q, anywhere)


@pytest.mark.parametrize("seed", slow_but(range(6), 1))
@pytest.mark.parametrize("frame", ["known", "free"])
def test_physics_is_no_mistake_of_convention(tmp_path: Path, seed: int, frame: str) -> None:
    """Errors up to 20 mrad a joint, far beyond any drive's, and readings on the move that lag by a row."""
    q, _ = clean(seed)
    error = np.random.default_rng(seed).normal(0.0, 0.01, 5) * np.array([np.cos(q[:, k]) for k in range(5)]).T
    tip = space_tip(q + error)
    result = read(tmp_path, q, free(tip) if frame == "free" else tip, f"frame: {frame}\ntool: {frame}\n")
    assert result.size == len(q)
    slow = np.linspace(0.0, 1.0, len(q) + 1)[:, None] * np.array([0.5, 0.3, -0.4, 0.2, 0.6])
    assert read(tmp_path, slow[1:], space_tip(slow[:-1])).size == len(q)


def test_a_few_poses_say_nothing_of_conventions(tmp_path: Path) -> None:
    """Frame, tool and a wrong sign together fit five poses by chance; they are refused as what they are."""
    q = np.repeat(clean()[0][:5], 6, axis=0)
    with pytest.raises(InputError) as refused:
        read(tmp_path, q * [1, 1, -1, 1, 1], space_tip(q))
    assert "other way" not in str(refused.value)


@pytest.mark.parametrize("absolute", [False, True])
def test_angles_against_the_base_in_the_plane(tmp_path: Path, absolute: bool) -> None:
    q = poses(40)
    tip = planar_tip(q)
    logged = np.cumsum(q, axis=1) if absolute else q
    (tmp_path / "recording.yaml").write_text("frame: known\n")
    path = written(tmp_path / "r.csv", table(logged, tip))
    if not absolute:
        assert read_recording(path, planar_arm()).rejected == ()
        return
    with pytest.raises(InputError, match=r"holds q\d_deg as well"):
        read_recording(path, planar_arm())


def test_numbers_that_no_unit_explains(tmp_path: Path) -> None:
    q, tip = clean()
    with pytest.raises(InputError, match=r"columns: \{x_mm: x_mm/25.4, y_mm: y_mm/25.4, z_mm: z_mm/25.4\}"):
        read(tmp_path, q, 25.4 * tip)


def test_no_row_of_a_stuck_encoder_is_kept(tmp_path: Path) -> None:
    """Not even where the joint happened to stand near where its encoder stuck."""
    q, tip = clean(count=80)
    stuck = q.copy()
    stuck[40:, 4] = stuck[39, 4]
    result = read(tmp_path, stuck, tip)
    assert {item.row for item in result.rejected} >= set(range(43, 81))
    assert {item.row for item in result.rejected} <= set(range(42, 82))


@pytest.mark.parametrize("settings", ["frame: free\n", "frame: free\ntool: free\n", "tool: free\n"])
def test_no_unit_shrinks_a_motion_to_nothing(tmp_path: Path, settings: str) -> None:
    """Joints that all but stand still while the tip moves by a metre: um in place of mm would bring every tip to one
    point."""
    q, tip = clean()
    with pytest.raises(InputError, match="no other unit, frame, tool, zero, sign or order that was tried explains it"):
        read(tmp_path, 0.3 + 1e-5 * q, tip, settings)
