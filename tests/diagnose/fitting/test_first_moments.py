"""A lump on a link is told by its first moment about the link's joint, by the textbook's torques of a planar arm."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.judge.predict import predict
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.steps.diagnosis import diagnose
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.output.diagnosis_folder import with_written
from tests.diagnose.arm_of_drives import COMPLIANCE, SIGMA, arm_of_drives, read
from tests.diagnose.recorded import LENGTHS, planar_tip

ARM = replace(arm_of_drives(), gravity=(0.0, -9.81, 0.0))
MASS = 2.0


def recorded(seed: int, link: int, at: float) -> Recording:
    """A lump of 2 kg, `at` m along a link (from 0): each drive below turns by its compliance times weight and lever."""
    rng = np.random.default_rng(seed)
    q = np.repeat(rng.uniform(-1.5, 1.5, (40, 3)), 2, axis=0)
    turned = np.zeros_like(q)
    for _ in range(40):
        across = np.cos(np.cumsum(q + turned, axis=1))
        joints = np.cumsum(np.column_stack([np.zeros(len(q)), across * LENGTHS]), axis=1)[:, :3]
        lever = (joints[:, link] + across[:, link] * at)[:, None] - joints
        lever[:, link + 1 :] = 0.0
        turned = -9.81 * MASS * lever * COMPLIANCE
    return read(q, planar_tip(q + turned) - planar_tip(q), rng)


@pytest.mark.parametrize(
    ("link", "share"),
    [pytest.param(0, 0.25, marks=pytest.mark.slow), (1, 0.25), (1, 0.9), pytest.param(2, 0.25, marks=pytest.mark.slow)],
)
def test_a_lump_is_told_by_its_first_moment(link: int, share: float) -> None:
    at = share * LENGTHS[link]
    result = with_written(diagnose(ARM, recorded(3, link, at)), load_catalogue(user=False))
    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("link_mass", (link + 1,))
    sizes = {parameter.parameter: parameter for parameter in finding.parameters}
    # Nothing carries joint 1: of a lump on link 1 no drive tells the mass by itself.
    assert set(sizes) == ({"first_moment"} if link == 0 else {"first_moment", "mass"})
    assert sizes["first_moment"].kind == "first_moment"
    for name, truth in (("first_moment", MASS * at), ("mass", MASS)):
        if name in sizes:
            low, high = sizes[name].interval
            assert low < truth < high
            assert high - low < 0.1 * MASS * (LENGTHS[link] if name == "first_moment" else 2.0)
    assert "first moment" in finding.reading
    (entry,) = result.corrected.effects
    assert entry.parameters["first_moment"] == pytest.approx(sizes["first_moment"].value)
    assert ("mass" in entry.parameters) == (link > 0)
    assert result.written is not None
    assert result.written.keeps(0.02)
    assert predict(result.corrected, recorded(4, link, at)).rms < 1.15 * math.sqrt(2.0) * SIGMA


def test_where_only_the_link_itself_bends_a_mass_spread_along_it_is_told(tmp_path: Path) -> None:
    """Of a cantilever under a uniform load, a force and a moment at its end. Nothing below gives: no place shows."""
    file, rigid = tmp_path / "arm.yaml", "  - joint: {range: [-2 rad, 2 rad]}\n    link: "
    bar = "{elastic_modulus: 70 GPa, poisson_ratio: 0.3, density: 2700 kg/m^3}"
    text = f"{rigid}{{length: 400 mm, section: {{shape: circle, diameter: 20 mm}}, material: {bar}}}\n" + "".join(
        f"{rigid}{{length: {length} mm, rigid: true, mass: 0 kg}}\n" for length in (420, 300)
    )
    file.write_text(f"gravity: [0 m/s^2, -9.81 m/s^2]\nchain:\n{text}", encoding="utf-8")
    rng, length = np.random.default_rng(5), LENGTHS[0]
    q = np.repeat(rng.uniform(-1.5, 1.5, (40, 3)), 2, axis=0)
    payload = np.repeat(rng.choice([0.0, 1.0], 40), 2)
    weight, stiffness = MASS + 2700.0 * math.pi * 0.01**2 * length, 70e9 * math.pi * 0.02**4 / 64.0
    along, across = np.cos(q[:, 0]), np.column_stack([-np.sin(q[:, 0]), np.cos(q[:, 0])])
    moment = payload * (planar_tip(q)[:, 0] - length * along)
    sunk = weight * along * length**3 / 8.0 + payload * along * length**3 / 3.0 + moment * length**2 / 2.0
    turned = weight * along * length**2 / 6.0 + payload * along * length**2 / 2.0 + moment * length
    carried = q - 9.81 / stiffness * np.column_stack([np.zeros(len(q)), turned, np.zeros(len(q))])
    moved = planar_tip(carried) - planar_tip(q) - 9.81 / stiffness * sunk[:, None] * across
    result = diagnose(read_arm(file), read(q, moved, rng, payload_mass=payload))
    (finding,) = result.findings
    assert (finding.effect, finding.at) == ("link_mass", (1,))
    (mass,) = finding.parameters
    assert mass.parameter == "mass"
    assert mass.value == pytest.approx(MASS, rel=0.05)


def test_a_file_may_give_a_first_moment_in_place_of_a_mass(tmp_path: Path) -> None:
    """At 250 mm of 500: 2 kg spread along the link, or the same by its first moment; by both a lump at the joint."""

    def largest(entry: str) -> float:
        file = tmp_path / "arm.yaml"
        parts = "".join(
            f"  - joint: {{stiffness: {stiffness} kN*m/rad, range: [0 deg, 0 deg]}}\n"
            f"    link: {{length: {length} mm, rigid: true, mass: 0 kg}}\n"
            for stiffness, length in ((100, 500), (50, 400))
        )
        text = f"gravity: [0 m/s^2, -9.81 m/s^2]\nchain:\n{parts}effects: [{{effect: link_mass, at: 2, {entry}}}]\n"
        file.write_text(text, encoding="utf-8")
        return evaluate(read_arm(file)).worst.error

    def by_hand(mass: float, moment: float) -> float:
        return 9.81 * ((mass * 0.5 + moment) / 1e5 * 0.9 + moment / 5e4 * 0.4)

    assert largest("mass: 2 kg") == pytest.approx(by_hand(2.0, 0.4), rel=1e-6)
    assert largest("first_moment: 0.4 kg*m") == pytest.approx(by_hand(2.0, 0.4), rel=1e-6)
    assert largest("mass: 2 kg, first_moment: 0.1 kg*m") == pytest.approx(by_hand(2.0, 0.1), rel=1e-6)
    assert largest("mass: 2 kg, off_centre: -0.4 kg*m") == pytest.approx(by_hand(2.0, 0.0), rel=1e-6)
