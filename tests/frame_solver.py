"""A space-frame solver by the stiffness method, to check the project's own mechanics against.

It imports nothing of the project and shares no formula with it: straight prismatic members with six degrees
of freedom a node, Euler-Bernoulli or Timoshenko in each bending plane, joints as linear springs, a sparse set
of supports.

Members are exact for loads at their ends and for uniform loads along them, so one member a link suffices in
statics; natural frequencies converge from above as members are divided. Displacements are small (first
order).

Each node has the displacements (ux, uy, uz, rx, ry, rz) in the global frame, in this order, in SI units and
radians.

Sources: J. S. Przemieniecki, Theory of Matrix Structural Analysis, McGraw-Hill 1968 (stiffness of the
shear-flexible member); Z. Friedman and J. B. Kosmatka, An improved two-node Timoshenko beam finite element,
Computers & Structures 47 (1993) 473-481 (shape functions, from which the mass is integrated here).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

import numpy as np
import scipy.linalg

from linkwright.core.sections.numeric import Array

Vector = Sequence[float] | Array

ALL_SIX = (0, 1, 2, 3, 4, 5)


@dataclass(frozen=True)
class Member:
    """A straight prismatic member from node `start` to node `end`.

    Local axes: u along the member, h as near `height_direction` as is perpendicular to u, b = u x h.
    `second_moment_height` resists bending in the plane of u and h, `second_moment_width` in the plane of u
    and b; the shear areas (kappa A) go with the same planes. An infinite shear area is an Euler-Bernoulli
    member.
    """

    start: int
    end: int
    height_direction: Vector
    elastic_modulus: float  # Pa
    shear_modulus: float  # Pa
    area: float  # m^2
    second_moment_height: float  # m^4
    second_moment_width: float  # m^4
    torsion_constant: float  # m^4
    shear_area_height: float = inf  # m^2
    shear_area_width: float = inf  # m^2
    density: float = 0.0  # kg/m^3
    distributed_load: Vector = (
        0.0,
        0.0,
        0.0,
    )  # N/m along the member's length, global frame; weight comes on top


@dataclass(frozen=True)
class Spring:
    """Ties node `second` to the coincident node `first` but for one relative motion, which a spring resists.

    `motion` is "rotation" about `axis` (stiffness in N m/rad) or "translation" along it (N/m). An infinite
    stiffness ties that motion too.
    """

    first: int
    second: int
    axis: Vector
    stiffness: float
    motion: str = "rotation"


@dataclass(frozen=True)
class Support:
    """Holds the listed degrees of freedom (0 to 5) of a node at zero; all six clamp it."""

    node: int
    held: tuple[int, ...] = ALL_SIX


@dataclass(frozen=True)
class PointLoad:
    """A force (N) and a moment (N m) on a node, in the global frame."""

    node: int
    force: Vector = (0.0, 0.0, 0.0)
    moment: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class PointMass:
    """A mass (kg) at a node: it has weight in `solve` and inertia in `frequencies`."""

    node: int
    mass: float


@dataclass(frozen=True)
class Frame:
    """Nodes (shape (count, 3), m), what joins and holds them, and what acts on them."""

    nodes: Sequence[Vector] | Array
    members: Sequence[Member]
    supports: Sequence[Support]
    springs: Sequence[Spring] = ()
    loads: Sequence[PointLoad] = ()
    masses: Sequence[PointMass] = ()
    gravity: Vector = (0.0, 0.0, 0.0)  # m/s^2


class UnstableFrameError(ValueError):
    """The frame can move without resistance, so it has no displacements to speak of."""


def solve(frame: Frame) -> Array:
    """Static displacements of every node, shape (nodes, 6): three in m, then three small rotations in rad."""
    expand, springs = _free_coordinates(frame)
    stiffness = expand.T @ _assemble(frame, _local_stiffness) @ expand + springs
    displacements = expand @ _solve_equilibrated(stiffness, expand.T @ _load_vector(frame))
    return displacements.reshape(-1, 6)


def frequencies(frame: Frame, *, rotary_inertia: bool = True) -> Array:
    """Natural frequencies (Hz) in rising order, of the frame without its loads.

    Without `rotary_inertia` the sections of a bending member have no moment of inertia, as in the
    Euler-Bernoulli theory of vibration; twisting members keep theirs either way.
    """
    expand, springs = _free_coordinates(frame)
    stiffness = expand.T @ _assemble(frame, _local_stiffness) @ expand + springs
    full_mass = _assemble(frame, lambda member, length: _local_mass(member, length, rotary_inertia))
    for lump in frame.masses:
        for dof in range(6 * lump.node, 6 * lump.node + 3):
            full_mass[dof, dof] += lump.mass
    mass = expand.T @ full_mass @ expand
    # The flexibility form K^-1 M has the eigenvalues 1/omega^2, so coordinates without mass do no harm.
    scale, factor = _equilibrated_factor(stiffness)
    scaled_mass = scale[:, None] * mass * scale
    half = scipy.linalg.solve_triangular(factor, scaled_mass, lower=True)
    flexibility = scipy.linalg.solve_triangular(factor, half.T, lower=True)
    inverse_squares = scipy.linalg.eigvalsh((flexibility + flexibility.T) / 2)[::-1]
    moving = inverse_squares[inverse_squares > 1e-14 * inverse_squares[0]]
    return 1 / (2 * np.pi * np.sqrt(moving))


def _direction(vector: Vector) -> Array:
    array = np.asarray(vector, dtype=float)
    return array / np.linalg.norm(array)


def _axes(frame: Frame, member: Member) -> tuple[float, Array]:
    """The member's length and the matrix whose rows are u, h, b."""
    span = np.asarray(frame.nodes[member.end], dtype=float) - np.asarray(frame.nodes[member.start], dtype=float)
    length = float(np.linalg.norm(span))
    along = span / length
    height = np.asarray(member.height_direction, dtype=float)
    height = _direction(height - (height @ along) * along)
    return length, np.array([along, height, np.cross(along, height)])


