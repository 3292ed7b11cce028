"""Rigid multibody dynamics of an arm: the torques that a motion takes of its drives, and how they follow its masses.

Newton and Euler's equations, link by link. The torque about a joint is linear in the ten inertial parameters of each
link that it moves; with a twist (w, v) of the joint seen from the link's origin, in the link's frame,

    torque = v . (m a + alpha x h + omega x (omega x h)) + w . (h x a + I alpha + omega x I omega)

where m is the mass, h its first moments and I its inertia about the link's origin, a the acceleration of that origin
less gravity. (C. G. Atkeson, C. H. An & J. M. Hollerbach, Int. J. Robotics Research 5 (1986) 101-119,
doi:10.1177/027836498600500306; R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, ch. 5.)
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from linkwright.core.arm.bodies.beams import beam_of
from linkwright.core.arm.bodies.bodies import Mass, ball, masses_on_link
from linkwright.core.arm.chain.chain import Arm, FloatVector
from linkwright.core.arm.chain.following import turns, turns_by_coordinates
from linkwright.core.arm.chain.kinematics import turns_by_drives
from linkwright.core.arm.chain.vectors import ZERO, add, rotate, scale
from linkwright.core.sections.numeric import Array

from .motion import Motion
from .moving import MovingArm, MovingLink, cross, dot, moving, pieces, refuse_what_no_chain_is

PARAMETERS = (
    "mass",
    *(f"first_moment_{axis}" for axis in "xyz"),
    *(f"inertia_{pair}" for pair in ("xx", "xy", "xz", "yy", "yz", "zz")),
)
"""A link's ten inertial parameters in their order: kg, kg*m, and kg*m^2 about the origin of its joint's frame."""

INERTIA_PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
"""Where the last six of them stand in a tensor."""

_ROUNDING, _THINNEST = 1e-6, 1e-9
"""Of a pseudo-inertia's greatest eigenvalue: by how much the least one may be below zero by rounding, and how large it
is then made, so that further rounding leaves it a body's."""


def parameters_of(mass: Mass) -> Array:
    """A mass as its ten inertial parameters (10,) about the origin of its frame."""
    first = mass.mass * mass.center
    about = mass.inertia + mass.mass * (mass.center @ mass.center * np.eye(3) - np.outer(mass.center, mass.center))
    return np.array([mass.mass, *first, *(about[pair] for pair in INERTIA_PAIRS)])


def in_frame(parameters: Array, rotation: Array, step: Array) -> Array:
    """Inertial parameters (10,) of a frame, in one in which that frame stands turned (3, 3) and at a step (3,) m."""
    mass, first = parameters[0], rotation @ parameters[1:4]
    tensor = rotation @ tensor_of(parameters) @ rotation.T
    twice = np.outer(first, step) + np.outer(step, first)
    about = tensor + 2.0 * (first @ step) * np.eye(3) - twice
    about = about + mass * (step @ step * np.eye(3) - np.outer(step, step))
    return np.array([mass, *(first + mass * step), *(about[pair] for pair in INERTIA_PAIRS)])


def tensor_of(parameters: Array) -> Array:
    """The inertia (3, 3) about the origin that ten inertial parameters hold, kg*m^2."""
    tensor = np.empty((3, 3))
    for value, (row, column) in zip(parameters[4:], INERTIA_PAIRS, strict=True):
        tensor[row, column] = tensor[column, row] = value
    return tensor


def pseudo_inertia(parameters: Array) -> Array:
    """The pseudo-inertia (4, 4) of ten inertial parameters: positive definite where, and only where, some body has
    them.

    (P. M. Wensing, S. Kim & J.-J. E. Slotine, Linear matrix inequalities for physically consistent inertial parameter
    identification, IEEE Robotics and Automation Letters 3 (2018) 60-67, doi:10.1109/LRA.2017.2729659.)

    Args:
        parameters: (10,) in the order of `PARAMETERS`.

    Returns:
        (4, 4) kg*m^2, kg*m and kg.
    """
    tensor = tensor_of(parameters)
    matrix = np.empty((4, 4))
    matrix[:3, :3] = 0.5 * np.trace(tensor) * np.eye(3) - tensor
    matrix[:3, 3] = matrix[3, :3] = parameters[1:4]
    matrix[3, 3] = parameters[0]
    return matrix


