"""A link whose row gives both a and d has two lengths: each moves the tip as a change of that number in the file does,
by chains of plain matrices (modified rows: J. J. Craig, Introduction to Robotics, ch. 3)."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.descriptions.exported import identified_geometry
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.files.origin import key_of_offset
from tests.arm.effects.effect_states import Posed, conditions, moved
from tests.arm.rows.matrices import QUARTER, arm_of, tip_by_matrices

ROWS = [(0.07, 0.29, -QUARTER, 0.4), (0.43, 0.15, 0.0, -0.2), (-0.02, 0.11, QUARTER, 0.0), (0.09, 0.43, -QUARTER, 0.0)]


def numbers_of(arm):
    """(link from 0, axis, row from 0, number of the row, factor) of each offset that a row's number says."""
    for index, link in enumerate(arm.links):
        for axis in link.given_by:
            key = key_of_offset(arm, index, axis) if axis != "length" else None
            if key is not None:
                row, _, name = key[0].removeprefix("chain[").partition("].dh.")
                yield index, axis, int(row) - 1, "ad".index(name), key[1]


@pytest.mark.parametrize("modified", [False, True])
def test_each_number_of_a_row_moves_the_tip_as_the_file_would(modified, tmp_path):
    arm = arm_of(ROWS, tmp_path, modified=modified)
    q = np.random.default_rng(3).uniform(-2.0, 2.0, (12, 4))
    state = Posed(arm, beams_of(arm), q, conditions(4, seed=1)).state
    asked = list(numbers_of(arm))
    assert {(row, number) for *_, row, number, _ in asked} >= {(1, 0), (1, 1), (2, 0), (2, 1)}
    for index, axis, row, number, factor in asked:
        more, less = np.array(ROWS), np.array(ROWS)
        more[row, number] += 1e-3 * factor
        less[row, number] -= 1e-3 * factor
        ends = [[tip_by_matrices(rows, angles, modified=modified) for angles in q] for rows in (more, less)]
        assert moved(state, "link_length", {axis: 1.0}, (index,)) == pytest.approx(
            (np.array(ends[0]) - np.array(ends[1])) / 2e-3, abs=1e-12
        )


@pytest.mark.parametrize("modified", [False, True])
def test_what_is_found_of_a_row_goes_into_other_formats_as_that_number(modified, tmp_path):
    arm = arm_of(ROWS, tmp_path, modified=modified)
    q = (0.3, -0.8, 1.1, 0.4)
    for index, axis, row, number, factor in numbers_of(arm):
        rows = np.array(ROWS)
        rows[row, number] += 2e-3 * factor
        entry = EffectEntry("link_length", (index + 1,), MappingProxyType({axis: 2e-3}))
        found = identified_geometry(replace(arm, effects=(entry,)))
        assert np.ravel(tip_position(found, q)) == pytest.approx(tip_by_matrices(rows, q, modified=modified), abs=1e-12)


def test_a_straight_link_has_one_length(tmp_path):
    (straight,) = {
        link.given_by for link in arm_of([(0.4, 0.0, 0.0, 0.0), (0.0, 0.3, 0.1, 0.0)], tmp_path, modified=False).links
    }
    assert straight == ("length",)
