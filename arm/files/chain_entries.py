"""The entries of an arm file's chain: joints, links, sections, and the ways in which geometry can be given."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import cast

from linkwright.core.arm.actuators import Actuator, load_actuators
from linkwright.core.arm.chain.balance import PointMass
from linkwright.core.arm.chain.chain import FloatVector, Joint, JointType, Link, Zones
from linkwright.core.arm.chain.vectors import ZERO, Rotation, compose, from_roll_pitch_yaw, norm, snap_vector, unit
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.files.origin import along, is_modified, modified_dh, read_dh, standard_dh
from linkwright.core.arm.files.structures import read_flange, read_guide, running_out
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.sections import SHAPES, SectionError, load_stock
from linkwright.core.sections.section import Section
from linkwright.core.sections.taper import build_tapered
from linkwright.core.units.names import Known, meant
from linkwright.core.units.quantities import InputError, read_number, read_quantity, shown
from linkwright.core.units.reading import Mapping

from .balance import Motor, read_counterbalance, read_masses, read_motor
from .following import read_following
from .heights import UP
from .origin import read_origin, read_vector
from .prices import read_cost
from .structures import read_stiffness

_AXES = MappingProxyType({"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)})

_JOINT_CALLED = MappingProxyType(
    {
        "range": ("limits", "limit", "travel", "bounds", "joint_limits"),
        "stiffness": ("torsional_stiffness", "rigidity", "compliance", "spring_rate"),
        "mass": ("weight",),
        "backlash": ("lost_motion", "slack"),
        "clearance": ("gap", "bearing_play", "play"),
        "actuator": ("drive", "gearbox", "gear"),
        "rated_torque": ("nominal_torque", "continuous_torque", "rated_force"),
        "peak_torque": ("max_torque", "maximum_torque", "peak_force"),
        "zero": ("offset", "home"),
    }
)
"""What people call the keys of a joint as well."""
_TYPES = MappingProxyType(
    {
        "revolute": Known(("hinge", "rotary", "rotational", "rotation", "pivot", "pin", "continuous")),
        "prismatic": Known(("linear", "translational", "translation", "slider")),
        "slide": None,
    }
)
"""Types of joints, with what people call them as well."""
_AN_EFFECT = "it is an effect, which stands in the arm file's list `effects`"
_LINK_CALLED = MappingProxyType(
    {
        "length": ("l", "len"),
        "section": ("shape", "profile", "cross_section", "beam"),
        "mass": ("weight",),
        "center_of_mass": ("centre_of_mass", "com", "centre", "center"),
        "cost": ("price",),
    }
)
"""What people call the keys of a link as well."""


@dataclass(frozen=True)
class Entry:
    """One entry of the chain as read, before neighbours are joined up."""

    joint: Joint
    link: Link
    length_given: bool
    origin: tuple[Rotation, FloatVector] | None
    """The fixed transform in front of the joint."""
    has_link: bool = False
    modified_dh: bool = False
    motor: Motor | None = None

    @property
    def shift_free(self) -> bool:
        """Whether nobody knows where the joint stands, so that the link before cannot run to it."""
        return any(part in ("x", "y", "z") for part in self.joint.origin_free)


def read_entry(mapping: Mapping, catalogue: Catalogue, number: int, size: int) -> Entry:
    """A joint (its number from 1) and the link that it carries, of an arm of so many."""
    with mapping.reading():
        joint, motor = _joint(mapping.mapping("joint"), size, catalogue)
        if joint.guide is not None and number > 1:
            message = "is of an arm's first slide; what carries a beam farther out is not in the model"
            raise mapping.error("joint.beam", message)
        has_link = mapping.has("link")
        body = mapping.mapping("link") if has_link else None
        given = body is not None and body.has("length")
        origin, modified = None, is_modified(mapping)
        if mapping.has("dh"):
            joint, link, origin = _of_dh(mapping, body, joint, modified=modified)
            given = given or not modified
        else:
            link = Link(body.not_negative("length", "length") if body is not None and given else 0.0)
        link = replace(link, mass=0.0) if body is None else _link(body, link, catalogue)
        if body is not None and body.has("bends_over"):
            link = running_out(body, joint, link, number)
        if mapping.has("origin"):
            if modified:
                raise mapping.error("origin", "is given by dh already, which says where the joint stands; leave it out")
            origin, free = read_origin(mapping)
            joint = replace(joint, origin_free=free)
    return Entry(joint, link, given, origin, has_link, modified, motor)


def _of_dh(
    mapping: Mapping, body: Mapping | None, joint: Joint, *, modified: bool
) -> tuple[Joint, Link, tuple[Rotation, FloatVector] | None]:
    """The joint, its link and the transform in front of it by Denavit-Hartenberg parameters. Raises `InputError` for
    what stands beside them and contradicts."""
    raw = mapping.content["joint"]
    if isinstance(raw, dict) and "axis" in raw:
        raise mapping.error("joint.axis", "is z by dh already, for joints and slides; leave it out")
    for name in ("direction", "end_rotation", *(("length",) if modified else ())):
        if body is not None and body.has(name):
            raise body.error(name, "is given by dh already; leave it out")
    row = read_dh(mapping.mapping("dh"))
    if modified:
        origin, joint = modified_dh(row, joint)
        return joint, Link(0.0), origin
    joint, link = standard_dh(row, joint)
    if body is not None and body.has("length") and abs(body.quantity("length", "length") - link.length) > 1e-9:
        raise body.error("length", "is given by dh already (from a and d); leave it out")
    return joint, link, None


def _joint(mapping: Mapping, size: int, catalogue: Catalogue) -> tuple[Joint, Motor | None]:
    with mapping.reading():
        mapping.also_called(_JOINT_CALLED)
        mapping.elsewhere(EFFECTS, _AN_EFFECT)
        motor = read_motor(mapping, size)
        word = mapping.choice("type", _TYPES, "revolute")
        kind = cast(JointType, "prismatic" if word == "slide" else word)
        turns = kind == "revolute"
        motion = "angle" if turns else "length"
        follows = read_following(mapping, size, turns=turns)
        limits = _range(mapping, turns, follows=follows is not None)
        actuator = _actuator(mapping, turns)
        stiffness, zones = _stiffness(mapping, turns, actuator)
        _require_known(mapping, actuator)
        cost, cost_date = read_cost(mapping)
        rated, peak = _rating(mapping, turns)
        axis = _axis(mapping, "z" if turns else "x")
        if turns and mapping.has("beam"):
            raise mapping.error("beam", "is of a slide that runs along it; write type: prismatic, or leave it out")
        guide = read_guide(mapping, catalogue, _section, axis, limits)
        joint = Joint(
            type=kind,
            axis=axis,
            range=limits,
            clearance=mapping.not_negative("clearance", "length", 0.0),
            backlash=mapping.not_negative("backlash", motion, (actuator and actuator.backlash) or 0.0),
            stiffness=stiffness,
            mass=mapping.not_negative("mass", "mass", (actuator and actuator.mass) or 0.0),
            zero=mapping.quantity("zero", motion, 0.0),
            actuator=actuator,
            zones=zones,
            counterbalance=read_counterbalance(mapping) if _balanced(mapping, turns) else None,
            motor_on_base=0.0 if motor is None or motor.on else motor.mass,
            follows=follows,
            cost=cost,
            cost_date=cost_date,
            passive=_passive(mapping),
            name=mapping.text("name", ""),
            effort=_greatest(mapping, "effort", "torque" if turns else "force"),
            velocity=_greatest(mapping, "velocity", "angular_speed" if turns else "speed"),
            tilting_stiffness=_tilting(mapping, turns, actuator),
            rated_torque=rated,
            peak_torque=peak,
            guide=guide,
        )
        return joint, motor


def _range(mapping: Mapping, turns: bool, *, follows: bool) -> tuple[float, float]:
    """The joint's range: the file's, a whole turn, or that of a slide which follows other joints."""
    if mapping.has("range"):
        return mapping.range("range", "angle" if turns else "length")
    if not turns and not follows:
        raise mapping.error("range", "is missing; a slide needs its range, e.g. [0 mm, 500 mm]")
    return (-math.pi, math.pi) if turns else (0.0, 0.0)


def _stiffness(mapping: Mapping, turns: bool, actuator: Actuator | None) -> tuple[float | None, Zones]:
    """The drive's stiffness, the file's or the actuator's, and the zones of the latter."""
    stiffness = mapping.optional_quantity("stiffness", "torsional_stiffness" if turns else "linear_stiffness")
    if stiffness is not None and stiffness <= 0.0:
        raise mapping.error("stiffness", "must be positive; leave it out for a rigid drive")
    if actuator is None or stiffness is not None:
        return stiffness, ()
    return actuator.stiffness, actuator.zones


