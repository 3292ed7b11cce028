"""The first frequency of several arms on one torso, which swing together: against mass and stiffness matrices of the
whole tree, MuJoCo's own inertia and the frame solver."""

import math

import numpy as np
import pytest
import scipy.linalg

import linkwright as lw
from linkwright.core.arm.chain.chain import Arm, Branch, Joint, Link, LoadCase
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.limits.modes import first_frequencies
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import build
from tests import frame_solver, two_arms

LOW, HIGH = np.radians(np.array(two_arms.RANGES)).T
STIFFNESS = (30e3, 20e3, 6e3, 5e3, 2e3, 7e3, 4e3)
"""N*m/rad, of all seven drives."""


@pytest.fixture
def soft(tmp_path):
    text = two_arms.arm_text()
    for stiffness in STIFFNESS:
        text = text.replace("{type: revolute,", f"{{stiffness: {stiffness} N*m/rad,", 1)
    path = tmp_path / "soft.yaml"
    path.write_text(text)
    return path


def poses(count: int, seed: int = 1):
    return np.random.default_rng(seed).uniform(LOW, HIGH, (count, len(LOW)))


def by_matrices(q) -> float:
    """The lowest frequency (Hz) of K x = omega^2 M x: point masses, M by how they move with the joints."""
    step, masses = 1e-5, np.array([mass for mass, _ in two_arms.posture(q)[1]])
    columns = []
    for row in step * np.eye(len(q)):
        ahead, behind = (np.array([place for _, place in two_arms.posture(q + s * row)[1]]) for s in (1.0, -1.0))
        columns.append((ahead - behind) / (2.0 * step))
    inertia = np.einsum("akx,k,bkx->ab", columns, masses, columns)
    return math.sqrt(scipy.linalg.eigh(np.diag(STIFFNESS), inertia, eigvals_only=True)[0]) / (2.0 * math.pi)


def test_both_arms_swing_with_the_torso(soft):
    arm = read_arm(soft)
    q = poses(20)
    result = first_frequencies(arm, beams_of(arm), (1.0, 2.0), q)
    assert result == pytest.approx([by_matrices(item) for item in q], rel=1e-7)
    # Whose tip counts does not matter; another payload does.
    assert first_frequencies(arm.on("right"), beams_of(arm), (1.0, 2.0), q) == pytest.approx(result, rel=1e-12)
    assert np.all(first_frequencies(arm, beams_of(arm), (4.0, 2.0), q) < result)


def test_the_inertia_is_that_of_mujoco(soft):
    mujoco = pytest.importorskip("mujoco")
    arm, model = read_arm(soft), mujoco.MjModel.from_xml_string(two_arms.mujoco_text())
    data, inertia = mujoco.MjData(model), np.zeros((7, 7))
    for q in poses(5, seed=3):
        data.qpos[:] = q
        mujoco.mj_forward(model, data)
        mujoco.mj_fullM(model, data, inertia)
        lowest = scipy.linalg.eigh(np.diag(STIFFNESS), inertia, eigvals_only=True)[0]
        result = first_frequencies(arm, beams_of(arm), (1.0, 2.0), q[None])[0]
        # MuJoCo's points are small balls with an inertia of their own.
        assert result == pytest.approx(math.sqrt(lowest) / (2.0 * math.pi), rel=1e-7)


def test_the_least_over_the_workspace(soft):
    result = lw.evaluate(lw.read_arm(soft)).found.frequency
    assert result.value == pytest.approx(by_matrices(np.array(result.q)), rel=1e-7)
    assert result.value <= min(by_matrices(pose) for pose in poses(500, seed=5)) * (1.0 + 1e-9)


STEEL = load_catalogue(user=False).find("steel-s355")
TUBE = build("rectangle", {"width": 0.03, "height": 0.05})


def test_elastic_links_swing_as_in_the_frame_solver():
    """The same lumps (Simpson's) on massless members: both are exact, so they agree to rounding."""
    drive = 4e4
    bent = (math.cos(0.7), math.sin(0.7), 0.0)
    joints = (Joint(), Joint(stiffness=drive), Joint(stiffness=0.5 * drive))
    links = tuple(Link(length, section=TUBE, material=STEEL) for length in (0.5, 0.4, 0.6))
    branches = (Branch("left", 1, 2, payload=LoadCase(2.0)), Branch("right", 2, 3, payload=LoadCase(3.0), away=1.0))
    arm = Arm(
        "fork", joints, links, gravity=(0.0, 0.0, -9.81), branches=branches, leave_out=frozenset({"shear_deformation"})
    )
    result = first_frequencies(arm, beams_of(arm), (2.0, 3.0), np.array([[0.0, 0.7, -1.1]]))[0]

    properties, material = TUBE.properties(STEEL.at(arm.temperature).poisson_ratio), STEEL.at(arm.temperature)
    nodes, members, masses = [np.zeros(3)], [], []

    def member(start: int, end: int) -> None:
        along = nodes[end] - nodes[start]
        members.append(
            frame_solver.Member(
                start, end, np.cross([0.0, 0.0, 1.0], along), material.elastic_modulus, material.shear_modulus,
                properties.area, properties.second_moment_y, properties.second_moment_z, properties.torsion_constant,
            )
        )  # fmt: skip

    def link(start: int, direction, length: float) -> int:
        whole = material.density * properties.area * length
        masses.append(frame_solver.PointMass(start, whole / 12.0))
        for share in (4.0, 2.0, 4.0, 1.0):
            nodes.append(nodes[start] + 0.25 * length * np.array(direction))
            member(start, len(nodes) - 1)
            start = len(nodes) - 1
            masses.append(frame_solver.PointMass(start, whole * share / 12.0))
        return start

    end = link(0, (1.0, 0.0, 0.0), 0.5)
    springs = []
    other = (math.cos(1.1), -math.sin(1.1), 0.0)
    for direction, length, stiffness, payload in ((bent, 0.4, drive, 2.0), (other, 0.6, 0.5 * drive, 3.0)):
        nodes.append(nodes[end].copy())
        springs.append(frame_solver.Spring(end, len(nodes) - 1, (0.0, 0.0, 1.0), stiffness))
        masses.append(frame_solver.PointMass(link(len(nodes) - 1, direction, length), payload))
    frame = frame_solver.Frame(nodes, members, [frame_solver.Support(0)], springs, masses=masses)
    assert result == pytest.approx(frame_solver.frequencies(frame)[0], rel=1e-6)
