"""Imports and exports as plain mappings for JSON."""

from __future__ import annotations

import math
from typing import Any

from arm.chain.chain import Link
from arm.descriptions.formats import Exported
from arm.descriptions.imported import Imported
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
            }
            for name, carried, joint, link in chain
        ],
        "notes": list(found.notes),
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


def weight(link: Link) -> float:
    """The mass (kg) of an imported link."""
    return (link.mass or 0.0) + sum(each.mass for each in link.masses)