def _greatest(mapping: Mapping, name: str, kind: str) -> float | None:
    """The most that a drive gives; none where the file does not say it."""
    return mapping.not_negative(name, kind, 0.0) if mapping.has(name) else None


def _rating(mapping: Mapping, turns: bool) -> tuple[float | None, float | None]:
    """What the drive gives at the joint for long and for a moment."""
    names = ("rated_torque", "peak_torque")
    rated, peak = (mapping.optional_quantity(name, "torque" if turns else "force") for name in names)
    for name, value in zip(names, (rated, peak), strict=True):
        if value is not None and value <= 0.0:
            raise mapping.error(name, "must be positive; leave it out where it is not known")
    if rated is not None and peak is not None and peak < rated:
        raise mapping.error("peak_torque", "is below rated_torque, which the drive gives for long; swap them")
    return rated, peak


def _passive(mapping: Mapping) -> bool:
    if not mapping.boolean("passive", False):
        return False
    for name in ("actuator", "stiffness", "backlash", "balancer", "motor", "rated_torque", "peak_torque"):
        if mapping.has(name):
            raise mapping.error(name, "is of a drive, and a passive joint has none; leave it or `passive` out")
    return True


def _require_known(mapping: Mapping, actuator: Actuator | None) -> None:
    """Refuse an actuator of which figures are unknown that its joint does not give."""
    units = {"stiffness": "N*m/rad", "backlash": "arcmin", "mass": "kg"}
    lacking = [name for name in (() if actuator is None else actuator.lacks(*units)) if not mapping.has(name)]
    if lacking:
        would_do = ", ".join(f"{name}: ... {units[name]}" for name in lacking)
        message = f"is not known of {mapping.text('actuator')}; write `{would_do}` beside the actuator"
        raise mapping.error(lacking[0], message)