def is_body(pseudo: Array) -> bool:
    """Whether a pseudo-inertia (4, 4) is some body's, as far as rounding tells."""
    values = np.linalg.eigvalsh(pseudo)
    return bool(values[0] >= -_ROUNDING * abs(values[-1]))


def body_near(parameters: Array) -> Array | None:
    """Inertial parameters (10,) of a body, where these are a body's but for rounding; None else."""
    pseudo = pseudo_inertia(parameters)
    if parameters[0] <= 0.0 or not is_body(pseudo):
        return None
    values, vectors = np.linalg.eigh(pseudo)
    if values[0] >= _THINNEST * values[-1]:
        return parameters
    whole = (vectors * np.maximum(values, _THINNEST * values[-1])) @ vectors.T
    tensor = np.trace(whole[:3, :3]) * np.eye(3) - whole[:3, :3]
    return np.array([whole[3, 3], *whole[:3, 3], *(tensor[pair] for pair in INERTIA_PAIRS)])


def link_parameters(arm: Arm) -> Array:
    """Inertial parameters of an arm's links, with all that rides on them: joints, what hangs there, and the payload (of
    the last one). Masses without a shape are balls of steel, as in exports.

    Args:
        arm: The arm; drives are taken to be massless beyond their joints' masses.

    Returns:
        (n, 10) in the order of `PARAMETERS`, each in its link's frame (which stands at its joint and moves with the
        link; its x is the link's direction in a plain file).

    Raises:
        PropertyNeeded: A link's mass is not known.
        InputError: The arm has branches, or links that run out of a sleeve.

    >>> from linkwright.core.arm.chain.chain import Arm, Joint, Link
    >>> arm = Arm("rod", (Joint(),), (Link(0.5, mass=2.0, center_of_mass=0.25),))
    >>> link_parameters(arm)[0, :2].round(6).tolist()
    [2.0, 0.5]
    """
    refuse_what_no_chain_is(arm)
    parameters = np.zeros((arm.size, 10))
    for index in range(arm.size):
        whole = masses_on_link(arm, index, beam_of(arm, index)).whole
        if whole is not None:
            parameters[index] = parameters_of(whole)
    parameters[-1] += parameters_of(ball(arm.payload.mass, tip_of_last_link(arm)))
    return parameters


def tip_of_last_link(arm: Arm) -> Array:
    """Where the tip stands in the last link's frame (3,), m."""
    last = arm.links[-1]
    return np.array(add(scale(last.length, last.direction), rotate(last.end_rotation, arm.tool)), dtype=float)


def inverse_dynamics(motion: Motion) -> Array:
    """Torques that a motion takes of the drives of a rigid arm without friction, as its file has it: inertia, weight,
    the load at the tip, and what the file's counterbalances take off.

    Args:
        motion: The motion; its `payload_mass` counts in place of the arm's.

    Returns:
        (N, n) N*m (N for slides), positive where the drive pushes towards increasing q. A joint that only follows
        others has none of its own.

    Raises:
        PropertyNeeded: A link's mass is not known.
        InputError: The arm has branches, or links that run out of a sleeve.

    >>> from linkwright.core.arm.chain.chain import Arm, Joint, Link
    >>> arm = Arm("rod", (Joint(),), (Link(0.5, mass=2.0, center_of_mass=0.25),))
    >>> still = np.zeros((1, 1))
    >>> float(inverse_dynamics(Motion(arm, np.zeros(1), still, still, still))[0, 0])
    4.905
    """
    arm, moves = motion.arm, motion.of_links
    torque = rigid_torque(
        arm, link_parameters(arm), moves.q, moves.velocity, moves.acceleration, payload_mass=motion.payload_mass
    )
    return torque - _balanced(arm, moves.q)


