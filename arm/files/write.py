"""`Arm` back to arm.yaml, with short units, so that what was read is what is written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml

from linkwright.core.arm.chain.chain import Arm, EffectEntry, FloatVector, GuideBeam, Joint, Link, LoadCase
from linkwright.core.arm.chain.vectors import IDENTITY, Rotation, to_roll_pitch_yaw
from linkwright.core.arm.effects import EFFECTS, kind_at
from linkwright.core.materials.material import Material
from linkwright.core.sections.section import Section
from linkwright.core.units.files import write_whole
from linkwright.core.units.quantities import format_quantity

from .avoid import avoid_to_list
from .following import following_text
from .heights import height_to_value
from .origin import origin_given, origin_to_value
from .prices import cost_to_value, machining_to_mapping
from .read import acts_on_slides
from .structures import stiffness_rows

_COUNTERBALANCES = MappingProxyType(
    {
        "torque": "torque",
        "greatest_at": "angle",
        "stiffness": "linear_stiffness",
        "on_link": "length",
        "on_base": "length",
        "base_at": "angle",
        "free_length": "length",
        "preload": "force",
    }
)
"""The kinds of quantity of a counterbalance's figures."""
_UNITS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "angle": ("deg", "arcmin", "mrad"),
        "length": ("mm", "um"),
        "angular_speed": ("deg/s", "rad/s"),
        "speed": ("mm/s", "m/s"),
    }
)
"""The units in which figures are tried."""


def arm_to_yaml(arm: Arm) -> str:
    """The arm as the text of an arm file."""
    lines = [f"name: {_flow(arm.name)}"]
    lines.append(f"gravity: {_flow(_vector(arm.gravity, 'acceleration'))}")
    lines.append(f"angles: {arm.angles}")
    lines.append(f"temperature: {format_quantity(arm.temperature, 'temperature')}")
    lines.append("chain:")
    motors = {mass.motor_of: (mass.mass, number) for number, link in enumerate(arm.links, 1) for mass in link.masses}
    torso = arm.branches[0].first if arm.branches else arm.size
    lines += _entries(arm, range(torso), motors)
    if arm.branches:
        lines.append("branches:")
    for branch in arm.branches:
        lines += [f"  - name: {_flow(branch.name)}", "    chain:"]
        lines += [f"    {line}" for line in _entries(arm, range(branch.first, branch.end), motors)]
        if any(branch.tool):
            lines.append(f"    tool: {_flow({'xyz': _vector(branch.tool, 'length')})}")
        lines.append(f"    payload: {_flow({'mass': format_quantity(branch.payload.mass, 'mass')})}")
    if any(arm.tool) and not arm.branches:
        lines.append(f"tool: {_flow({'xyz': _vector(arm.tool, 'length')})}")
    if work := machining_to_mapping(arm.machining):
        lines.append(f"machining: {_flow(work)}")
    if not arm.branches:
        lines.append(f"payload: {_flow(load_to_mapping(arm.payload))}")
    if arm.play == "statistical":
        statistics = arm.statistics
        play: object = {
            "mode": arm.play,
            "level": statistics.level,
            "draws": statistics.draws,
            "seed": statistics.seed,
        }
    else:
        play = arm.play
    lines.append(f"play: {_flow(play)}")
    if arm.leave_out:
        lines.append(f"leave_out: {_flow(sorted(arm.leave_out))}")
    if arm.effects:
        lines.append("effects:")
        lines += [f"  - {_flow(_effect(arm, entry))}" for entry in arm.effects]
    if arm.avoid:
        lines.append(f"avoid: {_flow(avoid_to_list(arm.avoid))}")
    return "\n".join(lines) + "\n"