def _tilting(mapping: Mapping, turns: bool, actuator: Actuator | None) -> float | None:
    """The stiffness of the joint's bearing against tilting: the file's, or that of the actuator."""
    value = mapping.optional_quantity("tilting_stiffness", "torsional_stiffness")
    if value is None:
        return None if actuator is None else actuator.tilting_stiffness
    if not turns:
        would_do = "of a slide write rail_pitch under `effects`"
        raise mapping.error("tilting_stiffness", f"is of the bearing of a joint that turns; {would_do}")
    if value <= 0.0:
        raise mapping.error("tilting_stiffness", "must be positive; leave it out for a rigid bearing")
    return value


def _balanced(mapping: Mapping, turns: bool) -> bool:
    if mapping.has("balancer") and not turns:
        raise mapping.error("balancer", "takes a torque off a joint that turns; a slide has none")
    return mapping.has("balancer")


def _actuator(mapping: Mapping, turns: bool) -> Actuator | None:
    """The actuator that a joint names; keys beside it win over its figures."""
    if not mapping.has("actuator"):
        return None
    name = mapping.text("actuator")
    if not turns:
        raise mapping.error("actuator", "turns, so it cannot drive a slide; give stiffness, backlash and mass")
    return load_actuators().find(name, file=mapping.file, key=mapping.path_of("actuator"))


def _axis(mapping: Mapping, default: str) -> FloatVector:
    raw = mapping.raw("axis") if mapping.has("axis") else default
    if isinstance(raw, str) and raw.lstrip("+-") in _AXES:
        x, y, z = _AXES[raw.lstrip("+-")]
        sign = -1.0 if raw.startswith("-") else 1.0
        return snap_vector((sign * x, sign * y, sign * z))
    if isinstance(raw, list) and len(cast(list[object], raw)) == 3:
        numbers = [
            read_number(value, file=mapping.file, key=f"{mapping.path_of('axis')}[{number}]")
            for number, value in enumerate(cast(list[object], raw), start=1)
        ]
        if norm((numbers[0], numbers[1], numbers[2])) > 0.0:
            return unit((numbers[0], numbers[1], numbers[2]))
    raise mapping.error("axis", f"is x, y, z (or -x ..), or three numbers such as [0, 0, 1], not {shown(raw)}")


