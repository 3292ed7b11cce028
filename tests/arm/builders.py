"""Arms for the tests: of plain numbers, or of the random chains that the frame solver knows too."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from linkwright.core.arm.chain.beam import Beam
from linkwright.core.arm.chain.chain import Arm, Joint, Link, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.errors.tip import active_effects, carried_to_tip, rotation_at_tip
from linkwright.core.arm.files.read import read_arm
from linkwright.core.sections.numeric import Array
from tests.random_chains import RandomChain

CIRCLE = "{shape: circle, diameter: 100 mm}"
PAPER_MATERIAL = "{elastic_modulus: 71 GPa, poisson_ratio: 0.33, density: 2700 kg/m^3}"


def chain_arm(
    chain: RandomChain, *, shear: bool, leave_out: frozenset[str] = frozenset()
) -> tuple[Arm, tuple[Beam, ...], list[float]]:
    """The arm that a random chain is, its beams and its joint coordinates; its sections enter as rigidities."""
    joints = tuple(Joint(axis=link.axis, stiffness=link.joint_stiffness, mass=link.joint_mass) for link in chain.links)
    beams = tuple(
        Beam(
            length=link.length,
            mass_per_length=link.density * link.area,
            axial_rigidity=link.elastic_modulus * link.area,
            flexural_rigidity_height=link.elastic_modulus * link.second_moment_y,
            flexural_rigidity_width=link.elastic_modulus * link.second_moment_z,
            torsional_rigidity=link.shear_modulus * link.torsion_constant,
            shear_rigidity_height=link.shear_modulus * link.shear_area_height,
            shear_rigidity_width=link.shear_modulus * link.shear_area_width,
        )
        for link in chain.links
    )
    arm = Arm(
        name="random",
        joints=joints,
        links=tuple(Link(link.length) for link in chain.links),
        gravity=chain.gravity,
        payload=LoadCase(mass=chain.payload_mass, force=chain.tip_force),
        leave_out=leave_out | (frozenset() if shear else frozenset({"shear_deformation"})),
    )
    return arm, beams, [link.angle for link in chain.links]


def elastic_motion(arm: Arm, state: PoseState) -> tuple[Array, Array]:
    """The tip's displacement (m) and rotation (rad) by the physics of the arm's model, play apart."""
    twists = [t for effect in active_effects(arm) for t in effect.effect.twists(state, effect.settings)]
    return np.array(carried_to_tip(state, twists)), np.array(rotation_at_tip(state, twists))


def chain_motion(chain: RandomChain, *, shear: bool) -> tuple[Array, Array]:
    """The tip's displacement (m) and rotation (rad) of a random chain by the project's own mechanics."""
    arm, beams, q = chain_arm(chain, shear=shear)
    return elastic_motion(arm, solve(arm, q, beams))


def arm_of(text: str, folder: Path) -> Arm:
    """The arm that the text of an arm file describes."""
    path = folder / "arm.yaml"
    path.write_text(text, encoding="utf-8")
    return read_arm(path)


def rod_lines(
    lengths_mm: Sequence[float], *, joint: str = "", section: str = CIRCLE, material: str = PAPER_MATERIAL
) -> str:
    """The `chain` of an arm file: rods of these lengths, all joints with the keys in `joint`."""
    return "chain:\n" + "".join(
        f"  - joint: {{type: revolute{joint}}}\n"
        f"    link: {{length: {length:g} mm, section: {section}, material: {material}}}\n"
        for length in lengths_mm
    )
