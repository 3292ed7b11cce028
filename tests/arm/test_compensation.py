"""Tables of corrections for arms of which not every joint can be moved, against the moments of their weights."""

import math

import numpy as np
import pytest

import linkwright as lw

G = 9.81
LENGTHS, MASSES, LOAD = (0.5, 0.4, 0.2), (8.0, 4.0, 2.0), 3.0
ARM = """
gravity: [0 m/s^2, -9.81 m/s^2, 0 m/s^2]
chain:
  - joint: {axis: z, range: [10 deg, 80 deg], stiffness: 20 kN*m/rad}
    link: {length: 500 mm, rigid: true, mass: 8 kg}
  - joint: {axis: z, MIDDLE}
    link: {length: 400 mm, rigid: true, mass: 4 kg}
  - joint: {axis: z, range: [20 deg, 60 deg], stiffness: 5 kN*m/rad}
    link: {length: 200 mm, rigid: true, mass: 2 kg}
payload: {mass: 3 kg}
"""


def sagged(asked):
    """The tip in equilibrium: each drive turns by the moment of all beyond it."""
    given = np.array(asked, dtype=float)
    for _ in range(60):
        ends = np.cumsum([length * np.exp(1j * angle) for length, angle in zip(LENGTHS, np.cumsum(given), strict=True)])
        starts = np.array([0.0, *ends[:-1]])
        weights = [(mass, 0.5 * (a + b)) for mass, a, b in zip(MASSES, starts, ends, strict=True)]
        moments = [
            -G * (sum(m * (x - starts[k]).real for m, x in weights[k:]) + LOAD * (ends[-1] - starts[k]).real)
            for k in range(3)
        ]
        given = np.array(asked) + np.array([moments[0] / 20e3, 0.0, moments[2] / 5e3])
    return ends[-1]


@pytest.mark.parametrize("middle", ["range: [-60 deg, 20 deg], passive: true", "range: [-20 deg, -20 deg]"])
def test_what_nothing_drives_is_not_asked_to_move(tmp_path, middle):
    """A passive joint and one that is held at a single angle are left where they are; the others bring the tip back."""
    path = tmp_path / "arm.yaml"
    path.write_text(ARM.replace("MIDDLE", middle))
    result = lw.compensate(path, grid=4)
    table = result.table
    assert not table["dq2_deg"].any()
    assert len(table) == (64 if "passive" in middle else 16)
    for _, row in table.iterrows():
        asked = [math.radians(row[f"q{k}_deg"] + row[f"dq{k}_deg"]) for k in (1, 2, 3)]
        stood = np.cumsum([math.radians(row[f"q{k}_deg"]) for k in (1, 2, 3)])
        goal = sum(length * np.exp(1j * angle) for length, angle in zip(LENGTHS, stood, strict=True))
        # To first order in the arm's own sag of 5 mm.
        assert abs(sagged(asked) - goal) < 0.03e-3
        assert row["left_mm"] < 0.01