def _entries(arm: Arm, indices: range, motors: Mapping[int | None, tuple[float, int]]) -> list[str]:
    lines: list[str] = []
    for index in indices:
        number, joint, link = index + 1, arm.joints[index], arm.links[index]
        entry = _joint(joint)
        if (follows := following_text(index, joint, indices[0] if arm.branches else 0)) is not None:
            entry["follows"] = follows
        mass, on = motors.get(number, (joint.motor_on_base, "base"))
        if mass:
            entry["motor"] = {"mass": format_quantity(mass, "mass"), "on": on}
        lines.append(f"  - joint: {_flow(entry)}")
        if origin_given(joint):
            lines.append(f"    origin: {_flow(origin_to_value(joint))}")
        lines.append(f"    link: {_flow(_link(link, number, height_to_value(arm, index)))}")
    return lines


def write_arm(arm: Arm, path: Path | str) -> None:
    """Write the arm file, whole or not at all."""
    write_whole(path, arm_to_yaml(arm))


def _flow(value: object) -> str:
    text = yaml.safe_dump(value, default_flow_style=True, width=10_000, sort_keys=False, allow_unicode=True)
    return text.replace("\n...\n", "\n").strip()


def _vector(vector: FloatVector, kind: str) -> list[str]:
    return [format_quantity(component, kind) for component in vector]


def load_to_mapping(load: LoadCase) -> dict[str, Any]:
    """A load case as the mapping of an arm file's `payload`."""
    out: dict[str, Any] = {"mass": format_quantity(load.mass, "mass")}
    out["force"] = _vector(load.force, "force")
    if any(load.moment):
        out["moment"] = _vector(load.moment, "moment")
    return out


def _joint(joint: Joint) -> dict[str, Any]:
    motion = "angle" if joint.revolute else "length"
    out: dict[str, Any] = {"name": joint.name} if joint.name else {}
    out["type"] = joint.type
    if joint.axis != ((0.0, 0.0, 1.0) if joint.revolute else (1.0, 0.0, 0.0)):
        out["axis"] = list(joint.axis)
    if joint.driven:
        out["range"] = [
            format_quantity(value, motion, "deg") if joint.revolute else _neatest(value, motion)
            for value in joint.range
        ]
    out |= _figures(("clearance", joint.clearance, 0.0, "length"))
    out |= _drive(joint, motion)
    if joint.cost is not None:
        out["cost"] = cost_to_value(joint.cost, joint.cost_date)
    if joint.passive:
        out["passive"] = True
    force = "torque" if joint.revolute else "force"
    out |= _figures(
        ("zero", joint.zero, 0.0, motion),
        ("effort", joint.effort, None, force),
        ("velocity", joint.velocity, None, "angular_speed" if joint.revolute else "speed"),
        ("rated_torque", joint.rated_torque, None, force),
        ("peak_torque", joint.peak_torque, None, force),
    )
    if joint.guide is not None:
        out["beam"] = _guide(joint.guide)
    if joint.counterbalance is not None:
        kinds = _COUNTERBALANCES
        out["balancer"] = {
            name: format_quantity(value, kinds[name]) for name, value in asdict(joint.counterbalance).items()
        }
    return out


def _drive(joint: Joint, motion: str) -> dict[str, str]:
    """The actuator, and of its figures those that the joint has otherwise, be they zero."""
    drive, stiffness = joint.actuator, "torsional_stiffness" if joint.revolute else "linear_stiffness"
    if drive is None:
        named, backlash, stiff, tilting, mass = {}, 0.0, None, None, 0.0
    else:
        stiff = drive.stiffness if joint.zones == drive.zones else None
        named, backlash, tilting, mass = {"actuator": drive.name}, drive.backlash, drive.tilting_stiffness, drive.mass
    return named | _figures(
        ("backlash", joint.backlash, backlash, motion),
        ("stiffness", joint.stiffness, stiff, stiffness),
        ("tilting_stiffness", joint.tilting_stiffness, tilting, "torsional_stiffness"),
        ("mass", joint.mass, mass, "mass"),
    )


def _guide(guide: GuideBeam) -> dict[str, Any]:
    return {
        "length": format_quantity(guide.length, "length"),
        "section": guide.section_name or section_to_mapping(guide.section),
        "material": material_to_value(guide.material),
        "supports": guide.supports,
        "rails": guide.rails,
        "begins_at": format_quantity(guide.begins_at, "length"),
        "height_direction": list(guide.height_direction),
    }


