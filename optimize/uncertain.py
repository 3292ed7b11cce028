"""What is not known exactly of an arm: factors of its moduli, dimensions, drives and backlash, between bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping as MappingLike
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, cast

import numpy as np

from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.effects import BACKLASH, JOINT_COMPLIANCE
from linkwright.core.materials.material import Material
from linkwright.core.sections.numeric import Array
from linkwright.core.sections.taper import Tapered, size_ratio
from linkwright.core.units.quantities import InputError, read_number, read_quantity, shown
from linkwright.core.units.reading import Mapping, load_json

KINDS: MappingLike[str, str] = MappingProxyType(
    {
        "link_length": "length",
        "payload": "dimensionless",
        "temperature": "temperature_difference",
        "force_direction": "angle",
    }
)
"""What else can be uncertain (`arm.errors.varied`), each with the kind of quantity that says how far."""
OF_LINKS = ("elastic_modulus", "size", "thickness")
OF_JOINTS = ("stiffness", "backlash")
FACTORS = (*OF_LINKS, *OF_JOINTS)
"""What can be uncertain: a link's moduli (E and G alike), all dimensions of its section, its walls; a drive's stiffness
and backlash."""
_WORST = 1.0
_FROM_DIAGNOSIS: MappingLike[tuple[str, str], str] = MappingProxyType(
    {
        (JOINT_COMPLIANCE.id, "stiffness"): "stiffness",
        (JOINT_COMPLIANCE.id, "compliance"): "stiffness",
        (BACKLASH.id, "total"): "backlash",
    }
)
"""Which factor a parameter of a finding makes uncertain."""
_MOST = 0.9
_LARGEST_FIGURE = 1e100


@dataclass(frozen=True)
class Scenario:
    """One way the arm may be: factors of `elastic_modulus`, `size` and `thickness` for each link, of `stiffness` and
    `backlash` for each joint; by how much each link is too long (m), the factor of payloads, by how much all is warmer
    (K), and the two angles (rad) by which forces are turned."""

    elastic_modulus: tuple[float, ...]
    size: tuple[float, ...]
    thickness: tuple[float, ...]
    stiffness: tuple[float, ...]
    backlash: tuple[float, ...]
    link_length: tuple[float, ...] = ()
    payload: tuple[float, ...] = (1.0,)
    temperature: tuple[float, ...] = (0.0,)
    force_direction: tuple[float, ...] = (0.0, 0.0)

    @property
    def beyond_links(self) -> tuple[float, ...]:
        """The end of the error model's row p (`arm.errors.varied.as_it_is`)."""
        lengths = self.link_length or (0.0,) * len(self.stiffness)
        return (*self.stiffness, *self.backlash, *lengths, *self.payload, *self.temperature, *self.force_direction)


@dataclass(frozen=True)
class Uncertain:
    """How far each factor may be from one, either way, or each of `link_length` (m), `temperature` (K) and
    `force_direction` (rad) from what the file says: for each link or joint, by name. `share` is the share of what
    may be that the error is held for: 1 is all of it, the worst.

    Each factor is anywhere within its bounds, independently of the others; for a share below 1 uniformly so.
    """

    widths: MappingLike[str, tuple[float, ...]]
    share: float = _WORST

    @property
    def worst(self) -> bool:
        """Whether the worst of all counts."""
        return self.share == _WORST

    @property
    def text(self) -> str:
        """What is minimised, in words."""
        return "worst" if self.worst else f"{100.0 * self.share:g} %"

    @property
    def places(self) -> tuple[tuple[str, int], ...]:
        """The factors that are uncertain, by name and link or joint (from 0)."""
        return tuple((name, k) for name, widths in self.widths.items() for k, width in enumerate(widths) if width > 0.0)

    @property
    def varied(self) -> frozenset[str]:
        """Which of `arm.errors.varied.VARIED` are uncertain."""
        return frozenset(name for name, _ in self.places if name in KINDS)

    def scenario(self, shares: Array) -> Scenario:
        """The scenario where each uncertain factor is at a share (-1 to 1) of its way to its bound."""
        factors = {name: [_middle(name)] * len(widths) for name, widths in self.widths.items()}
        for (name, k), share in zip(self.places, shares.tolist(), strict=True):
            factors[name][k] += share * self.widths[name][k]
        return Scenario(**{name: tuple(values) for name, values in factors.items()})

    def pessimistic(self) -> Array:
        """The vertex where everything is softer, thinner, looser and more loaded."""
        return np.array([-1.0 if name in (*OF_LINKS, "stiffness") else 1.0 for name, _ in self.places])


