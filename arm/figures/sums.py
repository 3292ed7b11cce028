"""What is of a design as a whole: masses, cost and reach, which add up over the links, and numbers of kinds."""

from __future__ import annotations

from collections.abc import Sequence

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.prices import price_dates, works

from .design import Totals
from .figure import Figure, OfDesign, OfKinds

MASS = Figure(
    name="mass",
    synonyms=("weight", "mass_of_links", "total_link_mass"),
    title="mass of the links",
    kind="mass",
    unit="kg",
    senses=("<=", "==", ">="),
    key="mass_kg",
    follows=OfDesign(lambda totals: totals.mass),
)
TOTAL_MASS = Figure(
    name="total_mass",
    synonyms=("total_weight", "overall_mass"),
    title="total mass",
    kind="mass",
    unit="kg",
    senses=("<=", "==", ">="),
    key="total_mass_kg",
    follows=OfDesign(lambda totals: totals.mass + totals.carried),
    note="with joints and the heaviest payload",
)


def _payload(totals: Totals) -> float:
    return totals.payload


PAYLOAD = Figure(
    name="payload",
    synonyms=("max_payload", "largest_payload", "load_capacity"),
    title="largest payload",
    kind="mass",
    unit="kg",
    senses=(),
    key="largest_payload_kg",
    follows=OfDesign(_payload),
    more_is_better=True,
    traded=False,
    note="the largest that keeps the limits",
)
"""What `maximize: payload` asks for; of an arm evaluated at that payload. No limit: load cases say what is carried."""


def _cost_title(arm: Arm) -> str:
    priced = any(joint.cost is not None for joint in (*arm.joints, *arm.links)) or works(arm)
    driven = any(joint.actuator is not None for joint in arm.joints)
    return "cost" if priced else "cost of material and actuators" if driven else "material cost"


def _cost_note(arm: Arm) -> str:
    """What that does and does not hold, and when its prices were such."""
    unpriced = [str(number) for number, link in enumerate(arm.links, start=1) if link.cost is None]
    if works(arm):
        held = "with machining"
    elif len(unpriced) == len(arm.links):
        held = "without machining"
    else:
        held = (
            f"without machining of link {', '.join(unpriced)}" if unpriced else "with what the arm file says of links"
        )
    return "; ".join(text for text in (held, dates_in_words(price_dates(arm))) if text)


def dates_in_words(dates: Sequence[str]) -> str:
    """When prices were such: `prices of 2007-01 to 2024, some without a date`; an empty text where none has a date."""
    dated = [date for date in dates if date]
    if not dated:
        return ""
    span = dated[0] if len(dated) == 1 else f"{dated[0]} to {dated[-1]}"
    return f"prices of {span}" + (", some without a date" if len(dated) < len(dates) else "")


COST = Figure(
    name="cost",
    synonyms=("price", "costs"),
    title="material cost",
    kind="cost",
    unit="EUR",
    senses=("<=",),
    key="cost_EUR",
    follows=OfDesign(lambda totals: totals.cost),
    needs=("cost",),
    note="without machining",
    titled=_cost_title,
    noted=_cost_note,
)
REACH = Figure(
    name="reach",
    synonyms=("total_length", "range_of_motion"),
    title="reach",
    kind="length",
    unit="mm",
    factor=1e3,
    senses=("<=", "==", ">="),
    key="reach_mm",
    follows=OfDesign(lambda totals: totals.reach),
    more_is_better=True,
    note="sum of the link lengths",
)


def _number(name: str, title: str, kinds: OfKinds, synonyms: tuple[str, ...]) -> Figure:
    return Figure(
        name=name,
        synonyms=synonyms,
        title=title,
        senses=("<=",),
        key=name,
        follows=kinds,
        note="of links that have a section",
        # Whole numbers have no axis, and no price by the unit.
        traded=False,
        everywhere=False,
    )


MATERIALS = _number(
    "materials",
    "different materials",
    OfKinds(lambda _, material: material.name),
    ("material_count", "number_of_materials", "distinct_materials"),
)
PARTS = _number(
    "parts",
    "different parts",
    OfKinds(lambda shape, material: (shape, material.name), sized=True),
    ("part_count", "number_of_parts", "distinct_parts", "profiles"),
)
