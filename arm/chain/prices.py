"""What an arm costs: the material of its links, work on them, and what has a price as it is bought."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .chain import Arm, Joint, Link

if TYPE_CHECKING:
    from linkwright.core.materials.material import Material


def fixed_price(arm: Arm) -> tuple[float, str]:
    """The sum (EUR) of what neither a section nor a length changes: joints, rigid links, work by the part; and in words
    what has no price, an empty text where all is known.

    A joint costs what it says itself, or else what its actuator does; one with neither costs nothing. A link's `cost`
    comes on top of its material and of the arm's `machining`; a rigid link has no other.
    """
    total, lacking = 0.0, ""
    for number, joint in enumerate(arm.joints, start=1):
        price = price_of(joint)
        if price is None and joint.actuator is not None:
            lacking = lacking or f"no price is known of {joint.actuator.name}, the actuator of joint {number}"
        total += price or 0.0
    for number, link in enumerate(arm.links, start=1):
        if link.section is None and link.cost is None:
            lacking = lacking or f"no price is known of link {number}, which is rigid"
        total += link.cost or 0.0
        total += arm.machining.per_part if link.section is not None else 0.0
    return total, lacking


def price_of(joint: Joint) -> float | None:
    """What a joint costs (EUR), None where nobody knows; nothing where it says nothing and names no actuator."""
    if joint.cost is not None:
        return joint.cost
    return 0.0 if joint.actuator is None else joint.actuator.cost


def price_by_mass(arm: Arm, material: Material) -> float:
    """What a kilogram of a link costs (EUR/kg): its material, and work by the kilogram: what the material says that
    costs, or else the arm. Raises `MissingProperty` where the material has no price."""
    if material.has("machining_cost"):
        work = material.need("machining_cost", arm.temperature)
    else:
        work = arm.machining.per_kilogram
    return material.need("cost", arm.temperature) + work


def price_by_length(arm: Arm) -> float:
    """What work on a metre of each link that has a section costs, EUR/m."""
    return arm.machining.per_metre


def price_of_link(arm: Arm, link: Link, mass: float) -> float | None:
    """What a link of so many kilograms costs with all work on it (EUR), None where nobody knows."""
    if link.material is None:
        return link.cost
    if not link.material.has("cost"):
        return None
    work = price_by_length(arm) * link.length + arm.machining.per_part + (link.cost or 0.0)
    return mass * price_by_mass(arm, link.material) + work


def works(arm: Arm) -> bool:
    """Whether the arm says what work on its links costs, or one of its materials does."""
    machining = arm.machining
    priced = any(link.material is not None and link.material.has("machining_cost") for link in arm.links)
    return priced or bool(machining.per_kilogram or machining.per_metre or machining.per_part)


def joint_price_dates(joint: Joint) -> tuple[str, ...]:
    """When the price of a joint was such (`2026-01`), an empty text where that is not said; nothing without a price."""
    if joint.cost is not None:
        return (joint.cost_date,)
    if joint.actuator is None or joint.actuator.cost is None:
        return ()
    return (joint.actuator.cost_date or "",)


def link_price_dates(arm: Arm, link: Link) -> tuple[str, ...]:
    """When the prices of a link were such, as those of `joint_price_dates`."""
    dates = [] if link.cost is None else [link.cost_date]
    if link.material is not None:
        properties, machining = link.material.properties, arm.machining
        dates += [properties[name].date for name in ("cost", "machining_cost") if name in properties]
        if machining.per_metre or machining.per_part or (machining.per_kilogram and "machining_cost" not in properties):
            dates.append(machining.date)
    return tuple(dates)


def price_dates(arm: Arm) -> tuple[str, ...]:
    """When the prices that count in the arm's cost were such, each date once, the earliest first; an empty text stands
    for prices that say no date."""
    dates = [date for joint in arm.joints for date in joint_price_dates(joint)]
    dates += [date for link in arm.links for date in link_price_dates(arm, link)]
    return tuple(sorted(set(dates)))
