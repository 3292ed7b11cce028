"""Flanges, links by a 6 x 6 stiffness, and drives rated at the joint: against beams, and statics by hand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.at_pose import errors_at
from linkwright.core.arm.evaluation import evaluate
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.files.write import arm_to_yaml
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import InputError

G = 9.81
E, NU, RHO, D, T = 70e9, 0.3, 2700.0, 0.06, 0.004
MATERIAL = "{name: metal, elastic_modulus: 70 GPa, poisson_ratio: 0.3, density: 2700 kg/m^3}"
TUBE = f"section: {{shape: tube, diameter: 60 mm, thickness: 4 mm}}, material: {MATERIAL}"


def arm_of(folder: Path, text: str) -> Arm:
    (folder / "arm.yaml").write_text(text, encoding="utf-8")
    return read_arm(folder / "arm.yaml")


def beam_stiffness(arm: Arm, link: int) -> Array:
    """The 6 x 6 stiffness (N, mm, rad) of a beam's far end: Timoshenko's, by its closed-form flexibility."""
    section, length = arm.links[link].section, arm.links[link].length
    assert section is not None
    properties = section.properties(NU)
    shear = E / (2.0 * (1.0 + NU))
    give = np.zeros((6, 6))
    give[0, 0] = length / (E * properties.area)
    give[3, 3] = length / (shear * properties.torsion_constant)
    for across, about, sign, inertia, area in (
        (1, 5, 1.0, properties.second_moment_z, properties.shear_area_y),
        (2, 4, -1.0, properties.second_moment_y, properties.shear_area_z),
    ):
        give[across, across] = length**3 / (3.0 * E * inertia) + length / (shear * area)
        give[about, about] = length / (E * inertia)
        give[across, about] = give[about, across] = sign * length**2 / (2.0 * E * inertia)
    metres = np.array([1e3] * 3 + [1.0] * 3)
    return np.asarray(np.linalg.inv(metres[:, None] * give / np.array([1.0] * 3 + [1e3] * 3)[None, :]), dtype=float)


def as_csv(path: Path, matrix: Array) -> None:
    names = ["fx", "fy", "fz", "mx", "my", "mz"]
    rows = [",".join([name, *(repr(float(value)) for value in row)]) for name, row in zip(names, matrix, strict=True)]
    path.write_text("\n".join([",".join(["", *names]), *rows]), encoding="utf-8")


CHAINS = {
    "planar": ("", "", "-60 deg, 60 deg"),
    "spatial": (", axis: y", "end_rotation: [30 deg, 20 deg, 70 deg], ", "-50 deg, 70 deg"),
}


@pytest.mark.parametrize("kind", CHAINS)
def test_a_beam_by_its_own_matrix_errs_as_the_beam(kind: str, tmp_path: Path) -> None:
    axis, turned, span = CHAINS[kind]
    chain = "".join(
        f"  - joint: {{range: [{span}]{axis}, stiffness: 40 kN*m/rad, mass: 1 kg}}\n"
        f"    link: {{length: {length} mm, {turned}%s}}\n"
        for length in (500, 400)
    )
    rest = "payload: {mass: 3 kg, force: [20 N, 5 N, %s N], moment: [0 N*m, 0 N*m, 7 N*m]}\n" % (0 if not axis else 30)
    beam = arm_of(tmp_path, f"chain:\n{chain % (TUBE, TUBE)}{rest}")
    texts: list[str] = []
    for link in (0, 1):
        as_csv(tmp_path / f"housing-{link}.csv", beam_stiffness(beam, link))
        section = beam.links[link].section
        assert section is not None
        mass = RHO * float(section.properties(NU).area) * beam.links[link].length
        texts.append(f"stiffness: housing-{link}.csv, mass: {mass!r} kg")
    given = arm_of(tmp_path, f"chain:\n{chain % tuple(texts)}{rest}")
    one, other = (evaluate(arm, pose=(0.3, -0.7)) for arm in (beam, given))
    assert other.max_error == pytest.approx(one.max_error, rel=1e-9)
    assert other.mass == pytest.approx(one.mass, rel=1e-12)
    poses = np.array([one.worst.poses[0].q, (0.3, -0.7)])
    for here, there in zip(*(errors_at(arm, (arm.payload,), poses) for arm in (beam, given)), strict=True):
        assert np.allclose(there.vector, here.vector, rtol=1e-9, atol=1e-12)
        assert np.allclose(there.rotation, here.rotation, rtol=1e-9, atol=1e-12)
    assert np.allclose(other.compliance.matrix, one.compliance.matrix, rtol=1e-9, atol=1e-15)
    assert one.frequency is not None
    assert other.frequency is not None
    # The mass counts at the ends: no faster than it is, and little slower where the payload is most of it.
    assert 0.9 * one.frequency.value < other.frequency.value <= one.frequency.value
    again = read_again(tmp_path, given)
    assert evaluate(again).max_error == pytest.approx(other.max_error, rel=1e-9)


def read_again(folder: Path, arm: Arm) -> Arm:
    (folder / "again.yaml").write_text(arm_to_yaml(arm), encoding="utf-8")
    return read_arm(folder / "again.yaml")


def test_a_weight_off_the_middle_bends_as_one_spread_about_it(tmp_path: Path) -> None:
    """A mass on the outer half of a cantilever: P = w L/2 from L/2 to L (unit load theorem, by quadrature)."""
    length, mass = 0.5, 2.0
    beam = arm_of(tmp_path, f"chain:\n  - joint: {{range: [0 deg, 0 deg]}}\n    link: {{length: 500 mm, {TUBE}}}\n")
    as_csv(tmp_path / "k.csv", beam_stiffness(beam, 0))
    text = "stiffness: k.csv, mass: 2 kg, center_of_mass: 375 mm"
    given = arm_of(tmp_path, f"chain:\n  - joint: {{range: [0 deg, 0 deg]}}\n    link: {{length: 500 mm, {text}}}\n")
    section = beam.links[0].section
    assert section is not None
    properties = section.properties(NU)
    points, weights = np.polynomial.legendre.leggauss(20)
    at = 0.5 * length + 0.25 * length * (points + 1.0)
    bent = at**2 * (3.0 * length - at) / (6.0 * E * float(properties.second_moment_y))
    sheared = at / (E / (2.0 * (1.0 + NU)) * float(properties.shear_area_z))
    bending, shear = (float(0.5 * weights @ item) * mass * G for item in (bent, sheared))
    # The matrix does not tell shear from bending under a load between the ends.
    assert evaluate(given).max_error == pytest.approx(bending + shear, rel=0.0, abs=0.1 * shear)


def test_a_flange_turns_what_follows_by_its_moment(tmp_path: Path) -> None:
    """Links rigid and weightless: m g l/K times l in tilt; in torsion where the second link stands across the first."""
    rigid = "rigid: true, mass: 0 kg"
    flange = "flange: {tilting_stiffness: 20 kN*m/rad, torsional_stiffness: 8 kN*m/rad, mass: 1 kg}"
    held = "joint: {range: [0 deg, 0 deg]}"
    tail = "payload: {mass: 4 kg}\n"
    first = f"chain:\n  - {held}\n    link: {{length: 500 mm, {rigid}, {flange}%s}}\n"
    second = f"  - {held}\n    link: {{length: 400 mm, {rigid}}}\n"
    straight = arm_of(tmp_path, first % "" + second + tail)
    assert evaluate(straight).max_error == pytest.approx(4.0 * G * 0.4**2 / 20e3, rel=1e-9)
    assert evaluate(straight).totals.carried == pytest.approx(4.0 + 1.0)
    # About y by a quarter: the second link runs along -z, across gravity and the first.
    across = arm_of(tmp_path, first % ", end_rotation: [0 deg, 90 deg, 0 deg]" + second + tail)
    assert evaluate(across).max_error == pytest.approx(4.0 * G * 0.4**2 / 8e3, rel=1e-9)
    assert read_again(tmp_path, across) == across


def test_a_flange_is_a_joint_that_gives_there(tmp_path: Path) -> None:
    """In the plane: the same error, tip stiffness and first frequency as a held joint with that stiffness."""
    drive = "stiffness: 30 kN*m/rad, range: [-40 deg, 60 deg]"
    one = f"chain:\n  - joint: {{{drive}}}\n    link: {{length: 500 mm, {TUBE}%s}}\n"
    other = f"  - joint: {{{drive}}}\n    link: {{length: 400 mm, {TUBE}}}\npayload: {{mass: 4 kg}}\n"
    flanged = evaluate(arm_of(tmp_path, one % ", flange: {tilting_stiffness: 25 kN*m/rad}" + other))
    held = "  - joint: {range: [0 deg, 0 deg], stiffness: 25 kN*m/rad}\n"
    held += "    link: {length: 0 mm, rigid: true, mass: 0 kg}\n"
    jointed = evaluate(arm_of(tmp_path, one % "" + held + other))
    assert flanged.max_error == pytest.approx(jointed.max_error, rel=1e-9)
    assert flanged.upper_bound == pytest.approx(jointed.upper_bound, rel=1e-3)
    assert flanged.worst.certified
    assert flanged.stiffness is not None
    assert jointed.stiffness is not None
    assert flanged.stiffness.value == pytest.approx(jointed.stiffness.value, rel=1e-6)
    assert flanged.frequency is not None
    assert jointed.frequency is not None
    assert flanged.frequency.value == pytest.approx(jointed.frequency.value, rel=1e-6)


STIFF = np.diag([1e5, 2e4, 2e4, 1e9, 1e9, 1e9])


def spoilt(row: int, column: int, value: float) -> Array:
    matrix = STIFF.copy()
    matrix[row, column] = value
    return matrix


@pytest.mark.parametrize(
    ("matrix", "why"),
    [
        (spoilt(1, 5, 1e6), "not symmetric: row fy, column mz is 1e.06, the other way round 0"),
        (spoilt(3, 3, -1.0), "not positive: row mx, column mx"),
        (
            STIFF + np.array([[0.0] * 6] * 1 + [[0, 0, 0, 0, 0, 5e6]] + [[0.0] * 6] * 3 + [[0, 5e6, 0, 0, 0, 0]]),
            "definite",
        ),
        (STIFF[:5], "needs 6 rows of 6 numbers"),
        (spoilt(2, 2, math.nan), "needs a number in row fz, column fz"),
    ],
)
def test_matrices_that_are_none_are_refused(matrix: Array, why: str, tmp_path: Path) -> None:
    as_csv(tmp_path / "k.csv", matrix) if len(matrix) == 6 else np.savetxt(tmp_path / "k.csv", matrix, delimiter=",")
    with pytest.raises(InputError, match=why) as error:
        arm_of(tmp_path, "chain:\n  - joint: {}\n    link: {length: 300 mm, stiffness: k.csv, mass: 2 kg}\n")
    assert "k.csv" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("link", "why"),
    [
        ("stiffness: k.csv", "link.mass.*must be known"),
        ("stiffness: k.csv, mass: unknown", "link.mass.*must be known"),
        ("stiffness: k.csv, rigid: true, mass: 1 kg", "rigid.*contradicts stiffness"),
        (f"stiffness: k.csv, {TUBE}", "stiffness.*what section and material say"),
        ("rigid: true, mass: 1 kg, flange: {tilting_stiffness: -2 N*m/rad}", "flange.tilting_stiffness.*positive"),
        ("rigid: true, mass: 1 kg, flange: {}", "flange"),
    ],
)
def test_links_that_contradict_themselves_are_refused(link: str, why: str, tmp_path: Path) -> None:
    as_csv(tmp_path / "k.csv", STIFF)
    with pytest.raises(InputError, match=why):
        arm_of(tmp_path, f"chain:\n  - joint: {{}}\n    link: {{length: 300 mm, {link}}}\n")


def test_drives_rated_at_the_joint_are_held_against_their_loads(tmp_path: Path) -> None:
    rigid = "link: {length: 500 mm, rigid: true, mass: 2 kg}"
    held = "joint: {range: [0 deg, 0 deg], %s}"
    torque = G * (4.0 * 0.5 + 2.0 * 0.25)
    arm = arm_of(
        tmp_path,
        f"chain:\n  - {held % 'rated_torque: 20 N*m, peak_torque: 50 N*m'}\n    {rigid}\npayload: {{mass: 4 kg}}\n",
    )
    whole = evaluate(arm)
    assert whole.drives is not None
    assert whole.drives.greatest_use == pytest.approx(torque / 20.0)
    assert any("joint 1 holds up to 24.5" in line and "more than the rated 20 N*m" in line for line in whole.warnings)
    assert read_again(tmp_path, arm) == arm
    peak = evaluate(
        arm_of(tmp_path, f"chain:\n  - {held % 'peak_torque: 20 N*m'}\n    {rigid}\npayload: {{mass: 4 kg}}\n")
    )
    line = "; its drive gives 20 N*m at most, so it cannot hold the arm there"
    assert any(item.startswith("joint 1 needs up to 24.5") and item.endswith(line) for item in peak.warnings)
    servo = f"{held % 'actuator: STS3215-C018'}\n    {rigid}\n"  # of which no rated torque is known; it stalls at 2.94
    for payload, stalls in ((0.0, True), (-0.5, False)):
        load = f"{servo}payload: {{mass: 0 kg, force: [0 N, {-payload * G * 2.0:g} N, 0 N]}}\n"
        still = evaluate(arm_of(tmp_path, f"chain:\n  - {load}"))
        assert any("STS3215-C018 gives 2.94 N*m at most" in line for line in still.warnings) == stalls
    with pytest.raises(InputError, match=r"peak_torque.*below rated_torque"):
        arm_of(tmp_path, f"chain:\n  - {held % 'rated_torque: 20 N*m, peak_torque: 10 N*m'}\n    {rigid}\n")
    with pytest.raises(InputError, match=r"rated_torque.*passive joint has none"):
        arm_of(tmp_path, f"chain:\n  - {held % 'passive: true, rated_torque: 20 N*m'}\n    {rigid}\n")
