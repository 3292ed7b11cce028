"""The side from which each joint came, told from the order of the rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linkwright.core.arm.chain.chain import Arm, Joint, Link
from linkwright.core.diagnose.reading.assemble import sides_from_order
from linkwright.core.diagnose.reading.read import read_recording
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.units.quantities import InputError
from tests.diagnose.recorded import planar_arm, planar_tip, poses, table, written

TURN_AND_SLIDE = Arm(
    "crane", (Joint(), Joint("prismatic", (1.0, 0.0, 0.0), (0.0, 1.0))), (Link(0.2, mass=0.0), Link(0.2, mass=0.0))
)


def test_a_joint_keeps_the_side_of_its_last_move() -> None:
    q = np.array([[0.0, 0.5], [0.1, 0.5], [0.1, 0.3], [0.1, 0.3], [0.05, 0.4]])
    assert sides_from_order(q, TURN_AND_SLIDE).tolist() == [[0, 0], [1, 0], [1, -1], [1, -1], [-1, 1]]


def test_what_a_servo_comes_back_to_within_is_no_move() -> None:
    # As an angle a slide's is nothing; as a length an angle's is ten times what a slide comes back to within.
    angle, length = RULES.residual.same_pose
    assert length < angle
    between = (angle + length) / 2
    q = np.array([[0.0, 0.5], [0.2, 0.4], [0.2 - between, 0.4 + between], [0.2 - 3 * angle, 0.4]])
    assert sides_from_order(q, TURN_AND_SLIDE).tolist() == [[0, 0], [1, -1], [1, 1], [-1, -1]]


@given(st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=1, max_size=30))
def test_sides_are_the_signs_of_the_last_steps(steps: list[tuple[int, int]]) -> None:
    q = 0.01 * np.cumsum(np.array(steps, dtype=float), axis=0)
    sides = sides_from_order(q, TURN_AND_SLIDE)
    for joint in range(2):
        last = 0
        for row, step in enumerate(steps):
            if row and step[joint]:
                last = 1 if step[joint] > 0 else -1
            assert sides[row, joint] == last
    assert np.array_equal(sides_from_order(-q, TURN_AND_SLIDE), -sides)


def _read_sides(folder: Path, setting: str, **further: np.ndarray) -> tuple[np.ndarray, np.ndarray | None]:
    q = poses(20)
    path = written(folder / "r.csv", table(q, planar_tip(q), **further))
    (folder / "r.yaml").write_text(setting, encoding="utf-8")
    return q, read_recording(path, planar_arm()).sides


def test_asked_for_in_the_mapping(tmp_path: Path) -> None:
    q, sides = _read_sides(tmp_path, "sides: from_order\n")
    assert sides is not None
    assert sides[0].tolist() == [0, 0, 0]
    assert np.array_equal(sides[1:], np.sign(np.diff(q, axis=0)))


def test_not_told_where_not_asked_for(tmp_path: Path) -> None:
    assert _read_sides(tmp_path, "sides: columns\n")[1] is None


def test_columns_come_first(tmp_path: Path) -> None:
    recorded = {f"dir{k}": np.where(np.arange(20) % 2, 1.0, -1.0) for k in (1, 2, 3)}
    _, sides = _read_sides(tmp_path, "sides: from_order\n", **recorded)
    assert sides is not None
    assert np.array_equal(sides, np.column_stack(list(recorded.values())))


def test_another_word_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="sides"):
        _read_sides(tmp_path, "sides: somehow\n")
