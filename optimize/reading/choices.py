"""`choose` of a problem file: shapes, materials, sizes and actuators of each link and joint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar, cast

from linkwright.core.arm.actuators import Actuator, load_actuators
from linkwright.core.arm.chain.chain import Arm, Joint
from linkwright.core.materials.catalogue import Catalogue
from linkwright.core.materials.material import Material
from linkwright.core.optimize.choice.driven import kept_figures
from linkwright.core.optimize.reading.by_link import ByLink, by_link
from linkwright.core.optimize.reading.called import CHOICES_CALLED
from linkwright.core.optimize.reading.conditions import materials_where
from linkwright.core.optimize.reading.contradictions import can_be_chosen
from linkwright.core.optimize.reading.ranges import Ranges
from linkwright.core.optimize.sizes.listed import Listed, read_sizes
from linkwright.core.sections import SHAPES
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import shown
from linkwright.core.units.reading import Mapping

Item = TypeVar("Item")


@dataclass(frozen=True)
class LinkLists:
    """The shapes and materials of a link's own; None where it may be of all that the problem names."""

    shapes: tuple[str, ...] | None
    materials: tuple[Material, ...] | None


def read_choices(
    mapping: Mapping,
    catalogue: Catalogue,
    arm: Arm,
    needs: frozenset[str],
    ranges: Sequence[Ranges],
) -> tuple[
    tuple[str, ...] | None,
    tuple[Material, ...] | None,
    tuple[LinkLists, ...] | None,
    frozenset[str],
    tuple[tuple[Actuator, ...], ...] | None,
    tuple[tuple[Listed, ...], ...] | None,
]:
    """The shapes and materials that any link may be of, those of each link's own, what must be the same, each joint's
    actuators, and each link's sizes; None where nothing is said. `needs` are properties that materials must have.
    Raises `InputError`."""
    if not mapping.has("choose"):
        return None, None, None, frozenset(), None, None
    with mapping.mapping("choose").reading("balancer", "base", "counterweight", "motor") as body:
        body.also_called(CHOICES_CALLED)
        shapes = by_link(body, "section", arm, _shapes)
        materials = by_link(body, "material", arm, lambda item, key: _materials(item, key, catalogue, arm, needs))
        same = body.items("same", [])
        for name in same:
            if name not in ("section", "material", "size", "actuator"):
                raise body.error("same", f"takes section, material, size and actuator, not {shown(name)}")
        uniform = shapes.alike and materials.alike
        lists = None if uniform else tuple(map(LinkLists, shapes.each, materials.each))
        sizes = read_sizes(body, arm, shapes.each, ranges)
        agree = frozenset(str(name) for name in same)
        return _all(shapes), _all(materials), lists, agree, _actuators(body, arm), sizes


def _all(by_link: ByLink[tuple[Item, ...]]) -> tuple[Item, ...] | None:
    """What any link may be; None where nothing is said."""
    return tuple(dict.fromkeys(item for entry in by_link.each for item in entry or ())) or None


def _shapes(body: Mapping, key: str) -> tuple[str, ...]:
    names = _names(body, key)
    free = {name: kind for name, kind in SHAPES.items() if can_be_chosen(name)}
    for number, name in enumerate(names, start=1):
        if name in SHAPES and name not in free:
            would_do = "name stock sizes without a shape: choose: {sizes: [...]}"
            raise body.error(f"{key}[{number}]", f"the dimensions of a {name} cannot be chosen; {would_do}")
        if name not in free:
            raise body.error(f"{key}[{number}]", f"there is no shape '{name}' to choose{nearest(name, free)}")
    return tuple(dict.fromkeys(names))


def _materials(body: Mapping, name: str, catalogue: Catalogue, arm: Arm, needs: frozenset[str]) -> tuple[Material, ...]:
    """The materials to choose from, by name, in place, or by their properties."""
    values = body.raw(name)
    entries = cast(list[object], values) if isinstance(values, list) else [values]
    if not entries:
        raise body.error(name, "is empty; name at least one material")
    read: list[Material] = []
    for number, entry in enumerate(entries, start=1):
        key = body.path_of(name if entry is values else f"{name}[{number}]")
        if isinstance(entry, dict) and "where" in entry:
            with Mapping(cast(object, entry), file=body.file, key=key).reading() as conditions:
                read += materials_where(conditions, catalogue, arm, needs)
        else:
            read.append(catalogue.read(entry, file=body.file, key=f"{body.path_of(name)}[{number}]"))
    materials = tuple(dict.fromkeys(read))
    for material in materials:
        if any(other.name == material.name and other != material for other in materials):
            message = f"calls two materials {material.name}; give each a name of its own (name: ...)"
            raise body.error(name, message)
    return materials


def _actuators(body: Mapping, arm: Arm) -> tuple[tuple[Actuator, ...], ...] | None:
    """What each joint's drive may be: one list for all joints that turn, or a list for each joint."""
    if not body.has("actuator"):
        return None
    raw = body.raw("actuator")
    entries = cast(list[object], raw) if isinstance(raw, list) else [raw]
    if not any(isinstance(entry, list) for entry in entries):
        entries = [entries if joint.revolute else [] for joint in arm.joints]
    if len(entries) != arm.size:
        raise body.error("actuator", f"is one list of names, or a list for each of the {arm.size} joints")
    known, path = load_actuators(), body.path_of("actuator")
    actuators: list[tuple[Actuator, ...]] = []
    for number, (entry, joint) in enumerate(zip(entries, arm.joints, strict=True), start=1):
        names = cast(list[object], entry) if isinstance(entry, list) else [entry]
        if not all(isinstance(name, str) for name in names):
            raise body.error("actuator", f"needs names, e.g. [RV-20E, RV-40E], not {shown(entry)}")
        if names and not joint.revolute:
            raise body.error("actuator", f"joint {number} slides, and no actuator drives a slide; write [] for it")
        chosen = [known.find(str(name), file=body.file, key=path) for name in names]
        for item in chosen:
            _check_figures(body, joint, number, item)
        actuators.append(tuple({actuator.name: actuator for actuator in chosen}.values()))
    if not any(actuators):
        raise body.error("actuator", "is empty; name at least one actuator")
    return tuple(actuators)


def _check_figures(body: Mapping, joint: Joint, number: int, actuator: Actuator) -> None:
    """Whether all that a drive needs is known, by the catalogue or by the joint."""
    kept = kept_figures(joint)
    needed = actuator.lacks("rated_torque", "stiffness", "backlash", "mass")
    if unknown := [key for key in needed if key not in kept]:
        missing = ", ".join(unknown).replace("_", " ")
        beside = ", ".join(f"{key}: ..." for key in unknown)
        message = f"cannot choose {actuator.name}, whose {missing} the catalogue does not know"
        would_do = f"write `actuator: {actuator.name}, {beside}` at joint {number} of the arm file"
        raise body.error("actuator", f"{message}; {would_do}")


def _names(body: Mapping, key: str) -> list[str]:
    raw = body.raw(key)
    entries = cast(list[object], raw) if isinstance(raw, list) else [raw]
    if not entries or not all(isinstance(entry, str) for entry in entries):
        raise body.error(key, f"needs names, e.g. [circle, tube], not {shown(raw)}")
    return [str(entry) for entry in entries]