# Positions of the (deflection, rotation) pairs at both ends in the local vector (u h b, rotations about u h
# b, twice). A rotation about b tilts u towards h; a rotation about h tilts u away from b, hence the signs.
_HEIGHT_PLANE = np.array([1, 5, 7, 11])
_HEIGHT_SIGNS = np.array([1.0, 1.0, 1.0, 1.0])
_WIDTH_PLANE = np.array([2, 4, 8, 10])
_WIDTH_SIGNS = np.array([1.0, -1.0, 1.0, -1.0])


def _planes(member: Member, length: float) -> list[tuple[Array, Array, float, float]]:
    """For both bending planes: where its freedoms stand, their signs, the second moment, and Phi."""
    result = []
    for places, signs, second_moment, shear_area in (
        (_HEIGHT_PLANE, _HEIGHT_SIGNS, member.second_moment_height, member.shear_area_height),
        (_WIDTH_PLANE, _WIDTH_SIGNS, member.second_moment_width, member.shear_area_width),
    ):
        shear_rigidity = member.shear_modulus * shear_area
        phi = (
            12 * member.elastic_modulus * second_moment / (shear_rigidity * length**2) if isfinite(shear_area) else 0.0
        )
        result.append((places, signs, second_moment, phi))
    return result


def _local_stiffness(member: Member, length: float) -> Array:
    matrix = np.zeros((12, 12))
    pair = np.array([[1.0, -1.0], [-1.0, 1.0]])
    matrix[np.ix_([0, 6], [0, 6])] = member.elastic_modulus * member.area / length * pair
    matrix[np.ix_([3, 9], [3, 9])] = member.shear_modulus * member.torsion_constant / length * pair
    for places, signs, second_moment, phi in _planes(member, length):
        near, far = (4 + phi) * length**2, (2 - phi) * length**2
        bending = np.array(
            [
                [12, 6 * length, -12, 6 * length],
                [6 * length, near, -6 * length, far],
                [-12, -6 * length, 12, -6 * length],
                [6 * length, far, -6 * length, near],
            ]
        )
        bending *= member.elastic_modulus * second_moment / (length**3 * (1 + phi))
        matrix[np.ix_(places, places)] = signs[:, None] * bending * signs
    return matrix


