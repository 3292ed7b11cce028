"""Two arms on one torso, one bolted on by eye: `origin: free` in a branch, found from both tips beside one cause."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import linkwright as lw
from linkwright.core.units.quantities import InputError
from tests import two_arms

COMPLIANCE = 50e-6
TURN = math.radians(50.0)
KNOWN = "origin: {xyz: [0.0 m, 0.2 m, 0.05 m]}"
QUICK = ("payload", "link_mass", "creep", "counterbalance", "gear_transmission_error", "joint_waviness")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("free-mount")
    text = two_arms.arm_text()
    assert KNOWN in text
    (place / "arm.yaml").write_text(text.replace(KNOWN, "origin: free"))
    for seed, tip in enumerate(("left", "right")):
        made = two_arms.recorded(tip, 24, seed, compliance=COMPLIANCE, mount=two_arms.turn("z", TURN))
        (place / f"{tip}.csv").write_text(made)
        (place / f"{tip}.yaml").write_text(f"tip: {tip}\n")
    return place


@pytest.mark.slow
def test_the_mount_is_found_beside_what_gives(folder: Path) -> None:
    diagnosis = lw.diagnose(folder / "arm.yaml", [folder / "right.csv", folder / "left.csv"], without=QUICK)
    (origin,) = diagnosis.found.origins
    for parameter, truth in zip(origin.parameters, (0.0, 0.2, 0.05, 0.0, 0.0, TURN), strict=True):
        low, high = parameter.interval
        assert abs(parameter.value - truth) <= high - low, "twice the 95 % interval"
        assert 0.0 < high - low < 100e-6
    assert Rotation.from_rotvec(origin.turn).magnitude() == pytest.approx(TURN, abs=50e-6)
    (soft,) = diagnosis.found.findings
    assert (soft.effect, soft.at) == ("joint_compliance", (2,))
    assert np.isclose(soft.parameters[0].value, COMPLIANCE, rtol=0.01)
    diagnosis.save(folder / "out")
    for tip in ("left", "right"):
        assert lw.predict(folder / "out" / "arm.yaml", folder / f"{tip}.csv").rms_mm < 1.15e3 * 10e-6 * 3**0.5


def test_a_free_mount_needs_a_recording_of_its_own_tip(folder: Path) -> None:
    with pytest.raises(
        InputError, match=r"left.chain\[1\].origin: is free, and no recording is of left's tip; add a recording"
    ):
        lw.diagnose(folder / "arm.yaml", folder / "right.csv", without=QUICK)
