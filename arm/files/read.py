"""arm.yaml to `Arm`: units, names and geometry are checked at this door, and only here."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import cast

from linkwright.core.arm.chain.chain import (
    STANDARD_GRAVITY,
    AngleConvention,
    Arm,
    EffectEntry,
    Joint,
    LoadCase,
    PlayMode,
    Statistics,
)
from linkwright.core.arm.chain.vectors import IDENTITY, ZERO
from linkwright.core.arm.effects import EFFECTS, Effect, Parameter, kind_at
from linkwright.core.materials.catalogue import Catalogue, load_catalogue
from linkwright.core.units.names import nearest
from linkwright.core.units.quantities import format_quantity, shown
from linkwright.core.units.reading import Mapping, load_yaml
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE

from .avoid import read_avoid
from .branches import read_branches, tip_named
from .chain_entries import joined, product_of_exponentials, read_entry, read_section
from .following import tied
from .heights import stood_up
from .origin import TURNS, read_vector
from .prices import read_machining

_ALSO_CALLED = MappingProxyType(
    {
        "chain": ("links", "joints", "segments"),
        "leave_out": ("without", "ignore", "exclude"),
        "tool": ("tcp", "end_effector"),
        "effects": ("physics", "errors"),
    }
)
"""What people call the keys of an arm file as well."""
_AS_WRITTEN = 1e-11
"""How far a quantity that was written and read may be from what it was, of it (`format_quantity`: 1e-12)."""


def read_arm(path: Path | str, catalogue: Catalogue | None = None, *, tip: str | None = None) -> Arm:
    """The arm that a YAML file describes (see docs/formats). Raises `InputError`, one line, for anything wrong.

    Of several arms on one torso `tip` names the one that counts (empty: the first); None: all of them do.
    """
    return arm_from(load_yaml(path), catalogue or load_catalogue(), tip=tip)


def arm_from(mapping: Mapping, catalogue: Catalogue, *, tip: str | None = None) -> Arm:
    """The arm that a mapping describes, to a `tip` where it has several; every key of it is accounted for."""
    with mapping.reading():
        mapping.also_called(_ALSO_CALLED)
        if mapping.content.get("arm") and not mapping.content.get("chain"):
            raise mapping.error("", "is a problem file; the arm file is the one that it names under `arm`")
        name = mapping.text("name", "arm")
        gravity = read_vector(mapping, "gravity", "acceleration", STANDARD_GRAVITY)
        angles = cast(AngleConvention, mapping.choice("angles", ("relative", "absolute"), "relative"))
        temperature = mapping.quantity("temperature", "temperature", REFERENCE_TEMPERATURE)
        chain = mapping.mappings("chain")
        entries = [read_entry(item, catalogue, number, len(chain)) for number, item in enumerate(chain, start=1)]
        if not entries:
            raise mapping.error("chain", "is empty; an arm has at least one joint with its link")
        if mapping.has("product_of_exponentials"):
            entries, tool = product_of_exponentials(mapping.mapping("product_of_exponentials"), entries)
        else:
            tool = ZERO
        joints, links = joined(mapping, entries)
        branches = read_branches(mapping, catalogue, len(joints))
        joints, links = (*joints, *branches.joints), (*links, *branches.links)
        every = tip is None and bool(branches.each)
        tip = tip_named(mapping, branches.each, tip or "")
        if mapping.has("tool"):
            with mapping.mapping("tool").reading() as offset:
                tool = read_vector(offset, "xyz", "length", ZERO)
        play, statistics = _play(mapping)
        left_out = _leave_out(mapping)
        if isinstance(mapping.content.get("payload"), str):
            raise mapping.error("payload", f"needs its keys: payload: {{mass: {mapping.text('payload')}}}")
        arm = Arm(
            name=name,
            joints=joints,
            links=links,
            gravity=gravity,
            gravity_given=mapping.has("gravity"),
            angles=angles,
            temperature=temperature,
            payload=read_load(mapping.mapping("payload")) if mapping.has("payload") else LoadCase(),
            play=play,
            statistics=statistics,
            leave_out=left_out,
            effects=read_effects(mapping, joints, left_out),
            tool=tool,
            machining=read_machining(mapping),
            branches=branches.each,
            avoid=read_avoid(mapping),
        )
        if branches.each:
            _refuse_with_branches(mapping, arm)
            for number, entry in enumerate(arm.effects, start=1):
                if EFFECTS[entry.effect].place == "tip":
                    message = f"{entry.effect} is of one tip, and there are several; write the branch's payload or tool"
                    raise mapping.error(f"effects[{number}].effect", message)
            arm = replace(arm, tool=branches.each[0].tool, payload=branches.each[0].payload)
            arm = replace(arm.on(tip), every_tip=every)
    _check_absolute(mapping, arm)
    return stood_up(mapping, tied(mapping, arm))


def _refuse_with_branches(mapping: Mapping, arm: Arm) -> None:
    """What an arm file with branches cannot hold beside them."""
    for number, link in enumerate(arm.links, start=1):
        if link.runs_out:
            raise mapping.error(
                "branches", f"go without bends_over, which joint {number} of all has; write each arm by itself"
            )


def read_load(mapping: Mapping) -> LoadCase:
    """What acts at the tip: mass, force and moment."""
    with mapping.reading():
        mapping.also_called({"mass": ("weight",), "moment": ("torque",)})
        return LoadCase(
            mass=mapping.not_negative("mass", "mass", 0.0),
            force=read_vector(mapping, "force", "force", ZERO),
            moment=read_vector(mapping, "moment", "moment", ZERO),
        )


def _play(mapping: Mapping) -> tuple[PlayMode, Statistics]:
    modes = ("worst", "loaded", "statistical")
    if not isinstance(mapping.content.get("play"), dict):
        return cast(PlayMode, mapping.choice("play", modes, "worst")), Statistics()
    with mapping.mapping("play").reading() as play:
        default = Statistics()
        statistics = Statistics(
            level=play.number("level", default.level),
            draws=play.integer("draws", default.draws),
            seed=play.integer("seed", default.seed),
        )
        if not 0.0 < statistics.level <= 1.0:
            raise play.error("level", "is a share of the draws: above 0, at most 1, e.g. 0.95")
        if not 10 <= statistics.draws <= 100_000:
            raise play.error("draws", "needs 10 to 100000 draws")
        if statistics.seed < 0:
            raise play.error("seed", "cannot be negative")
        return cast(PlayMode, play.choice("mode", modes)), statistics


def _leave_out(mapping: Mapping) -> frozenset[str]:
    names: list[str] = []
    for number, name in enumerate(mapping.items("leave_out", []), start=1):
        if name not in EFFECTS:
            raise mapping.error(
                f"leave_out[{number}]", f"there is no effect {shown(name)}{nearest(str(name), EFFECTS)}"
            )
        names.append(str(name))
    return frozenset(names)


def read_effects(
    mapping: Mapping, joints: tuple[Joint, ...], left_out: frozenset[str], key: str = "effects", *also_known: str
) -> tuple[EffectEntry, ...]:
    """The effects listed under a key, each with its places and parameters; keys of `also_known` are read elsewhere."""
    if not mapping.has(key):
        return ()
    entries: list[EffectEntry] = []
    for entry in mapping.mappings(key):
        with entry.reading(*also_known):
            name = entry.text("effect")
            if name not in EFFECTS:
                raise entry.error("effect", f"there is no effect '{name}'{nearest(name, EFFECTS)}")
            at = _places(entry, len(joints))
            _check_places(entry, EFFECTS[name], at, joints)
            slides = acts_on_slides(EFFECTS[name], at, joints)
            values = _triples(entry, EFFECTS[name])
            for parameter in EFFECTS[name].parameters:
                if entry.has(parameter.name):
                    kind = kind_at(parameter, slides=slides)
                    value = entry.quantity(parameter.name, kind)
                    values[parameter.name] = _within_limits(entry, parameter, kind, value)
                    if kind != kind_at(parameter, slides=True) and _mixed(EFFECTS[name], at, joints):
                        message = f"names slides too, whose {parameter.name} has another unit; write an entry for each"
                        raise entry.error("at", message)
            if (lacking := EFFECTS[name].lacking(values)) is not None:
                raise entry.error("effect", f"{name} moves nothing as it stands; give {lacking}")
            entries.append(EffectEntry(name, at, MappingProxyType(values)))
        if EFFECTS[name].automatic and not values and name not in left_out:
            message = f"{name} is in the model already; give what it adds, or leave it out of the rest (leave_out)"
            raise entry.error("effect", message)
    return tuple(entries)


def _triples(entry: Mapping, effect: Effect) -> dict[str, float]:
    """Parameters in x, y and z that are given as one list: `centre: [0 mm, 0 mm, 80 mm]`."""
    values: dict[str, float] = {}
    kinds = {parameter.name: parameter.kind for parameter in effect.parameters}
    for name in (kind.removesuffix("_x") for kind in kinds if kind.endswith("_x")):
        if f"{name}_z" in kinds and name not in kinds and entry.has(name):
            three = read_vector(entry, name, kinds[f"{name}_x"], ZERO)
            values |= {f"{name}_{axis}": value for axis, value in zip("xyz", three, strict=True)}
    return values


def _check_places(entry: Mapping, effect: Effect, at: tuple[int, ...], joints: tuple[Joint, ...]) -> None:
    if at and effect.place in ("base", "tip"):
        raise entry.error("at", f"{effect.id} acts at the {effect.place} as a whole; leave `at` out")
    for number in at:
        if effect.drive.needed and joints[number - 1].passive:
            raise entry.error("at", f"{effect.id} is of a drive, and joint {number} has none (passive)")
        if not effect.can_act(number - 1, revolute=joints[number - 1].revolute):
            raise entry.error("at", f"{effect.id} acts on {effect.only} only, which joint {number} is not among")


def _within_limits(entry: Mapping, parameter: Parameter, kind: str, value: float) -> float:
    """A parameter's value, at its limit where it is that as another unit writes it (0.15 rad as 8.59436692696 deg)."""
    given = shown(entry.content[parameter.name])
    if value < 0.0 <= parameter.lower or value == 0.0 < parameter.lower:
        bound = "must be positive" if parameter.lower > 0.0 else "cannot be negative"
        raise entry.error(parameter.name, f"{bound}, not {given}")
    at_limit = min(max(value, parameter.lower), parameter.upper)
    if not math.isclose(at_limit, value, rel_tol=_AS_WRITTEN):
        low, high = (format_quantity(bound, kind) for bound in (parameter.lower, parameter.upper))
        raise entry.error(parameter.name, f"must lie between {low} and {high}, not {given}")
    return at_limit


