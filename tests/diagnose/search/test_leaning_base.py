"""A payload off by kilograms on a base that leans: by plain sums, nothing of the product."""

from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.effects.loads.base_tilt import BASE_TILT
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import write_arm
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.sections.numeric import Array
from tests.diagnose.by_cosines import GIVES, LENGTHS, MASS, SIGMA, file, noise, poses, recording

ADDED = 4.0  # kg


def leaning_tips(q: Array, lean: float, mass: float) -> Array:
    """Tips (N, 2), m, of drives that give under a weight at the tip, plumb being `lean` (rad) off the arm's -y."""
    off = np.zeros_like(q)
    for _ in range(6):
        angles = np.cumsum(q + off, axis=1)
        sides = np.stack([np.cos(angles), np.sin(angles)]) * LENGTHS
        ahead, above = np.cumsum(sides[:, :, ::-1], axis=2)[:, :, ::-1]
        off = -GIVES * 9.81 * mass * (ahead * np.cos(lean) - above * np.sin(lean))
    angles = np.cumsum(q + off, axis=1)
    return np.stack([np.cos(angles) @ LENGTHS, np.sin(angles) @ LENGTHS], axis=1)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "lean"), [(1, 0.03), (2, 0.03), (5, 0.01)])
def test_the_base_leans_as_far_as_it_does_beside_a_payload_that_is_wrong(seed: int, lean: float) -> None:
    """Visits scatter by 0.8 of the noise. Where the tilt pulled at the file's 6 kg alone it came out as 10/6 of what it
    is. Of seed 5 a constant force at the tip says a little more than the payload by itself, since the base leans
    besides: it stood in the payload's place. Seed 2 has normal equations that numpy's driver cannot solve."""
    q = np.repeat(poses(seed, 40), 3, axis=0)
    scatter = np.repeat(np.random.default_rng(seed + 5).standard_normal((40, 2)), 3, axis=0)
    tip = leaning_tips(q, lean, MASS + ADDED) + noise(seed, len(q)) + 0.8 * SIGMA * scatter
    result = diagnose(file(), recording(q, tip))
    assert result.unknown is None
    named = {finding.effect: finding.parameters[0] for finding in result.findings}
    assert set(named) == {"payload", "base_tilt"}
    for size, true in ((named["payload"], ADDED), (named["base_tilt"], lean)):
        lower, upper = size.interval
        # Of 95 %: three standard errors.
        assert size.value == pytest.approx(true, abs=0.75 * (upper - lower))
        # With room for causes too small to be named, as beside any second finding.
        assert upper - lower < 1.5 * true


def test_a_base_that_seems_to_lean_further_than_any_does_is_at_its_bound(tmp_path: Path) -> None:
    """The tilt comes out a little beyond 0.15 rad: it is said at that, and the arm file is read again. The tool's tilt
    is first order: what weight a lean takes off the arm's own -y (1.1 %) is put back."""
    lean = BASE_TILT.parameters[2].upper + 0.5e-3
    q = np.repeat(poses(1, 40), 3, axis=0)
    tip = leaning_tips(q, float(np.arctan(lean)), MASS / float(np.cos(np.arctan(lean))))
    result = diagnose(file(), recording(q, tip + noise(1, len(q))))
    assert [finding.effect for finding in result.findings] == ["base_tilt"]
    size = result.findings[0].parameters[0]
    assert size.at_bound
    assert size.value == BASE_TILT.parameters[2].upper
    assert size.interval[0] < lean < size.interval[1]
    write_arm(result.corrected, tmp_path / "arm.yaml")
    (entry,) = read_arm(tmp_path / "arm.yaml").effects
    assert entry.parameters["about_z"] == pytest.approx(size.value, rel=1e-11)