def _local_mass(member: Member, length: float, rotary_inertia: bool) -> Array:
    matrix = np.zeros((12, 12))
    pair = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    matrix[np.ix_([0, 6], [0, 6])] = member.density * member.area * length * pair
    polar = member.second_moment_height + member.second_moment_width
    matrix[np.ix_([3, 9], [3, 9])] = member.density * polar * length * pair
    points, weights = np.polynomial.legendre.leggauss(4)  # exact up to degree 7; the products have degree 6
    for places, signs, second_moment, phi in _planes(member, length):
        plane = np.zeros((4, 4))
        for xi, weight in zip((points + 1) / 2, weights / 2, strict=True):
            deflection, rotation = _shape_functions(xi, length, phi)
            plane += weight * member.density * member.area * length * np.outer(deflection, deflection)
            if rotary_inertia:
                plane += weight * member.density * second_moment * length * np.outer(rotation, rotation)
        matrix[np.ix_(places, places)] = signs[:, None] * plane * signs
    return matrix


def _shape_functions(xi: float, length: float, phi: float) -> tuple[Array, Array]:
    """Deflection and section rotation at xi in [0, 1] for unit (deflection, rotation) at either end."""
    deflection = np.array(
        [
            2 * xi**3 - 3 * xi**2 - phi * xi + 1 + phi,
            length * (xi**3 - (2 + phi / 2) * xi**2 + (1 + phi / 2) * xi),
            -(2 * xi**3 - 3 * xi**2 - phi * xi),
            length * (xi**3 - (1 - phi / 2) * xi**2 - phi / 2 * xi),
        ]
    )
    rotation = np.array(
        [
            6 / length * (xi**2 - xi),
            3 * xi**2 - (4 + phi) * xi + 1 + phi,
            -6 / length * (xi**2 - xi),
            3 * xi**2 - (2 - phi) * xi,
        ]
    )
    return deflection / (1 + phi), rotation / (1 + phi)


def _freedoms(member: Member) -> Array:
    return np.r_[6 * member.start : 6 * member.start + 6, 6 * member.end : 6 * member.end + 6]


def _assemble(frame: Frame, local_matrix) -> Array:
    size = 6 * len(frame.nodes)
    total = np.zeros((size, size))
    for member in frame.members:
        length, axes = _axes(frame, member)
        turn = np.kron(np.eye(4), axes)
        freedoms = _freedoms(member)
        total[np.ix_(freedoms, freedoms)] += turn.T @ local_matrix(member, length) @ turn
    return total


def _load_vector(frame: Frame) -> Array:
    """Point loads, weights, and uniform loads as the reversed forces of a member held at both ends.

    Those end forces are qL/2 and the moments qL^2/12 with or without shear: by symmetry the held member has
    no shear at its middle, so its shear deflection turns no section.
    """
    gravity = np.asarray(frame.gravity, dtype=float)
    vector = np.zeros(6 * len(frame.nodes))
    for member in frame.members:
        length, axes = _axes(frame, member)
        load = np.asarray(member.distributed_load, dtype=float) + member.density * member.area * gravity
        moment = np.cross(axes[0], load) * length**2 / 12
        vector[_freedoms(member)] += np.concatenate([load * length / 2, moment, load * length / 2, -moment])
    for point in frame.loads:
        vector[6 * point.node : 6 * point.node + 6] += np.concatenate([point.force, point.moment])
    for lump in frame.masses:
        vector[6 * lump.node : 6 * lump.node + 3] += lump.mass * gravity
    return vector


