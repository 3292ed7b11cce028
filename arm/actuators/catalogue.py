"""The catalogue of actuators: what a joint's drive gives under, loses, weighs, holds and costs.

A file of actuators, the shipped ones beside this module and the user's alike:

```yaml
format_version: 1
maker: Harmonic Drive
references:
  csf-csg: "Harmonic Drive LLC, Cup Type Component Sets and Housed Units, CSF & CSG Series"
actuators:
  CSG-25-100-2UH:
    gear: strain wave                  # or cycloidal, planetary, belt, servo (the gear train within one)
    ratio: 100                         # of the figures any is left out where it is unknown
    rated_torque: 87 N*m
    peak_torque: 204 N*m               # of a servo: what it stalls at
    stiffness: [31 kN*m/rad, 50 kN*m/rad, 57 kN*m/rad]   # or one value; in zones that end at zone_torques
    zone_torques: [14 N*m, 48 N*m]
    backlash: 0 arcmin                 # total lost motion
    mass: 1.5 kg
    tilting_stiffness: 240 kN*m/rad    # of the output bearing, across its axis
    rotor_inertia: 35 g*m^2            # of what turns with the motor, before the gear, whose ratio then counts
    cost: {value: 1500 EUR, spread: [1200 EUR, 1900 EUR], date: 2026-01}
    note: with the motor               # what a reader should know
    source: csf-csg
prices:                                # of actuators of other files (or this one), which stay as they are
  RV-20E: {value: 900 EUR, date: 2026-03, source: Offer 12}
```

`unconfirmed: what was looked for`, of the file or an entry, marks figures that nobody could find in their source: all
of them, or with `unconfirmed: {mass: what was looked for}` those named. That of an entry stands in place of the file's.
`found_in: where` says in which text, beside the source itself, the others were found.
A file of prices alone needs neither `maker` nor `references`. An entry may have a `maker` of its own.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType

from linkwright.core.units.files import UserFile
from linkwright.core.units.names import nearest
from linkwright.core.units.prices import read_prices
from linkwright.core.units.quantities import InputError
from linkwright.core.units.reading import Mapping as Keys
from linkwright.core.units.reading import load_yaml, shipped_files

FORMAT_VERSION = 1
"""The version of the format that this code reads."""

USER_ACTUATORS = UserFile("LINKWRIGHT_ACTUATORS", "actuators.yaml")
"""The user's actuators."""

CONFIRMABLE = ("rated_torque", "peak_torque", "stiffness", "backlash", "mass", "tilting_stiffness")
"""The figures that can be marked as not confirmed; `stiffness` with the torques of its zones."""

GEARS = ("strain wave", "cycloidal", "planetary", "belt", "servo")


@dataclass(frozen=True)
class Actuator:
    """A gear or actuator of a joint that turns, SI (N*m, N*m/rad, rad, kg, EUR).

    Figures are None where they are unknown. `stiffnesses` are those of its zones of torque, which end at `zone_torques`
    (one fewer); none where unknown. `peak_torque` of a servo is what it stalls at. `backlash` is the total lost motion,
    `tilting_stiffness` that of the output bearing across its axis, `rotor_inertia` (kg*m^2) what turns with the motor
    before the gear. `cost` is indicative, `cost_spread` the lowest and highest to expect, `cost_date` when that was;
    None where unknown. `file` is where the entry stands. `unconfirmed` are the figures (of
    `CONFIRMABLE`) that nobody could find in their source, each with what was looked for; `found_in` is the text that
    the others were found in.
    """

    name: str
    maker: str
    gear: str
    source: str
    file: str
    rated_torque: float | None = None
    stiffnesses: tuple[float, ...] = ()
    backlash: float | None = None
    mass: float | None = None
    peak_torque: float | None = None
    tilting_stiffness: float | None = None
    ratio: float | None = None
    zone_torques: tuple[float, ...] = ()
    cost: float | None = None
    cost_spread: tuple[float, float] | None = None
    cost_date: str | None = None
    note: str = ""
    unconfirmed: tuple[tuple[str, str], ...] = ()
    found_in: str = ""
    rotor_inertia: float | None = None

    @property
    def rotor_at_joint(self) -> float:
        """The rotor's inertia as the joint feels it, kg*m^2; 0 where it is unknown."""
        return 0.0 if self.rotor_inertia is None or self.ratio is None else self.rotor_inertia * self.ratio**2

    def is_unconfirmed(self, name: str) -> bool:
        """Whether nobody could find this figure in its source."""
        return any(name == item for item, _ in self.unconfirmed)

    @property
    def stiffness(self) -> float | None:
        """The stiffness (N*m/rad) of the softest zone: under no torque does the gear give more than by this one."""
        return min(self.stiffnesses, default=None)

    def lacks(self, *names: str) -> tuple[str, ...]:
        """Which of these figures are unknown."""
        return tuple(name for name in names if getattr(self, name) is None)

    @property
    def zones(self) -> tuple[tuple[float, float], ...]:
        """The torque at which each zone ends (the last: infinite) and its stiffness; none where there is but one."""
        ends = (*self.zone_torques, math.inf)
        return tuple(zip(ends, self.stiffnesses, strict=True)) if self.zone_torques else ()

    def wind_up(self, torque: float) -> float:
        """How far the gear gives (rad) under a torque (N*m, either sign), zone by zone."""
        left, turned, start = abs(torque), 0.0, 0.0
        for stiffness, end in itertools.zip_longest(self.stiffnesses, self.zone_torques):
            part = left if end is None else min(left, end - start)
            turned += part / stiffness
            left -= part
            start = start if end is None else end
        return turned if torque >= 0.0 else -turned


