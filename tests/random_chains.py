"""Random serial arms as plain numbers, and the frame that the independent solver makes of each.

    chain = random_planar_chain(np.random.default_rng(7), links=3)
    displacement, rotation = tip_motion(chain)

Conventions. Frame 0 is the base frame. Frame i is frame i-1 turned about joint i's axis by its angle:
R_i = R_(i-1) Rot(axis_i, angle_i), `axis` being given in frame i-1 (the same numbers hold in frame i). Link i
runs from joint i's origin o_i along local x: u_i = R_i x, o_(i+1) = o_i + length_i u_i; the last end is the
tip. The section's height lies along h_i = a_i x u_i normalised, a_i being the joint's axis in the base frame,
or along local y where a_i is parallel to the link; its width lies along b_i = u_i x h_i. I_y resists bending
in the plane of u and h, I_z in the plane of u and b; a shear force along h meets the shear area
`shear_area_height`. A joint gives only about its own axis. A joint's mass sits at its origin and is carried
by the link before it.
"""

from dataclasses import dataclass

import numpy as np

from linkwright.core.sections.numeric import Array
from tests.frame_solver import Frame, Member, PointLoad, PointMass, Spring, Support, solve

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class RandomLink:
    """A joint and the link it turns, in SI units and radians."""

    axis: Triple  # unit vector, in the frame before the joint (and after it: a rotation keeps its axis)
    angle: float
    joint_stiffness: float | None  # N m/rad about the axis; None is rigid
    joint_mass: float
    length: float
    area: float
    second_moment_y: float  # I_y: bending in the plane of link and height
    second_moment_z: float  # I_z: bending in the plane of link and width
    torsion_constant: float
    shear_area_height: float
    shear_area_width: float
    elastic_modulus: float
    poisson_ratio: float
    density: float

    @property
    def shear_modulus(self) -> float:
        """G of an isotropic material."""
        return self.elastic_modulus / (2 * (1 + self.poisson_ratio))


@dataclass(frozen=True)
class RandomChain:
    """A serial arm clamped at the origin, its pose included, with what it carries at the tip."""

    links: tuple[RandomLink, ...]
    gravity: Triple
    payload_mass: float
    tip_force: Triple


@dataclass(frozen=True)
class LinkPlace:
    """Where a link stands in the base frame: both ends, its axes u, h, b, and its joint's axis."""

    start: Array
    end: Array
    along: Array
    height: Array
    width: Array
    joint_axis: Array


def random_planar_chain(rng: np.random.Generator, links: int | None = None) -> RandomChain:
    """An arm of 1 to 5 links in the x-y plane: joints about z, gravity along -y, a force in the plane."""
    count = int(rng.integers(1, 6)) if links is None else links
    force = rng.normal(0.0, 40.0, 2)
    return RandomChain(
        links=tuple(_random_link(rng, (0.0, 0.0, 1.0)) for _ in range(count)),
        gravity=(0.0, -9.81, 0.0),
        payload_mass=_sometimes(rng, 0.0, float(rng.uniform(0.1, 6.0))),
        tip_force=(float(force[0]), float(force[1]), 0.0),
    )


def random_spatial_chain(rng: np.random.Generator, links: int | None = None) -> RandomChain:
    """An arm of 1 to 5 links in space: axes, gravity and force anywhere; some axes along x, y or z."""
    count = int(rng.integers(1, 6)) if links is None else links
    return RandomChain(
        links=tuple(_random_link(rng, _random_axis(rng)) for _ in range(count)),
        gravity=_triple(9.81 * _unit(rng.normal(size=3))),
        payload_mass=_sometimes(rng, 0.0, float(rng.uniform(0.1, 6.0))),
        tip_force=_triple(rng.normal(0.0, 40.0, 3)),
    )


def places(chain: RandomChain) -> list[LinkPlace]:
    """The geometry of the undeformed arm, link by link from the base."""
    result = []
    origin, turn = np.zeros(3), np.eye(3)
    for link in chain.links:
        joint_axis = turn @ np.array(link.axis)
        turn = turn @ rotation_about(link.axis, link.angle)
        along = turn[:, 0]
        height = np.cross(joint_axis, along)
        height = turn[:, 1] if np.linalg.norm(height) < 1e-9 else _unit(height)
        end = origin + link.length * along
        result.append(LinkPlace(origin, end, along, height, np.cross(along, height), joint_axis))
        origin = end
    return result


