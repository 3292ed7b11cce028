"""What of an arm's cost its sections and materials do not decide: drives, rigid links, machining and fittings."""

from __future__ import annotations

from collections.abc import Sequence

from .chain import Joint, Link


def fixed_price(joints: Sequence[Joint], links: Sequence[Link]) -> tuple[float, str]:
    """The sum (EUR) of what joints and links cost beside the material of sections; and in words what has no price, an
    empty text where all is known.

    A joint costs what it says itself, or else what its actuator does; one with neither costs nothing. A link's `cost`
    comes on top of its material; a rigid link has no other.
    """
    total, lacking = 0.0, ""
    for number, joint in enumerate(joints, start=1):
        price = price_of(joint)
        if price is None and joint.actuator is not None:
            lacking = lacking or f"no price is known of {joint.actuator.name}, the actuator of joint {number}"
        total += price or 0.0
    for number, link in enumerate(links, start=1):
        if link.section is None and link.cost is None:
            lacking = lacking or f"no price is known of link {number}, which is rigid"
        total += link.cost or 0.0
    return total, lacking


def price_of(joint: Joint) -> float | None:
    """What a joint costs (EUR), None where nobody knows; nothing where it says nothing and names no actuator."""
    if joint.cost is not None:
        return joint.cost
    return 0.0 if joint.actuator is None else joint.actuator.cost