def _link(mapping: Mapping, link: Link, catalogue: Catalogue) -> Link:
    with mapping.reading("length", "bends_over"):
        mapping.also_called(_LINK_CALLED)
        mapping.elsewhere(EFFECTS, _AN_EFFECT)
        if mapping.has("masses"):
            link = replace(link, masses=read_masses(mapping))
        flange, weight = read_flange(mapping)
        link = replace(link, flange=flange, masses=(*link.masses, *weight))
        cost, cost_date = read_cost(mapping)
        link = replace(link, cost=cost, cost_date=cost_date, name=mapping.text("name", ""))
        rigid = mapping.boolean("rigid", False)
        link = _height(mapping, link)
        direction = read_vector(mapping, "direction", "dimensionless", ZERO)
        if any(direction):
            link = replace(link, direction=unit(direction))
        if mapping.has("end_rotation"):
            turn = mapping.vector("end_rotation", "angle", 3)
            link = replace(link, end_rotation=from_roll_pitch_yaw(turn[0], turn[1], turn[2]))
        if mapping.has("section"):
            if rigid:
                raise mapping.error("rigid", "contradicts section: a link with a section gives")
            if mapping.has("stiffness"):
                raise mapping.error("stiffness", "is what section and material say already; leave one of them out")
            if mapping.has("inertia"):
                raise mapping.error("inertia", "is that of section and material already; leave it out")
            section, name = _section(mapping)
            raw = mapping.raw("material", "a material's name, e.g. steel-s355")
            material = catalogue.read(raw, file=mapping.file, key=mapping.path_of("material"))
            return replace(link, section=section, section_name=name, material=material)
        if mapping.has("material"):
            raise mapping.error("section", "is missing; a link with a material needs its section")
        compliance = read_stiffness(mapping)
        if compliance is not None and rigid:
            raise mapping.error("rigid", "contradicts stiffness: a link with a stiffness gives")
        if compliance is not None and (link.length == 0.0 or mapping.content.get("mass") in (None, "unknown")):
            name = "mass" if link.length else "length"
            raise mapping.error(name, "of a link with a stiffness must be known; write it beside that")
        link = replace(link, compliance=compliance)
        if not rigid and not mapping.has("mass"):
            raise mapping.error("section", "is missing; write section and material, or rigid: true and mass")
        if mapping.content.get("mass") == "unknown":
            mapping.has("mass")
            mass = None
        else:
            mass = mapping.not_negative("mass", "mass", 0.0)
        center = mapping.optional_quantity("center_of_mass", "length")
        if mapping.has("inertia"):
            if mass is None:
                raise mapping.error(
                    "inertia", "goes with a mass that is known; leave it out, or write mass: 1.2 kg, say"
                )
            link = replace(link, inertia=_inertia(mapping.mapping("inertia")))
        return replace(link, mass=mass, center_of_mass=center)


def _height(mapping: Mapping, link: Link) -> Link:
    """The link with its section's height where the file says: up (see `stood_up`), or a vector in the link's frame."""
    direction = mapping.content.get("height_direction")
    if isinstance(direction, str):
        if mapping.text("height_direction") != UP:
            raise mapping.error(
                "height_direction", f"is {UP}, or a vector in the link's frame, e.g. [0, 0, 1], not {shown(direction)}"
            )
        return replace(link, height_up=True)
    height = read_vector(mapping, "height_direction", "dimensionless", ZERO)
    return replace(link, height_direction=unit(height)) if any(height) else link


def _inertia(mapping: Mapping) -> tuple[float, float, float, float, float, float]:
    """Moments of inertia, and products where there are any, about the centre of what weighs on a link."""
    with mapping.reading():
        xx, yy, zz = (mapping.quantity(name, "inertia") for name in ("xx", "yy", "zz"))
        xy, xz, yz = (mapping.quantity(name, "inertia", 0.0) for name in ("xy", "xz", "yz"))
    return xx, yy, zz, xy, xz, yz


def _section(mapping: Mapping) -> tuple[Section, str | None]:
    raw = mapping.raw("section")
    if isinstance(raw, str):
        if shape := meant(raw, SHAPES, 1.0):
            due = ", ".join(f"{item.name}: ..." for item in SHAPES[shape].dimensions if not item.optional)
            raise mapping.error("section", f"lacks its dimensions; write {{shape: {shape}, {due}}}")
        size = load_stock().find(raw, file=mapping.file, key=mapping.path_of("section"))
        return size.section, size.name
    if not isinstance(raw, dict):
        raise mapping.error("section", f"needs a shape, e.g. {{shape: circle, diameter: 100 mm}}, not {shown(raw)}")
    body = mapping.mapping("section")
    if "height_direction" in body.content:
        would_do = "write it beside section: link: {section: {...}, height_direction: up}"
        raise body.error("height_direction", f"is of the link, not of its section; {would_do}")
    return read_section(body), None


def read_section(body: Mapping) -> Section:
    """The section that a mapping describes: its shape and dimensions, pairs (joint, far end) where it is tapered."""
    shape = body.text("shape")
    dimensions: dict[str, object] = {}
    for name, value in body.content.items():
        if name != "shape" and body.has(name):
            dimensions[name] = _dimension(body, name, value)
    try:
        return build_tapered(shape, dimensions)
    except SectionError as error:
        raise InputError(body.file, body.path_of(error.key), error.message) from None


