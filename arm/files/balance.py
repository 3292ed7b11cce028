"""What hangs on an arm and what balances it, as an arm file says it: masses, motors and counterbalances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast, get_args

from linkwright.core.arm.chain.balance import Counterbalance, End, IdealCounterbalance, PointMass, SpringCounterbalance
from linkwright.core.units.reading import Mapping


@dataclass(frozen=True)
class Motor:
    """A joint's motor: its mass (kg) and the number of the link on which it stands (0: the base)."""

    mass: float
    on: int


def read_masses(link: Mapping) -> tuple[PointMass, ...]:
    """What hangs on a link's ends."""
    masses: list[PointMass] = []
    for body in link.mappings("masses"):
        with body.reading():
            x, y, z = body.vector("at", "length", 3) if body.has("at") else (0.0, 0.0, 0.0)
            end = cast(End, body.choice("on", get_args(End), "joint"))
            masses.append(PointMass(body.positive("mass", "mass"), (x, y, z), end))
    return tuple(masses)


def read_motor(joint: Mapping, links: int) -> Motor | None:
    """The motor that a joint names, of an arm of so many links."""
    if not joint.has("motor"):
        return None
    with joint.mapping("motor").reading() as body:
        mass, on = body.positive("mass", "mass"), body.raw("on", f"base, or the number of a link, 1 to {links}")
        if on == "base":
            return Motor(mass, 0)
        if isinstance(on, bool) or not isinstance(on, int) or not 1 <= on <= links:
            raise body.error("on", f"is base, or the number of the link that carries it, 1 to {links}")
        return Motor(mass, on)


def read_counterbalance(joint: Mapping) -> Counterbalance:
    """An ideal counterbalance (`torque`), or a spring between a joint's link and the one before."""
    with joint.mapping("balancer").reading() as body:
        if body.has("torque"):
            torque = body.quantity("torque", "torque")
            return IdealCounterbalance(torque, body.quantity("greatest_at", "angle", 0.0))
        if not body.has("on_link"):
            would_do = "torque and greatest_at, or a spring's stiffness, on_link, on_base and base_at"
            raise body.error("", f"says neither a torque nor where its spring holds on; give {would_do}")
        stiffness = body.quantity("stiffness", "linear_stiffness", 0.0)
        counterbalance = SpringCounterbalance(
            stiffness,
            body.positive("on_link", "length"),
            body.positive("on_base", "length"),
            body.quantity("base_at", "angle"),
            body.quantity("free_length", "length", 0.0),
            body.quantity("preload", "force", 0.0),
        )
        if stiffness < 0.0 or counterbalance.free_length < 0.0:
            raise body.error("stiffness" if stiffness < 0.0 else "free_length", "cannot be negative")
        if stiffness == 0.0 and counterbalance.preload == 0.0:
            raise body.error("stiffness", "is missing; a gas spring has a preload instead")
        if (
            counterbalance.on_link == counterbalance.on_base
            and counterbalance.preload != stiffness * counterbalance.free_length
        ):
            raise body.error("on_base", "is as long as on_link: the spring would have no length where both meet")
        return counterbalance
