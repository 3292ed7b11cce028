"""An arm as MuJoCo bodies: every link a chain of rigid segments on springs, every drive a sprung hinge.

The springs of a link sit at the nodes of Gauss and Legendre, each with the flexibility of its share of the length: in
the limit of small loads bending, shear, torsion and stretch under forces, moments and weight are then exact, and what
leaves first order converges with the square of the number of nodes. MuJoCo gives the kinematics, the Jacobians and
the generalised weight of all bodies on the deformed shape (T. Todorov, T. Erez & Y. Tassa, MuJoCo: a physics engine for
model-based control, IROS 2012, doi:10.1109/IROS.2012.6386109). At rest each coordinate stands where its spring, or
whatever law it has beside it, meets the load on it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, tostring

import mujoco
import numpy as np

from benchmarks.blind.generator.mechanics import Arm, Joint, Link, flexibility, material_frame
from benchmarks.blind.generator.vectors import Array

NODES = 5
NOTHING = 1e-9  # kg and kg*m^2 of a body that only carries joints; MuJoCo wants a mass
AXES = np.eye(3)


class NotSettledError(ValueError):
    """No rest was found: loads beyond what the arm can carry, or a play that nothing decides."""


@dataclass(frozen=True)
class Machine:
    """A compiled arm and where its coordinates are. All coordinates are scalar: positions are degrees of freedom."""

    arm: Arm
    model: mujoco.MjModel
    data: mujoco.MjData
    base: tuple[int, ...]  # three slides, three hinges, along and about x, y, z
    drive: tuple[int, ...]  # one a joint
    seat: tuple[tuple[int, ...], ...]  # three slides of each joint, in the frame of the link before
    tilt: tuple[tuple[int, ...], ...]  # three hinges likewise
    nodes: tuple[tuple[tuple[int, ...], ...], ...]  # of each link: (along, across, out, twist, about across, about out)
    shares: tuple[tuple[float, ...], ...]  # the length that each node stands for, m
    stretch: tuple[int, ...]  # a slide at the end of each link, along it
    tool: tuple[int, ...]  # three slides of the tip, in the frame of the last link: along, across, out
    compliance: Array  # of every coordinate's spring as the arm file has it, rad/(N*m) or m/N

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.model.nv)

    def site(self, name: str) -> int:
        """Number of a site: `tip`, or `middle1`, `end1` and so on."""
        return mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_SITE, name)


class _Writer:
    """The MJCF text of an arm, and the names of its coordinates in order."""

    def __init__(self) -> None:
        self.root = Element("mujoco")
        SubElement(self.root, "compiler", angle="radian", autolimits="false", balanceinertia="false")
        SubElement(self.root, "option", gravity="0 0 0")
        self.world = SubElement(self.root, "worldbody")
        self.count = 0
        self.compliance: list[float] = []

    def body(self, parent: Element, at: Array) -> Element:
        return SubElement(parent, "body", pos=_text(at))

    def joint(self, body: Element, kind: str, axis: Array, compliance: float = 0.0) -> int:
        SubElement(body, "joint", type=kind, axis=_text(axis), name=f"c{self.count}")
        self.compliance.append(compliance)
        self.count += 1
        return self.count - 1

    def mass(self, body: Element, at: Array, mass: float) -> None:
        """The mass of a body, its own, spread along a short rod: how it would spin is of no account at rest."""
        body.insert(
            0,
            Element("inertial", pos=_text(at), mass=repr(float(max(mass, NOTHING))), diaginertia=_text([NOTHING] * 3)),
        )

    def six(self, body: Element, frame: Array, give: Sequence[float]) -> tuple[int, ...]:
        slides = [self.joint(body, "slide", frame[:, k], give[k]) for k in range(3)]
        return (*slides, *(self.joint(body, "hinge", frame[:, k], give[3 + k]) for k in range(3)))


def _text(values: Sequence[float] | Array) -> str:
    return " ".join(repr(float(v)) for v in values)


def machine(arm: Arm, nodes: int = NODES, extra_mass: Sequence[float] | None = None) -> Machine:
    """The arm's bodies; `extra_mass` (kg) lies spread along each link beyond what the file says."""
    extra = [0.0] * arm.count if extra_mass is None else list(extra_mass)
    writer = _Writer()
    carrier = writer.body(writer.world, np.zeros(3))
    writer.mass(carrier, np.zeros(3), 0.0)
    base = writer.six(carrier, AXES, [0.0] * 6)
    drive, seat, tilt, every, shares, stretch = [], [], [], [], [], []
    frame = AXES
    for i, (joint, link) in enumerate(zip(arm.joints, arm.links, strict=True)):
        if joint.mass > 0.0:
            writer.mass(writer.body(carrier, np.zeros(3)), np.zeros(3), joint.mass)
        carrier = writer.body(carrier, np.zeros(3))
        six = writer.six(carrier, AXES, [0.0] * 6)
        seat.append(six[:3])
        tilt.append(six[3:])
        writer.mass(carrier, np.zeros(3), 0.0)
        carrier = writer.body(carrier, np.zeros(3))  # a body has at most six coordinates
        kind = "slide" if joint.prismatic else "hinge"
        drive.append(writer.joint(carrier, kind, np.array(joint.axis, dtype=float), joint.compliance))
        line_mass = link.line_mass + extra[i] / link.length
        carrier, frame, along, share = _link(writer, carrier, joint, link, line_mass, nodes, i + 1)
        every.append(along)
        shares.append(share)
        stretch.append(writer.joint(carrier, "slide", frame[:, 0]))
        writer.mass(carrier, np.zeros(3), 0.0)
        SubElement(carrier, "site", name=f"end{i + 1}", pos="0 0 0")
    carrier = writer.body(carrier, np.zeros(3))
    writer.mass(carrier, np.zeros(3), 0.0)
    tool = tuple(writer.joint(carrier, "slide", frame[:, k]) for k in range(3))
    SubElement(carrier, "site", name="tip", pos="0 0 0")
    model = mujoco.MjModel.from_xml_string(tostring(writer.root, encoding="unicode"))
    model.opt.gravity[:] = arm.gravity
    return Machine(
        arm,
        model,
        mujoco.MjData(model),
        base,
        tuple(drive),
        tuple(seat),
        tuple(tilt),
        tuple(every),
        tuple(shares),
        tuple(stretch),
        tool,
        np.array(writer.compliance),
    )