def _dimension(body: Mapping, name: str, value: object) -> object:
    """A length, or nested lists of lengths (the points of a polygon)."""
    if isinstance(value, list):
        return [
            _nested(item, body.file, f"{body.path_of(name)}[{k}]")
            for k, item in enumerate(cast(list[object], value), 1)
        ]
    return read_quantity(value, "length", file=body.file, key=body.path_of(name))


def _nested(value: object, file: object, key: str) -> object:
    if isinstance(value, list):
        return [_nested(item, file, f"{key}[{k}]") for k, item in enumerate(cast(list[object], value), 1)]
    return read_quantity(value, "length", file=file, key=key)


def product_of_exponentials(mapping: Mapping, entries: list[Entry]) -> tuple[list[Entry], FloatVector]:
    """Axes H and offsets P of an arm at zero: P[0] from the base to joint 1, .., P[n] from joint n to the tip."""
    with mapping.reading():
        axes, offsets = mapping.items("axes"), mapping.items("offsets")
        count = len(entries)
        if len(axes) != count or len(offsets) != count + 1:
            raise mapping.error("", f"needs {count} axes and {count + 1} offsets for {count} joints")
        path = mapping.path_of("axes")
        directions = [
            _triple(axis, "dimensionless", mapping.file, f"{path}[{k}]") for k, axis in enumerate(axes, start=1)
        ]
        path = mapping.path_of("offsets")
        steps = [_triple(step, "length", mapping.file, f"{path}[{k}]") for k, step in enumerate(offsets, start=1)]
    results: list[Entry] = []
    for index, entry in enumerate(entries):
        if entry.length_given or entry.origin is not None:
            raise mapping.error("", f"contradicts chain[{index + 1}], which gives a length, dh or origin of its own")
        if norm(directions[index]) == 0.0:
            raise mapping.error("axes", "holds an axis without direction")
        joint = replace(entry.joint, axis=unit(directions[index]))
        if index == 0:
            joint = replace(joint, origin_translation=steps[0])
        results.append(Entry(joint, along(steps[index + 1], entry.link), True, None, motor=entry.motor))
    return results, ZERO


def _triple(value: object, kind: str, file: object, key: str) -> FloatVector:
    if not isinstance(value, list) or len(cast(list[object], value)) != 3:
        raise InputError(file, key, f"needs three components, not {shown(value)}")
    x, y, z = (read_quantity(part, kind, file=file, key=key) for part in cast(list[object], value))
    return (x, y, z)


def joined(mapping: Mapping, entries: list[Entry]) -> tuple[tuple[Joint, ...], tuple[Link, ...]]:
    """Joints and links with origins shared out: a link without a length runs to the next joint's origin."""
    joints: list[Joint] = []
    links: list[Link] = []
    for index, entry in enumerate(entries):
        joint = entry.joint
        _check_length(mapping, entries, index)
        if entry.origin is not None:
            rotation, xyz = entry.origin
            joint = replace(joint, origin_rotation=compose(rotation, joint.origin_rotation))
            if index > 0 and not entries[index - 1].length_given and not entry.shift_free:
                links[-1] = along(xyz, links[-1])
            else:
                joint = replace(joint, origin_translation=snap_vector(xyz))
        joints.append(joint)
        links.append(entry.link)
    for number, entry in enumerate(entries, start=1):
        if entry.motor is not None and entry.motor.on:
            link = links[entry.motor.on - 1]
            motor = PointMass(entry.motor.mass, motor_of=number)
            links[entry.motor.on - 1] = replace(link, masses=(*link.masses, motor))
    return tuple(joints), tuple(links)


def _check_length(mapping: Mapping, entries: list[Entry], index: int) -> None:
    """Refuse an entry (from 0) whose link has no length, or two."""
    entry = entries[index]
    after = entries[index + 1] if index + 1 < len(entries) else None
    runs_on = after is not None and after.origin is not None and not after.shift_free
    if entry.modified_dh and index and entries[index - 1].length_given:
        raise mapping.error(f"chain[{index + 1}].dh", "is modified, but the entry before gives a length of its own")
    if entry.has_link and not entry.length_given and not runs_on and not entry.modified_dh:
        would_do = "write length: 400 mm, say (0 mm for none)"
        if after is not None and after.shift_free:
            would_do = f"the next joint's origin is free and does not say it; {would_do}"
        raise mapping.error(f"chain[{index + 1}].link.length", f"is missing; {would_do}")