def build_frame(chain: RandomChain, *, shear: bool = True, pieces: int = 1) -> tuple[Frame, int]:
    """The frame of the arm and the number of its tip node; each link is divided into `pieces` members.

    Without `shear` the links are Euler-Bernoulli beams.
    """
    nodes: list[Array] = [np.zeros(3)]
    members: list[Member] = []
    springs: list[Spring] = []
    masses: list[PointMass] = []
    for link, place in zip(chain.links, places(chain), strict=True):
        carrier = len(nodes) - 1
        masses.append(PointMass(carrier, link.joint_mass))
        stiffness = np.inf if link.joint_stiffness is None else link.joint_stiffness
        springs.append(Spring(carrier, carrier + 1, place.joint_axis, stiffness))
        nodes.append(nodes[carrier])
        for piece in range(1, pieces + 1):
            nodes.append(place.start + (place.end - place.start) * (piece / pieces))
            members.append(
                Member(
                    start=len(nodes) - 2,
                    end=len(nodes) - 1,
                    height_direction=place.height,
                    elastic_modulus=link.elastic_modulus,
                    shear_modulus=link.shear_modulus,
                    area=link.area,
                    second_moment_height=link.second_moment_y,
                    second_moment_width=link.second_moment_z,
                    torsion_constant=link.torsion_constant,
                    shear_area_height=link.shear_area_height if shear else np.inf,
                    shear_area_width=link.shear_area_width if shear else np.inf,
                    density=link.density,
                )
            )
    tip = len(nodes) - 1
    masses.append(PointMass(tip, chain.payload_mass))
    frame = Frame(
        nodes=nodes,
        members=members,
        supports=[Support(0)],
        springs=springs,
        loads=[PointLoad(tip, force=chain.tip_force)],
        masses=masses,
        gravity=chain.gravity,
    )
    return frame, tip


def tip_motion(chain: RandomChain, *, shear: bool = True) -> tuple[Array, Array]:
    """The tip's displacement (m) and rotation (rad) in the base frame under the loads, each of shape (3,)."""
    frame, tip = build_frame(chain, shear=shear)
    motion = solve(frame)[tip]
    return motion[:3], motion[3:]


def rotation_about(axis: Triple | Array, angle: float) -> Array:
    """The rotation matrix about a unit axis (Rodrigues)."""
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew


def _random_link(rng: np.random.Generator, axis: Triple) -> RandomLink:
    size = float(np.exp(rng.uniform(np.log(0.02), np.log(0.14))))  # an outer dimension, 20 to 140 mm
    area = size**2 * float(rng.uniform(0.08, 1.0))
    return RandomLink(
        axis=axis,
        angle=float(rng.uniform(-np.pi, np.pi)),
        joint_stiffness=_sometimes(rng, None, float(np.exp(rng.uniform(np.log(5e3), np.log(5e5))))),
        joint_mass=_sometimes(rng, 0.0, float(rng.uniform(0.5, 10.0))),
        length=float(rng.uniform(0.15, 0.8)),
        area=area,
        second_moment_y=area * size**2 * float(rng.uniform(0.04, 0.16)),
        second_moment_z=area * size**2 * float(rng.uniform(0.01, 0.12)),
        torsion_constant=area * size**2 * float(rng.uniform(0.005, 0.2)),
        shear_area_height=area * float(rng.uniform(0.3, 0.95)),
        shear_area_width=area * float(rng.uniform(0.3, 0.95)),
        elastic_modulus=float(rng.uniform(60e9, 215e9)),
        poisson_ratio=float(rng.uniform(0.2, 0.4)),
        density=float(rng.uniform(1500.0, 8000.0)),
    )


def _random_axis(rng: np.random.Generator) -> Triple:
    """A random unit vector; one time in three a coordinate axis of either sense, x (the link's) included."""
    if rng.random() < 1 / 3:
        axis = np.zeros(3)
        axis[rng.integers(3)] = rng.choice([-1.0, 1.0])
        return _triple(axis)
    return _triple(_unit(rng.normal(size=3)))


def _sometimes(rng: np.random.Generator, special: float | None, usual: float):
    return special if rng.random() < 0.2 else usual


def _unit(vector: Array) -> Array:
    return vector / np.linalg.norm(vector)


def _triple(vector: Array) -> Triple:
    return (float(vector[0]), float(vector[1]), float(vector[2]))