def _mixed(effect: Effect, at: tuple[int, ...], joints: tuple[Joint, ...]) -> bool:
    """Whether an effect on joints acts on some that turn and some that slide (from 1; none: all)."""
    named = [joints[number - 1].revolute for number in at] or [joint.revolute for joint in joints]
    return effect.place == "joint" and len(set(named)) > 1


def acts_on_slides(effect: Effect, at: tuple[int, ...], joints: tuple[Joint, ...]) -> bool:
    """Whether an effect's parameters are those of slides: all joints that it names (from 1; none: all) slide."""
    named = [joints[number - 1] for number in at] or list(joints)
    return effect.place == "joint" and not any(joint.revolute for joint in named)


def _places(entry: Mapping, size: int) -> tuple[int, ...]:
    if not entry.has("at"):
        return ()
    raw = entry.raw("at")
    numbers = raw if isinstance(raw, list) else [raw]
    for number in cast(list[object], numbers):
        if isinstance(number, bool) or not isinstance(number, int) or not 1 <= number <= size:
            raise entry.error("at", f"numbers joints or links from 1 to {size}, not {shown(number)}")
    return tuple(int(number) for number in cast(list[int], numbers))


def _check_absolute(mapping: Mapping, arm: Arm) -> None:
    if arm.angles == "relative":
        return
    if arm.branches:
        raise mapping.error("angles", "can be absolute only without branches; write relative")
    parallel = all(joint.axis == (0.0, 0.0, 1.0) for joint in arm.joints if joint.revolute)
    straight = all(link.end_rotation == IDENTITY for link in arm.links) and all(
        joint.origin_rotation == IDENTITY for joint in arm.joints
    )
    straight &= not any(part in TURNS for joint in arm.joints for part in joint.origin_free)
    if not (parallel and straight):
        raise mapping.error("angles", "can be absolute only where all revolute axes are parallel to z; write relative")


__all__ = ["arm_from", "read_arm", "read_effects", "read_load", "read_section"]
