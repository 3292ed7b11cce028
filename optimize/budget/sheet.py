"""What data sheets say beyond the arm file: tolerances, repeatability, temperature, and parts to be had."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from types import MappingProxyType

from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.files.read import read_effects
from linkwright.core.optimize.uncertain import FACTORS, Uncertain, read_widths
from linkwright.core.units.quantities import read_number, shown
from linkwright.core.units.reading import Mapping

SHARE, DRAWS, SEED = 0.95, 500, 20
_MOST_DRAWS = 20_000

Changed = Callable[[Iterable[tuple[str, object]]], Arm]
"""The arm with keys of its file changed, such as `chain[2].joint.backlash`."""


@dataclass(frozen=True)
class Tolerance:
    """An effect whose parameters may be off by so much either way, at each of its places on its own; `each_time`: anew
    at every pose (an encoder's counts), not once for each arm (a length)."""

    entry: EffectEntry
    each_time: bool = False


@dataclass(frozen=True)
class Option:
    """A part that could be bought: the arm and the data sheet with it, and what it costs more (EUR; None: not said)."""

    name: str
    price: float | None
    arm: Arm
    sheet: Sheet


@dataclass(frozen=True)
class Sheet:
    """What is known of how arms of one make differ. `repeatability` (m) is the tip's as ISO 9283 counts it,
    `temperature` (K) how far from the arm's it may be either way. `share` of all arms is to be no worse than what is
    told, from `draws` seeded arms."""

    tolerances: tuple[Tolerance, ...] = ()
    uncertain: Uncertain | None = None
    repeatability: float = 0.0
    temperature: float = 0.0
    share: float = SHARE
    draws: int = DRAWS
    seed: int = SEED
    options: tuple[Option, ...] = ()


def read_sheet(mapping: Mapping, arm: Arm, changed: Changed) -> Sheet:
    """A data sheet for an arm. Raises `InputError`, one line, for anything wrong."""
    with mapping.reading():
        share = SHARE
        if mapping.has("share"):
            share = read_number(mapping.raw("share"), file=mapping.file, key=mapping.path_of("share"))
            if not 0.5 <= share < 1.0:
                raise mapping.error("share", f"is from 50 % to below 100 %, not {shown(mapping.raw('share'))}")
        draws, seed = mapping.integer("draws", DRAWS), mapping.integer("seed", SEED)
        if not 20 <= draws <= _MOST_DRAWS:
            raise mapping.error("draws", f"needs 20 to {_MOST_DRAWS}")
        if seed < 0:
            raise mapping.error("seed", "cannot be negative")
        sheet = Sheet(
            tuple(_tolerances(mapping, arm)),
            _uncertain(mapping, arm, share),
            _positive(mapping, "repeatability", "length"),
            _positive(mapping, "temperature", "temperature_difference"),
            share,
            draws,
            seed,
        )
        options = tuple(_option(item, arm, sheet, changed) for item in _listed(mapping, "better"))
    return replace(sheet, options=options)


def _listed(mapping: Mapping, key: str) -> list[Mapping]:
    return list(mapping.mappings(key)) if mapping.has(key) else []


def _positive(mapping: Mapping, name: str, kind: str) -> float:
    value = mapping.quantity(name, kind, 0.0)
    if value < 0.0:
        raise mapping.error(name, "cannot be negative")
    return value


def _tolerances(mapping: Mapping, arm: Arm) -> list[Tolerance]:
    entries = read_effects(mapping, arm.joints, frozenset(EFFECTS), "tolerances", "each_time")
    tolerances: list[Tolerance] = []
    for entry, body in zip(entries, _listed(mapping, "tolerances"), strict=True):
        effect = EFFECTS[entry.effect]
        if (
            not effect.sizes
            or not effect.linear
            or effect.requires
            or effect.automatic
            or effect.recording.of_instrument
        ):
            known = sorted(name for name, item in EFFECTS.items() if _can_be_off(name) and item.linear)
            raise body.error("effect", f"{entry.effect} is no tolerance; those are {', '.join(known)}")
        tolerances.append(Tolerance(entry, body.boolean("each_time", False)))
    return tolerances


def _can_be_off(name: str) -> bool:
    effect = EFFECTS[name]
    return bool(effect.sizes) and not (
        effect.requires or effect.automatic or effect.recording.of_instrument or effect.link.flexible
    )


def _uncertain(mapping: Mapping, arm: Arm, share: float) -> Uncertain | None:
    if not mapping.has("uncertain"):
        return None
    with mapping.mapping("uncertain").reading() as body:
        return Uncertain(MappingProxyType({name: read_widths(body, name, arm) for name in FACTORS}), share)


def _option(body: Mapping, arm: Arm, sheet: Sheet, changed: Changed) -> Option:
    with body.reading():
        name = body.text("part")
        price = body.optional_quantity("price", "cost")
        if price is not None and price <= 0.0:
            raise body.error("price", "must be positive; leave it out where it is not known")
        numbers = _places(body, arm)
        keys: list[tuple[str, object]] = []
        for part in ("joint", "link"):
            if body.has(part):
                if not numbers:
                    raise body.error("at", f"is missing; it numbers the joints or links that {part} is for")
                keys += [
                    (f"chain[{number}].{part}.{key}", value)
                    for number in numbers
                    for key, value in body.mapping(part).content.items()
                ]
        tolerances = _replaced(sheet.tolerances, _tolerances(body, arm), arm)
        repeatability, warmth = sheet.repeatability, sheet.temperature
        if body.has("repeatability"):
            repeatability = _positive(body, "repeatability", "length")
        if body.has("temperature"):
            warmth = _positive(body, "temperature", "temperature_difference")
        uncertain = _uncertain(body, arm, sheet.share) or sheet.uncertain
        improved = replace(
            sheet, tolerances=tolerances, uncertain=uncertain, repeatability=repeatability, temperature=warmth
        )
        made = changed(keys) if keys else arm
        if made == arm and improved == sheet:
            would_do = "joint: {backlash: 1 arcmin} with at: 2, or tolerances"
            raise body.error("", f"changes nothing; say what is better, e.g. {would_do}")
        return Option(name, price, made, improved)


def _places(body: Mapping, arm: Arm) -> list[int]:
    if not body.has("at"):
        return []
    raw = body.raw("at")
    numbers: list[object] = list(raw) if isinstance(raw, list) else [raw]
    places: list[int] = []
    for number in numbers:
        if isinstance(number, bool) or not isinstance(number, int) or not 1 <= number <= arm.size:
            raise body.error("at", f"numbers joints or links from 1 to {arm.size}, not {shown(number)}")
        places.append(number)
    return places


def _replaced(old: tuple[Tolerance, ...], new: list[Tolerance], arm: Arm) -> tuple[Tolerance, ...]:
    """The tolerances with better ones in place of those of the same effect, parameters and kind at the same places."""
    tolerances = list(old)
    for item in new:
        rest: list[Tolerance] = []
        for other in tolerances:
            same = other.entry.effect == item.entry.effect and other.each_time == item.each_time
            if not same or set(other.entry.parameters) != set(item.entry.parameters):
                rest.append(other)
                continue
            left = tuple(place for place in _all_places(other.entry, arm) if place not in item.entry.at)
            if item.entry.at and left:
                rest.append(Tolerance(EffectEntry(other.entry.effect, left, other.entry.parameters), other.each_time))
        tolerances = [*rest, item]
    return tuple(tolerances)


def _all_places(entry: EffectEntry, arm: Arm) -> tuple[int, ...]:
    """The joints or links (from 1) of an entry; all at which it can act, where it names none."""
    effect = EFFECTS[entry.effect]
    if entry.at or effect.place not in ("joint", "link"):
        return entry.at
    joints = enumerate(arm.joints)
    return tuple(k + 1 for k, joint in joints if effect.can_act(k, revolute=joint.revolute, passive=joint.passive))