def _link(
    writer: _Writer, carrier: Element, joint: Joint, link: Link, line_mass: float, nodes: int, number: int
) -> tuple[Element, Array, tuple[tuple[int, ...], ...], tuple[float, ...]]:
    """The segments of a link from its joint on; gives the body at its far end, the link's frame and its springs."""
    frame = material_frame(joint, link)
    way = frame[:, 0]
    if link.section is None:
        writer.mass(carrier, way * link.length / 2.0, line_mass * link.length)
        SubElement(carrier, "site", name=f"middle{number}", pos=_text(way * link.length / 2.0))
        return writer.body(carrier, way * link.length), frame, (), ()
    x, w = np.polynomial.legendre.leggauss(nodes)
    places, shares = (x + 1.0) / 2.0 * link.length, w / 2.0 * link.length
    give = flexibility(link)  # 1/EA, two of shear, 1/GJ, two of bending
    results = []
    start = 0.0
    for k, place in enumerate(places):
        writer.mass(carrier, way * (place - start) / 2.0, line_mass * (place - start))
        carrier = writer.body(carrier, way * (place - start))
        results.append(writer.six(carrier, frame, [float(g * shares[k]) for g in give]))
        if k == nodes // 2:
            SubElement(carrier, "site", name=f"middle{number}", pos="0 0 0")
        start = place
    writer.mass(carrier, way * (link.length - start) / 2.0, line_mass * (link.length - start))
    return writer.body(carrier, way * (link.length - start)), frame, tuple(results), tuple(float(s) for s in shares)


Law = Callable[[Array], Sequence[tuple[int, float]]]
"""From the generalised loads on all coordinates to what some of them give beyond their springs."""
Force = Callable[[Machine], Sequence[tuple[str, Array, Array]]]
"""From where the bodies stand to forces (N) and moments (N*m), base frame, at sites."""


@dataclass(frozen=True)
class Rest:
    """Where everything has come to rest."""

    coordinates: Array
    load: Array  # generalised, on each coordinate
    tip: Array  # (3,)
    turn: Array  # (3, 3), columns are the tip's axes in the base frame
    jacobian: Array  # (3, size) of the tip
    turning: Array  # (3, size), of its rotation


def place(machine: Machine, coordinates: Array) -> None:
    """Puts the bodies where the coordinates say."""
    machine.data.qpos[:] = coordinates
    mujoco.mj_kinematics(machine.model, machine.data)
    mujoco.mj_comPos(machine.model, machine.data)


def jacobians(machine: Machine, site: int) -> tuple[Array, Array]:
    """How a site moves and turns with each coordinate, (3, size) each, as the bodies stand."""
    moves, turns = np.zeros((3, machine.size)), np.zeros((3, machine.size))
    mujoco.mj_jacSite(machine.model, machine.data, moves, turns, site)
    return moves, turns


def loads(machine: Machine, at_tip: Array, forces: Sequence[Force] = ()) -> Array:
    """Generalised loads on all coordinates as the bodies stand: weight, a force at the tip, and further ones."""
    weight = np.zeros(machine.size)
    mujoco.mj_rne(machine.model, machine.data, 0, weight)
    total = jacobians(machine, machine.site("tip"))[0].T @ at_tip - weight
    for force in forces:
        for site, push, moment in force(machine):
            moves, turns = jacobians(machine, machine.site(site))
            total += moves.T @ push + turns.T @ moment
    return total


def settle(
    machine: Machine,
    rest: Array,
    compliance: Array,
    at_tip: Array,
    laws: Sequence[Law] = (),
    forces: Sequence[Force] = (),
) -> Rest:
    """Rest under load: x = rest + compliance * load(x) + laws(load(x)), by repeated substitution.

    It contracts by about deflection over length a round. Raises NotSettledError after 200 rounds.
    """
    x = rest.copy()
    for count in range(200):
        place(machine, x)
        load = loads(machine, at_tip, forces)
        new = rest + compliance * load
        for law in laws:
            for index, amount in law(load):
                new[index] += amount
        change = float(np.abs(new - x).max())
        x = new if count < 20 else 0.5 * (x + new)
        if change < 1e-12:
            break
    else:
        raise NotSettledError(f"{machine.arm.name}: still moving by {change:.1g} after 200 rounds")
    place(machine, x)
    tip = machine.site("tip")
    moves, turns = jacobians(machine, tip)
    return Rest(
        x, load, machine.data.site_xpos[tip].copy(), machine.data.site_xmat[tip].reshape(3, 3).copy(), moves, turns
    )
