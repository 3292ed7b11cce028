"""The parts of an arm as a list (bill of materials) in CSV: sizes, masses, centres, inertias, prices."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd

from linkwright.core.arm.bodies.bodies import rod
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import section_directions
from linkwright.core.arm.chain.prices import joint_price_dates, link_price_dates, price_of, price_of_link
from linkwright.core.arm.descriptions.formats import Exported
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.placed.heights import heights
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.workbook import defused
from linkwright.results.figures_in_words import shape_words

_DIGITS = 9


def listed(arm: Arm) -> Exported:
    """The list of an arm's parts. Raises `arm.bodies.beams.PropertyNeeded` for links of unknown mass."""
    table = parts(arm)
    text = table.map(defused).to_csv(index=False, lineterminator="\n")
    lost: list[str] = ["what links need at their ends: flanges, bolts, bearings"]
    unpriced = table.loc[table["price_EUR"].isna(), "part"].tolist()
    if unpriced:
        lost.append(f"no price is known of {', '.join(unpriced)}")
    carried = ("sizes", "masses with centres and inertias", "prices of materials and actuators")
    return Exported(arm, "bom", text, carried, tuple(lost), ())


def parts(arm: Arm) -> pd.DataFrame:
    """A row for each link, drive and mass: lengths in mm, masses in kg, centres in mm from the link's joint and
    inertias in kg*m^2 about them, in the link's directions (along, height, width); where that height points with all
    joints at zero; prices in EUR, with all work that the arm file prices, and when they were such."""
    rows: list[dict[str, Any]] = []
    for index, link in enumerate(arm.links):
        rows += [*_drive(arm, index), _link(arm, index)]
        rows += [
            {"part": f"mass at the {mass.on} end of link {index + 1}", "mass_kg": mass.mass} for mass in link.masses
        ]
    first = ["part", "size", "section", "height_at_zero", "made_of", "length_mm", "mass_kg"]
    inertias = [f"I_{_AXES[i]}_{_AXES[k]}_kg_m2" for i in range(3) for k in range(i, 3)]
    columns = [*first, *(f"center_{name}_mm" for name in _AXES), *inertias, "price_EUR", "price_date"]
    table = pd.DataFrame(rows, columns=columns)
    numbers = table.select_dtypes("number").columns
    table[numbers] = table[numbers].map(_rounded)
    table["price_EUR"] = pd.to_numeric(table["price_EUR"])
    return table.fillna(dict.fromkeys(("size", "section", "height_at_zero", "made_of", "price_date"), ""))


_AXES = ("along", "height", "width")


def _drive(arm: Arm, index: int) -> list[dict[str, Any]]:
    """The row of a joint's drive; none where nothing is known of it."""
    joint = arm.joints[index]
    drive = joint.actuator
    if drive is None and joint.mass <= 0.0 and joint.cost is None:
        return []
    return [
        {
            "part": f"drive of joint {index + 1}",
            "size": "" if drive is None else drive.name,
            "made_of": "" if drive is None else drive.maker,
            "mass_kg": joint.mass,
            "price_EUR": price_of(joint) if drive is not None or joint.cost is not None else None,
            "price_date": ", ".join(date for date in joint_price_dates(joint) if date),
        }
    ]


def _link(arm: Arm, index: int) -> dict[str, Any]:
    joint, link = arm.joints[index], arm.links[index]
    pointing = heights(arm)[index]
    height, width = section_directions(link, joint)
    axes = np.array([link.direction, height, width], dtype=float).T
    material = None if link.material is None else link.material.at(arm.temperature)
    body = rod(link, beams_of(arm)[index], axes, material)
    center, inertia = axes.T @ body.center, axes.T @ body.inertia @ axes
    section = "" if link.section is None else shape_words(link.section.shape, link.section.given())
    return {
        "part": f"link {index + 1}",
        "size": link.section_name or "",
        "section": section + (" (tapered)" if isinstance(link.section, Tapered) else ""),
        "height_at_zero": "" if pointing is None else pointing.words,
        "made_of": "" if link.material is None else link.material.name,
        "length_mm": 1e3 * link.length,
        "mass_kg": body.mass,
        **{f"center_{name}_mm": 1e3 * value for name, value in zip(_AXES, center, strict=True)},
        **{f"I_{_AXES[i]}_{_AXES[k]}_kg_m2": inertia[i, k] for i in range(3) for k in range(i, 3)},
        "price_EUR": price_of_link(arm, link, body.mass),
        "price_date": ", ".join(sorted({date for date in link_price_dates(arm, link) if date})),
    }


def _rounded(value: float) -> float:
    """To nine figures: files are read by people too."""
    return value if not math.isfinite(value) or value == 0.0 else float(f"{value:.{_DIGITS}g}") + 0.0
