"""Imports and exports as plain mappings for JSON."""

from __future__ import annotations

import math
from typing import Any

from linkwright.core.arm.chain.chain import Joint, Link
from linkwright.core.arm.descriptions.formats import Exported
from linkwright.core.arm.descriptions.imported_arm import Imported
from linkwright.version import program_version


def import_json(found: Imported) -> dict[str, Any]:
    """What `import --json` writes: degrees, mm and kg."""
    chain = zip(found.joint_names, found.link_names, found.arm.joints, found.arm.links, strict=True)
    return {
        "made_by": f"linkwright import {program_version()}",
        "arm": found.arm.name,
        "file": str(found.file),
        "base": found.base,
        "tip": found.tip,
        "joints": [
            {
                "joint": name,
                "link": carried,
                "type": joint.type,
                "range_deg" if joint.revolute else "range_mm": [
                    math.degrees(end) if joint.revolute else 1e3 * end for end in joint.range
                ],
                "length_mm": 1e3 * link.length,
                "mass_kg": weight(link),
                "inertia_kg_m2": None if link.inertia is None else list(link.inertia),
                "effort_Nm" if joint.revolute else "effort_N": joint.effort,
                "velocity_deg_per_s" if joint.revolute else "velocity_mm_per_s": _speed(joint),
            }
            for name, carried, joint, link in chain
        ],
        "notes": list(found.notes),
        "doubts": list(found.doubts),
        "not_carried": list(found.lost),
        "lacking": [
            {"what": each.what, "at": list(each.at), "shows": each.shows, "add": each.add} for each in found.lacking
        ],
    }


def export_json(found: Exported) -> dict[str, Any]:
    """What `export --json` writes."""
    return {
        "made_by": f"linkwright export {program_version()}",
        "arm": found.arm.name,
        "to": found.format,
        "carried": list(found.carried),
        "not_carried": list(found.lost),
        "assumed": list(found.assumed),
        "text": found.text,
    }


def weight(link: Link) -> float | None:
    """The mass (kg) of an imported link; None where it is not known."""
    return None if link.mass is None else link.mass + sum(each.mass for each in link.masses)


def _speed(joint: Joint) -> float | None:
    if joint.velocity is None:
        return None
    return math.degrees(joint.velocity) if joint.revolute else 1e3 * joint.velocity