@dataclass(frozen=True)
class Actuators:
    """Actuators by name; of two with the same name the one of the later file counts."""

    by_name: Mapping[str, Actuator]

    def __iter__(self) -> Iterator[Actuator]:
        """Iterate over the actuators, maker by maker."""
        return iter(self.by_name.values())

    def __len__(self) -> int:
        """Count the actuators."""
        return len(self.by_name)

    def find(self, name: str, *, file: object = "", key: str = "actuator") -> Actuator:
        """The actuator of that name; raises `InputError` for file and key with the nearest known name."""
        if name not in self.by_name:
            would_do = "; of another drive give `stiffness`, `backlash` and `mass` at the joint in place of its name"
            raise InputError(file, key, f"there is no actuator '{name}'{nearest(name, list(self.by_name)) or would_do}")
        return self.by_name[name]


def load_actuators(paths: Sequence[Path | str] = (), *, user: bool = True) -> Actuators:
    """The shipped actuators, over them the user's own (where the file exists and `user` is true), over that `paths`.

    A file named by the environment variable or in `paths` must exist. Raises `InputError`.
    """
    actuators = dict(shipped_actuators())
    for path in USER_ACTUATORS.over(paths, user=user):
        actuators = _with_file(actuators, load_yaml(path))
    return Actuators(MappingProxyType(actuators))


def _with_file(known: Mapping[str, Actuator], keys: Keys) -> dict[str, Actuator]:
    """The actuators with those of a file over them, and its prices."""
    actuators = {**known, **read_actuators(keys)}
    for name, price in read_prices(keys, "cost").items():
        if name not in actuators:
            raise keys.error(f"prices.{name}", f"there is no such actuator{nearest(name, list(actuators))}")
        note = f"cost: {price.source}" + (f" ({price.note})" if price.note else "")
        note = "; ".join(text for text in (actuators[name].note, note) if text)
        spread = price.spread or (price.value, price.value)
        actuators[name] = replace(
            actuators[name], cost=price.value, cost_spread=spread, cost_date=price.date, note=note
        )
    return actuators


@lru_cache(maxsize=1)
def shipped_actuators() -> Mapping[str, Actuator]:
    """The actuators that come with the program, read from its package data and checked."""
    actuators: dict[str, Actuator] = {}
    for file in shipped_files("linkwright.core.arm.actuators"):
        actuators.update(read_actuators(file))
    return MappingProxyType(actuators)


def read_actuators(keys: Keys) -> dict[str, Actuator]:
    """The checked actuators of a file's content, without its `prices`, which are checked alone; raises `InputError`
    naming the entry and its key."""
    with keys.reading():
        keys.version(FORMAT_VERSION)
        read_prices(keys, "cost")
        if keys.has("prices") and not keys.has("actuators"):
            return {}
        maker = keys.text("maker", "")
        references = keys.mapping("references")
        sources = {name: references.text(name) for name in references.content}
        entries = keys.mapping("actuators")
        defaults = _Defaults(maker, _marks(keys), keys.text("found_in", ""))
        return {name: _read(entries.mapping(name), name, sources, defaults) for name in entries.content}