def rigid_torque(
    arm: Arm,
    parameters: Array,
    q: Array,
    velocity: Array,
    acceleration: Array,
    *,
    gravity: FloatVector | None = None,
    payload_mass: Array | None = None,
) -> Array:
    """Torques (N, n) of links of these inertial parameters (n, 10), with the force and moment at the tip;
    `payload_mass` (N,) kg counts in place of that in the parameters, `gravity` (m/s^2) in place of the arm's."""
    refuse_what_no_chain_is(arm)
    torque = np.empty(q.shape)
    turned = turns_by_drives(arm)
    for piece in pieces(len(q)):
        here = moving(arm, q[piece], velocity[piece], acceleration[piece], gravity)
        about = _about_joints(arm, here, parameters, None if payload_mass is None else payload_mass[piece])
        torque[piece] = about.T @ turned
    return torque


def _about_joints(arm: Arm, here: MovingArm, parameters: Array, payload_mass: Array | None) -> Array:
    """Torques about the joints themselves (n, M), from the tip inward."""
    count = here.tip.shape[1]
    force = np.repeat(-np.array(arm.payload.force)[:, None], count, axis=1)
    moment = cross(here.tip, force) - np.array(arm.payload.moment)[:, None]
    torque = np.empty((arm.size, count))
    for index in range(arm.size - 1, -1, -1):
        link, inertial = here.links[index], parameters[index]
        if index == arm.size - 1 and payload_mass is not None:
            inertial = inertial[:, None] + _other_payload(arm, payload_mass)
        pushed, turned = _wrench(link, inertial)
        force = force + np.einsum("abm,bm->am", link.rotation, pushed)
        moment = moment + np.einsum("abm,bm->am", link.rotation, turned)
        torque[index] = dot(link.axis, moment if arm.joints[index].revolute else force)
        if index:
            moment = moment + cross(link.origin - here.links[index - 1].origin, force)
    return torque


def _other_payload(arm: Arm, mass: Array) -> Array:
    """What another payload (M,) kg adds to the last link's parameters (10, M)."""
    place = tip_of_last_link(arm)
    payload_ball, unit = ball(arm.payload.mass, place), ball(1.0, place)
    point = parameters_of(Mass(1.0, place, np.zeros((3, 3))))
    # A ball's inertia goes with mass and radius squared, and so with the mass to the power of 5/3.
    shape = np.zeros(10)
    shape[[4, 7, 9]] = unit.inertia[0, 0]
    return point[:, None] * mass + shape[:, None] * mass ** (5.0 / 3.0) - parameters_of(payload_ball)[:, None]


def _wrench(link: MovingLink, parameters: Array) -> tuple[Array, Array]:
    """Force and moment (3, M) about a link's origin, in its frame, that move a body of these parameters with it."""
    mass, first, (xx, xy, xz, yy, yz, zz) = parameters[0], parameters[1:4], parameters[4:]
    first = np.broadcast_to(first.reshape(3, -1), link.turning.shape)

    def tensor(vector: Array) -> Array:
        x, y, z = vector
        made = np.empty_like(vector)
        made[0], made[1] = xx * x + xy * y + xz * z, xy * x + yy * y + yz * z
        made[2] = xz * x + yz * y + zz * z
        return made

    omega, alpha, rising = link.turning, link.spinning_up, link.acceleration
    force = mass * rising + cross(alpha, first) + cross(omega, cross(omega, first))
    return force, cross(first, rising) + tensor(alpha) + cross(omega, tensor(omega))