def _middle(name: str) -> float:
    """What a figure is of an arm as its file has it."""
    return 0.0 if name in KINDS and name != "payload" else 1.0


def read_uncertain(
    mapping: Mapping, arm: Arm, cases: Sequence[LoadCase], materials: Sequence[Material]
) -> Uncertain | None:
    """What a problem file says is uncertain, and how `robust` counts it; None where it says nothing.

    Raises `InputError` for what is wrong, and for one of `uncertain` and `robust` without the other.
    """
    if not mapping.has("uncertain"):
        if mapping.has("robust"):
            raise mapping.error("robust", "needs what is uncertain, e.g. uncertain: {elastic_modulus: 5 %}")
        return None
    if not mapping.has("robust"):
        raise mapping.error("uncertain", "needs how it counts: robust: worst, or robust: 95 %")
    raw = mapping.raw("robust")
    share = _WORST
    if raw != "worst":
        share = read_number(raw, file=mapping.file, key=mapping.path_of("robust"))
        if not 0.5 <= share < 1.0:
            raise mapping.error("robust", f"is worst, or a share from 50 % to below 100 %, not {shown(raw)}")
    with mapping.mapping("uncertain").reading() as body:
        widths = {name: read_widths(body, name, arm) for name in FACTORS}
        widths |= {name: _read_varied(body, name, arm, cases) for name in KINDS if body.has(name)}
        if "temperature" in widths:
            _check_expansion(body, arm, materials)
        if body.has("diagnosis"):
            _diagnosed(body, arm, widths)
        if not any(any(width_terms) for width_terms in widths.values()):
            raise mapping.error("uncertain", f"names nothing; it takes {', '.join((*FACTORS, *KINDS))} and diagnosis")
    if arm.play == "statistical" and any(widths["backlash"]):
        raise mapping.error("uncertain", "backlash goes with play: worst or loaded, not with statistical play")
    for k, link in enumerate(arm.links):
        if isinstance(link.section, Tapered) and size_ratio(link.section) is None and widths["thickness"][k] > 0.0:
            message = f"link {k + 1} tapers to another form, which walls that are off would change; leave out thickness"
            raise mapping.error("uncertain", message)
    return Uncertain(MappingProxyType(widths), share)


def read_widths(body: Mapping, name: str, arm: Arm) -> tuple[float, ...]:
    """A width for each link or joint: one for all, or a list; zero where there is nothing of that to be uncertain."""
    what = "links" if name in OF_LINKS else "joints"
    if not body.has(name):
        return (0.0,) * arm.size
    raw = body.raw(name)
    values = cast(list[object], raw) if isinstance(raw, list) else [raw] * arm.size
    if len(values) != arm.size:
        raise body.error(name, f"is one figure for all, or one for each of the {arm.size} {what}, not {len(values)}")
    results: list[float] = []
    for value in values:
        width = read_number(value, file=body.file, key=body.path_of(name))
        if not 0.0 <= width <= _MOST:
            raise body.error(name, f"is how far off it may be, from 0 % to {100.0 * _MOST:g} %, not {shown(value)}")
        results.append(width)
    return tuple(width if _has(arm, name, k) else 0.0 for k, width in enumerate(results))


def _read_varied(body: Mapping, name: str, arm: Arm, cases: Sequence[LoadCase]) -> tuple[float, ...]:
    """How far a figure may be off that is neither a link's section's nor a drive's."""
    if any(case.relative_to is not None for case in cases):
        raise body.error(name, "goes without relative_to, whose state it would change as well")
    raw, count = body.raw(name), arm.size if name == "link_length" else 1
    values = cast(list[object], raw) if isinstance(raw, list) else [raw] * count
    if len(values) != count:
        raise body.error(name, f"is one figure{' for all, or one for each link' if count > 1 else ''}")
    path = body.path_of(name)
    if KINDS[name] == "dimensionless":
        widths = [read_number(value, file=body.file, key=path) for value in values]
    else:
        widths = [read_quantity(value, KINDS[name], file=body.file, key=path) for value in values]
    most = {"payload": 1.0, "force_direction": math.pi / 2.0}.get(name, math.inf)
    if not all(0.0 <= width <= most for width in widths):
        raise body.error(name, f"is how far off it may be, either way, not {shown(raw)}")
    if name == "payload" and not any(case.mass > 0.0 for case in cases):
        raise body.error(name, "needs a payload; give the arm or a load case one")
    return _turned(body, widths[0], arm, cases) if name == "force_direction" else tuple(widths)