@dataclass(frozen=True)
class _Defaults:
    """What a file says of all its entries."""

    maker: str
    unconfirmed: tuple[tuple[str, str], ...]
    found_in: str


def _marks(keys: Keys) -> tuple[tuple[str, str], ...]:
    """The figures that a file or an entry marks as not confirmed, with what was looked for."""
    if not keys.has("unconfirmed"):
        return ()
    if not isinstance(keys.content["unconfirmed"], dict):
        return tuple((name, keys.text("unconfirmed")) for name in CONFIRMABLE)
    with keys.mapping("unconfirmed").reading() as marks:
        return tuple((name, marks.text(name)) for name in CONFIRMABLE if marks.has(name))


def _read(keys: Keys, name: str, sources: Mapping[str, str], defaults: _Defaults) -> Actuator:
    with keys.reading():
        if not name.strip() or name != name.strip():
            raise keys.error("", f"{name!r} cannot be an actuator's name")
        rated, peak = _positive(keys, "rated_torque", "torque"), _positive(keys, "peak_torque", "torque")
        if peak is not None and rated is not None and peak < rated:
            raise keys.error("peak_torque", "must not be below the rated torque")
        stiffnesses, ends = _stiffnesses(keys)
        backlash = keys.not_negative("backlash", "angle") if keys.has("backlash") else None
        ratio = keys.number("ratio") if keys.has("ratio") else None
        if ratio is not None and ratio <= 0.0:
            raise keys.error("ratio", "must be positive")
        tilting = _positive(keys, "tilting_stiffness", "torsional_stiffness")
        rotor = _positive(keys, "rotor_inertia", "inertia")
        if rotor is not None and ratio is None:
            raise keys.error("rotor_inertia", "needs the gear's ratio, as it is before the gear")
        marks = _marks(keys) if keys.has("unconfirmed") else defaults.unconfirmed
        source = keys.text("source")
        if source not in sources:
            known = ", ".join(sources) or "none are given"
            raise keys.error("source", f"'{source}' is not among the file's references ({known})")
        cost, spread, date = _cost(keys)
        actuator = Actuator(
            name=name,
            maker=keys.text("maker", defaults.maker) if defaults.maker else keys.text("maker"),
            gear=keys.choice("gear", GEARS),
            rated_torque=rated,
            stiffnesses=stiffnesses,
            backlash=backlash,
            mass=_positive(keys, "mass", "mass"),
            source=sources[source],
            file=str(keys.file),
            peak_torque=peak,
            tilting_stiffness=tilting,
            ratio=ratio,
            zone_torques=ends,
            cost=cost,
            cost_spread=spread,
            cost_date=date,
            note=keys.text("note", ""),
            found_in=keys.text("found_in", defaults.found_in),
            rotor_inertia=rotor,
        )
    if actuator.lacks(*CONFIRMABLE) == CONFIRMABLE:
        raise keys.error("", f"has no figure; give one or more of {', '.join(CONFIRMABLE)}")
    return replace(actuator, unconfirmed=tuple(mark for mark in marks if not actuator.lacks(mark[0])))


def _positive(keys: Keys, name: str, kind: str) -> float | None:
    return keys.positive(name, kind) if keys.has(name) else None


def _stiffnesses(keys: Keys) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The stiffness of each zone of torque, and the torques at which the zones end."""
    if not keys.has("stiffness"):
        return (), ()
    if not isinstance(keys.content["stiffness"], list):
        return (keys.positive("stiffness", "torsional_stiffness"),), ()
    zones = keys.vector("stiffness", "torsional_stiffness")
    ends = keys.vector("zone_torques", "torque")
    if len(ends) != len(zones) - 1:
        raise keys.error("zone_torques", f"needs {len(zones) - 1} torques for {len(zones)} zones of stiffness")
    if not zones or min(zones) <= 0.0 or any(end <= start for start, end in itertools.pairwise((0.0, *ends))):
        raise keys.error("zone_torques", "must rise from zone to zone, and every stiffness must be positive")
    return zones, ends


def _cost(keys: Keys) -> tuple[float | None, tuple[float, float] | None, str | None]:
    """A price is worth something only with its date and spread."""
    if not keys.has("cost"):
        return None, None, None
    with keys.mapping("cost").reading() as price:
        value = price.quantity("value", "cost")
        spread = price.range("spread", "cost")
        date = price.when("date")
        if not 0.0 <= spread[0] <= value <= spread[1]:
            raise price.error("spread", "must hold the value, and nothing below zero")
    return value, spread, date