def _balanced(arm: Arm, q: Array) -> Array:
    """What the file's counterbalances take off the drives (N, n); where angles are absolute, they pull at the base."""
    about = np.zeros(q.shape)
    for index, (joint, turn) in enumerate(zip(arm.joints, turns(arm, list(q.T)), strict=True)):
        if joint.counterbalance is not None:
            about[:, index] = joint.counterbalance.turning(turn)
    return about @ turns_by_coordinates(arm)


def regressor(arm: Arm, q: Array, velocity: Array, acceleration: Array) -> Array:
    """How the torques of the drives follow each link's inertial parameters: with those of `link_parameters` it gives
    `inverse_dynamics`, but for counterbalances and what else acts at the tip.

    Args:
        arm: The arm; its geometry and gravity count, not its masses.
        q: (N, n) joint coordinates, rad (m for slides).
        velocity: (N, n) rad/s (m/s).
        acceleration: (N, n) rad/s^2 (m/s^2).

    Returns:
        (N, n, 10 n): torque of drive i (N*m, N) by parameter p of link k (both from 0) in [:, i, 10 * k + p].

    Raises:
        InputError: The arm has branches, or links that run out of a sleeve.
    """
    refuse_what_no_chain_is(arm)
    size = arm.size
    matrix = np.empty((len(q), size, 10 * size))
    turned = turns_by_drives(arm)
    plain = bool(np.array_equal(turned, np.eye(size)))
    for piece in pieces(len(q)):
        here = moving(arm, q[piece], velocity[piece], acceleration[piece])
        about = np.zeros((size, size, 10, len(here.tip[0])))
        for link in range(size):
            for joint in range(link + 1):
                _row(arm, here, joint, link, about[joint, link])
        rows = about.reshape(size, -1)
        rows = rows if plain else turned.T @ rows
        matrix[piece] = rows.reshape(size, 10 * size, -1).transpose(2, 0, 1)
    return matrix


def _row(arm: Arm, here: MovingArm, joint: int, link: int, row: Array) -> None:
    """Write how the torque about a joint follows the ten parameters of a link beyond it into `row` (10, M)."""
    body, axis = here.links[link], here.links[joint].axis
    omega, alpha, rising = body.turning, body.spinning_up, body.acceleration
    if not arm.joints[joint].revolute:
        shift = body.inward(axis)
        row[0] = dot(shift, rising)
        row[1:4] = cross(shift, alpha) + cross(cross(shift, omega), omega)
        return
    turn = body.inward(axis)
    row[1:4] = cross(rising, turn)
    if joint < link:
        shift = body.inward(cross(axis, body.origin - here.links[joint].origin))
        row[0] = dot(shift, rising)
        row[1:4] += cross(shift, alpha) + cross(cross(shift, omega), omega)
    across = cross(turn, omega)
    for place, (a, b) in enumerate(INERTIA_PAIRS, start=4):
        row[place] = turn[a] * alpha[b] + across[a] * omega[b]
        if a != b:
            row[place] += turn[b] * alpha[a] + across[b] * omega[a]


def gravity_torque(arm: Arm, q: Array, gravity: FloatVector, payload_mass: Array | None = None) -> Array:
    """Torques (N, n) that hold the arm's masses against a gravity (m/s^2, base frame) alone, payload among them, or
    another payload (N,) kg in its place."""
    bare, parameters = np.zeros(q.shape), link_parameters(arm)
    return rigid_torque(without_tip_load(arm), parameters, q, bare, bare, gravity=gravity, payload_mass=payload_mass)


def without_tip_load(arm: Arm) -> Arm:
    """The arm without the force and moment at its tip."""
    return replace(arm, payload=replace(arm.payload, force=ZERO, moment=ZERO))


def load_torque(motion: Motion) -> Array:
    """The torques (N, n) by which goes what acts in proportion to a load: the motion's own, else the rigid arm's."""
    return inverse_dynamics(motion) if motion.torque is None else motion.torque