def _turned(body: Mapping, width: float, arm: Arm, cases: Sequence[LoadCase]) -> tuple[float, float]:
    """By how much forces may be turned in the arm's plane and out of it."""
    if not any(any(case.force) for case in cases):
        raise body.error("force_direction", "needs a force at the tip; give the arm or a load case one")
    if arm.flat and any(case.force[2] for case in cases):
        raise body.error("force_direction", "of an arm in a plane goes with forces in that plane")
    return (width, 0.0 if arm.flat else width)


def _check_expansion(body: Mapping, arm: Arm, materials: Sequence[Material]) -> None:
    """Refuse a temperature where some material may be chosen that says nothing of it."""
    used = [*materials, *(link.material for link in arm.links if link.material is not None)]
    lacking = [material.name for material in used if not material.has("thermal_expansion")]
    if lacking:
        raise body.error("temperature", f"needs thermal_expansion, which {lacking[0]} lacks")


def _has(arm: Arm, name: str, k: int) -> bool:
    """Whether a link or joint has what may be uncertain of it."""
    if name in OF_LINKS:
        return arm.links[k].elastic
    effect = JOINT_COMPLIANCE.id if name == "stiffness" else BACKLASH.id
    more = any(entry.effect == effect and (not entry.at or k + 1 in entry.at) for entry in arm.effects)
    joint = arm.joints[k]
    return more or (joint.stiffness is not None if name == "stiffness" else joint.backlash > 0.0)


def _diagnosed(body: Mapping, arm: Arm, widths: dict[str, tuple[float, ...]]) -> None:
    """Take the widths of what a diagnosis found from its 95 % intervals, relative to what it found."""
    path = Path(str(body.file)).parent / body.text("diagnosis")
    used = False
    for finding in _findings(body, path):
        parameters = finding.get("parameters")
        for parameter in _mappings(list(parameters.values()) if isinstance(parameters, dict) else None):
            name = _FROM_DIAGNOSIS.get((str(finding.get("effect")), str(parameter.get("parameter"))))
            at, ends, value = parameter.get("at"), parameter.get("ci95"), parameter.get("value")
            if name is None or not ends or not value:
                continue
            if not (_figures(value) and _figures(ends, 2)):
                raise body.error("diagnosis", f"{path} is no diagnosis.json: {shown(parameter)} holds no figures")
            width = min(0.5 * abs(ends[1] - ends[0]) / abs(value), _MOST)
            places: Any = at or finding.get("at") or list(range(1, arm.size + 1))
            entries = list(widths[name])
            for number in cast(list[Any], places if isinstance(places, list) else [places]):
                if type(number) is int and 1 <= number <= arm.size and _has(arm, name, number - 1):
                    entries[number - 1], used = width, True
            widths[name] = tuple(entries)
    if not used:
        would_do = "give it with the arm.yaml that the diagnosis wrote"
        raise body.error("diagnosis", f"{path.name} holds no interval of a drive here; {would_do}")


def _findings(body: Mapping, path: Path) -> list[dict[str, Any]]:
    """What a diagnosis.json found missing. Raises `InputError`."""
    content: Any = None
    with suppress(InputError):
        content = load_json(path)
    if not isinstance(content, dict) or not isinstance(content.get("missing"), list):
        raise body.error("diagnosis", f"{path} is no diagnosis.json")
    return _mappings(content["missing"])


def _mappings(values: Any) -> list[dict[str, Any]]:
    return [value for value in cast(list[Any], values or []) if isinstance(value, dict)]


def _figures(value: Any, size: int = 0) -> bool:
    """Whether JSON holds a finite number that can be computed with, or `size` of them."""
    if size:
        return isinstance(value, list) and len(value) == size and all(_figures(item) for item in value)
    return isinstance(value, int | float) and abs(value) < _LARGEST_FIGURE
