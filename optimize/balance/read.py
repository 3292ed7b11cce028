"""What a problem file lets the optimiser choose of counterweights and counterbalances."""

from __future__ import annotations

from collections.abc import Mapping as MappingLike
from dataclasses import replace
from types import MappingProxyType

from linkwright.core.arm.chain.balance import IdealCounterbalance, PointMass, SpringCounterbalance
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.units.quantities import shown
from linkwright.core.units.reading import Mapping

from .balance import Balance

_KINDS: MappingLike[str, str] = MappingProxyType(
    {"torque": "torque", "stiffness": "linear_stiffness", "preload": "force"}
)
"""What of a counterbalance can be chosen, and its kind of quantity."""


def read_balances(choose: Mapping, arm: Arm) -> tuple[Arm, tuple[Balance, ...]]:
    """The arm with what is to be chosen marked, and what it is, from `choose`; raises `InputError`."""
    balances: list[Balance] = []
    for key, read in (("balancer", _balancer), ("counterweight", _counterweight)):
        if not choose.has(key):
            continue
        for entry in choose.mappings(key):
            with entry.reading() as body:
                arm, numbers = read(body, arm)
                if any((number.field, number.place) in {(x.field, x.place) for x in balances} for number in numbers):
                    raise body.error("", f"is the second {key} of its kind there; name each place once")
                balances += numbers
    return arm, tuple(balances)


def _range(body: Mapping, name: str, kind: str) -> tuple[float, float]:
    low, high = body.range(name, kind)
    if low == high:
        raise body.error(name, "has one value, so that nothing is to choose; write it into the arm file")
    return low, high


def _balancer(body: Mapping, arm: Arm) -> tuple[Arm, list[Balance]]:
    place = _number(body, "joint", arm.size)
    joint = arm.joints[place]
    if not joint.revolute:
        raise body.error("joint", f"takes a torque off a joint that turns; joint {place + 1} slides")
    names = [name for name in _KINDS if body.has(name)]
    if len(names) != 1:
        raise body.error("", "needs a range of one of torque, stiffness and preload, e.g. torque: [0 N*m, 300 N*m]")
    name = names[0]
    low, high = _range(body, name, _KINDS[name])
    given = joint.counterbalance
    if name == "torque":
        if isinstance(given, SpringCounterbalance):
            raise body.error("torque", f"joint {place + 1} has a spring; give a range of its stiffness or its preload")
        if given is None or body.has("greatest_at"):
            given = IdealCounterbalance(
                0.0 if given is None else given.torque, body.quantity("greatest_at", "angle", 0.0)
            )
    elif not isinstance(given, SpringCounterbalance):
        would_do = "give it in the arm file, e.g. balancer: {stiffness: 8 N/mm, on_link: 80 mm, on_base: 300 mm, ...}"
        raise body.error(name, f"is that of a spring, and joint {place + 1} has none; {would_do}")
    if name == "stiffness" and low < 0.0:
        raise body.error(name, "cannot be negative")
    joints = list(arm.joints)
    joints[place] = replace(joint, counterbalance=given, balancer_chosen=name)
    value = min(max(float(getattr(given, name)), low), high)
    words = f"{name} of the balancer at joint {place + 1}"
    return replace(arm, joints=tuple(joints)), [Balance(place, "balancer", low, high, value, _KINDS[name], words)]


def _counterweight(body: Mapping, arm: Arm) -> tuple[Arm, list[Balance]]:
    place = _number(body, "link", arm.size)
    link = arm.links[place]
    low, high = _range(body, "mass", "mass")
    if low < 0.0:
        raise body.error("mass", "cannot be negative")
    held = [
        k for k, mass in enumerate(link.masses) if mass.on == "joint" and mass.motor_of is None and mass.at[0] < 0.0
    ]
    if len(held) > 1:
        raise body.error("link", f"link {place + 1} has {len(held)} counterweights already; leave one in the arm file")
    given = link.masses[held[0]] if held else PointMass(0.0)
    raw = body.raw("at", "where it is along the link from its joint, e.g. -300 mm, or a range [-400 mm, -150 mm]")
    nearest, farthest = body.range("at", "length") if isinstance(raw, list) else (body.quantity("at", "length"),) * 2
    words = f"counterweight of link {place + 1}"
    numbers = [
        Balance(place, "counterweight", low, high, min(max(given.mass, low), high), "mass", f"mass of the {words}")
    ]
    at = min(max(given.at[0] if held else 0.5 * (nearest + farthest), nearest), farthest)
    if nearest < farthest:
        numbers.append(Balance(place, "counterweight_at", nearest, farthest, at, "length", f"place of the {words}"))
    chosen = PointMass(given.mass, (at, *given.at[1:]), chosen=True)
    masses = tuple(mass for k, mass in enumerate(link.masses) if k not in held)
    links = list(arm.links)
    links[place] = replace(link, masses=(*masses, chosen))
    return arm.with_links(tuple(links)), numbers


def _number(body: Mapping, name: str, most: int) -> int:
    raw = body.raw(name, f"the number of a {name}, 1 to {most}")
    if isinstance(raw, bool) or not isinstance(raw, int) or not 1 <= raw <= most:
        raise body.error(name, f"is the number of a {name}, 1 to {most}, not {shown(raw)}")
    return raw - 1