def _figures(*figures: tuple[str, float | None, float | None, str]) -> dict[str, str]:
    """By key those figures that are known and are not what is understood without them; each with its kind."""
    ways = {"backlash": _neatest, "velocity": _neatest}
    return {
        key: ways.get(key, format_quantity)(value, kind)
        for key, value, understood, kind in figures
        if value is not None and value != understood
    }


def _neatest(value: float, kind: str) -> str:
    """A quantity in whichever usual unit takes the fewest digits: `3.4 arcmin`, not 0.989019909463 mrad."""
    return min((format_quantity(value, kind, unit) for unit in _UNITS[kind]), key=lambda text: len(text.split()[0]))


def _angles(rotation: Rotation) -> list[str]:
    return [format_quantity(angle, "angle") for angle in to_roll_pitch_yaw(rotation)]


def _link(link: Link, number: int, height: object) -> dict[str, Any]:
    body: dict[str, Any] = {"name": link.name} if link.name else {}
    body["length"] = format_quantity(link.length, "length")
    if link.direction != (1.0, 0.0, 0.0):
        body["direction"] = list(link.direction)
    if link.end_rotation != IDENTITY:
        body["end_rotation"] = _angles(link.end_rotation)
    if height is not None:
        body["height_direction"] = height
    if link.runs_out:
        body["bends_over"] = f"q{number}"
    if link.section is not None and link.material is not None:
        body["section"] = link.section_name or section_to_mapping(link.section)
        body["material"] = material_to_value(link.material)
    else:
        if link.compliance is None:
            body["rigid"] = True
        else:
            body["stiffness"] = stiffness_rows(link.compliance)
        body["mass"] = "unknown" if link.mass is None else format_quantity(link.mass, "mass")
        if link.center_of_mass is not None:
            body["center_of_mass"] = format_quantity(link.center_of_mass, "length")
        if link.inertia is not None:
            body["inertia"] = _inertia(link.inertia)
    if link.flange is not None:
        stiffness = (*((name, value, None, "torsional_stiffness") for name, value in asdict(link.flange).items()),)
        body["flange"] = _figures(*stiffness)
    if link.cost is not None:
        body["cost"] = cost_to_value(link.cost, link.cost_date)
    if _masses(link):
        body["masses"] = _masses(link)
    return body


def _inertia(tensor: tuple[float, ...]) -> dict[str, str]:
    """Moments of inertia, and the products that are not zero."""
    named = zip(("xx", "yy", "zz", "xy", "xz", "yz"), tensor, strict=True)
    return {name: format_quantity(value, "inertia") for name, value in named if value or name[0] == name[1]}


def _masses(link: Link) -> list[dict[str, Any]]:
    """What hangs on a link but for joints' motors, which stand with their joints."""
    return [
        {"mass": format_quantity(mass.mass, "mass"), "at": _vector(mass.at, "length"), "on": mass.on}
        for mass in link.masses
        if mass.motor_of is None
    ]


def section_to_mapping(section: Section) -> dict[str, Any]:
    """A section as the mapping of an arm file."""
    out: dict[str, Any] = {"shape": section.shape}
    for name, value in section.given().items():
        out[name] = _dimension(value)
    return out


def _dimension(value: Any) -> Any:
    if isinstance(value, (tuple, list)):
        return [_dimension(item) for item in value]
    return format_quantity(float(value), "length")


def material_to_value(material: Material) -> Any:
    """A material as an arm file names it, or describes it in place."""
    return material.name if material.in_place is None else dict(material.in_place)


def _effect(arm: Arm, entry: EffectEntry) -> dict[str, Any]:
    out: dict[str, Any] = {"effect": entry.effect}
    if entry.at:
        out["at"] = list(entry.at)
    effect = EFFECTS[entry.effect]
    slides = acts_on_slides(effect, entry.at, arm.joints)
    kinds = {parameter.name: kind_at(parameter, slides=slides) for parameter in effect.parameters}
    for name, value in entry.parameters.items():
        out[name] = format_quantity(value, kinds[name])
    return out