def _free_coordinates(frame: Frame) -> tuple[Array, Array]:
    """The matrix from free coordinates to all freedoms, and the springs' stiffness in the free coordinates.

    The ties are eliminated rather than penalised: the freedoms of a spring's second node are those of its
    first plus the axis times one relative coordinate, so nothing is lost to a large number.
    """
    for spring in frame.springs:
        gap = np.asarray(frame.nodes[spring.first], dtype=float) - np.asarray(frame.nodes[spring.second], dtype=float)
        if np.any(gap != 0):
            raise ValueError(f"nodes {spring.first} and {spring.second} of a spring must coincide")
        if spring.motion not in ("rotation", "translation"):
            raise ValueError(f"a spring resists a rotation or a translation, not a {spring.motion!r}")
    by_second = {spring.second: spring for spring in frame.springs}
    if len(by_second) != len(frame.springs):
        raise ValueError("a node may be the second node of one spring only")
    held = {support.node: set(support.held) for support in frame.supports}
    if by_second.keys() & held.keys():
        raise ValueError("support the first node of a spring, not its second")

    columns: list[Array] = []  # one free coordinate each: the freedoms it moves
    spring_stiffness: list[float] = []
    size = 6 * len(frame.nodes)
    followers: dict[int, list[Spring]] = {}
    for spring in frame.springs:
        followers.setdefault(spring.first, []).append(spring)

    def moved_along(node: int) -> list[int]:
        """The node and all that are tied to it, directly or through others."""
        return [node] + [other for spring in followers.get(node, []) for other in moved_along(spring.second)]

    def add_coordinate(node: int, motion: Array, stiffness: float) -> None:
        column = np.zeros(size)
        for other in moved_along(node):
            column[6 * other : 6 * other + 6] = motion
        columns.append(column)
        spring_stiffness.append(stiffness)

    for node in range(len(frame.nodes)):
        if node not in by_second:
            for dof in sorted(set(ALL_SIX) - held.get(node, set())):
                add_coordinate(node, np.eye(6)[dof], 0.0)
        elif isfinite(by_second[node].stiffness):
            spring = by_second[node]
            first = 3 if spring.motion == "rotation" else 0
            motion = np.zeros(6)
            motion[first : first + 3] = _direction(spring.axis)
            add_coordinate(node, motion, spring.stiffness)
    return np.array(columns).T, np.diag(spring_stiffness)


def _equilibrated_factor(stiffness: Array) -> tuple[Array, Array]:
    """Scales of the coordinates that give the stiffness a unit diagonal, and its Cholesky factor then.

    Newtons per metre and newton metres per radian differ by powers of ten; scaling takes that out of the
    conditioning.
    """
    diagonal = np.diag(stiffness)
    if np.any(diagonal <= 0):
        raise UnstableFrameError("the frame has a motion that nothing resists")
    scale = 1 / np.sqrt(diagonal)
    try:
        factor = scipy.linalg.cholesky(scale[:, None] * stiffness * scale, lower=True)
    except scipy.linalg.LinAlgError as error:
        raise UnstableFrameError("the frame has a motion that nothing resists") from error
    if np.min(np.diag(factor)) < 1e-7:  # its square is at rounding
        raise UnstableFrameError("the frame has a motion that next to nothing resists")
    return scale, factor


def _solve_equilibrated(stiffness: Array, load: Array) -> Array:
    scale, factor = _equilibrated_factor(stiffness)
    exact_stiffness = stiffness.astype(np.longdouble)
    solution = np.zeros(len(load), dtype=np.longdouble)
    for _ in range(4):  # refinement with residuals in extended precision
        residual = (load - exact_stiffness @ solution).astype(float)
        solution += scale * scipy.linalg.cho_solve((factor, True), scale * residual)
    return solution.astype(float)
