"""What is asked for of a recording, from its truth."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from benchmarks.blind.parameters import UNITS
from benchmarks.canonical.asked import REFUSED

LOUD = 2.0
"""Times the noise from which on a cause of a tip has to be named."""
TOLERANCE = 0.2
"""Relative, of a size; what an interval holds is right, too."""
NOTHING, SAID = ["none", "insufficient_data"], ["alias_class", "named"]


def asked_of(truth: Mapping[str, Any]) -> dict[str, Any]:
    """Verdicts that will do, causes to be named, causes that may be, and sizes with tolerances."""
    kind, effects = truth["kind"], truth["effects"]
    loud = [item for item in effects if item["large"] and item.get("snr", LOUD) >= LOUD]
    quiet = [item for item in effects if item not in loud]
    verdict = {
        "null": NOTHING,
        "unknown": ["unknown"],
        "swapped": [REFUSED],
        "mislabelled": [REFUSED, "unknown", "insufficient_data"],
    }.get(kind, SAID if loud else [*NOTHING, *SAID])
    sizes = {
        f"{item['effect']}.{name}": [parameter["value"] * UNITS[parameter["unit"]][1], TOLERANCE]
        for item in loud
        for name, parameter in item["parameters"].items()
        if parameter["value"]
    }
    return {
        "verdict": list(verdict),
        "names": [[item["effect"], item["at"]] for item in loud] if kind != "unknown" else [],
        "others": [[item["effect"], item["at"]] for item in (quiet if kind != "unknown" else effects)],
        "sizes": sizes if kind != "unknown" else {},
        "joints": truth.get("joints", 0),
        "line": truth.get("line", []),
    }
