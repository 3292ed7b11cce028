"""A watch over dated recordings as a plain mapping for JSON."""

from __future__ import annotations

import math
from pathlib import PurePath
from typing import Any

from linkwright.core.diagnose.watch.watch import LEFT, Moved, Watch, Watched
from linkwright.version import program_version

from .diagnosis import in_unit, unit_of
from .fields import fields


def watch_json(found: Watch, sentence: str) -> dict[str, Any]:
    """What `watch --json` writes: values in the units of a diagnosis, dates in ISO 8601."""
    rules = found.rules
    return {
        "made_by": f"linkwright watch {program_version()}",
        "arm": found.arm.name,
        "sentence": sentence,
        "recordings": [
            {
                "date": each.date.isoformat(),
                "file": PurePath(each.file).name,
                **fields(each, "name", "rows", "rows_left_out=left_out"),
                "rms_left_mm": 1e3 * each.rms,
            }
            for each in found.recordings
        ],
        "alarms": [_alarm(found, each, change) for each in found.moved for change in each.changes],
        "parameters": [_watched(found, each) for each in found.parameters],
        "left": _watched(found, found.left),
        "not_watched": [fields(each, "effect", "at", "why") for each in found.unwatched],
        "verdict": None if found.together is None else found.together.verdict,
        "diagnosed_together": [found.recordings[k].date.isoformat() for k in found.searched],
        "false_alarm": {"chance": rules.false_alarm, "over_recordings": rules.over},
    }


def _name(each: Watched) -> dict[str, Any]:
    own = each.parameter
    effect = None if own.name == LEFT else own.effect
    return {"effect": effect, "at": list(own.at), "parameter": own.name, "unit": unit_of(own.kind)}


def _alarm(found: Watch, each: Watched, change: Moved) -> dict[str, Any]:
    kind, days = each.parameter.kind, [one.date.isoformat() for one in found.recordings]
    last = {"step": change.last, "once": change.first, "drift": change.first}[change.kind]
    until = len(days) - 1 if change.kind == "drift" else change.first
    rates = change.rate_interval
    return {
        **_name(each),
        "kind": change.kind,
        "from": days[last],
        "to": days[until],
        "earliest": days[max(change.earliest - 1, 0) if change.kind == "step" else change.earliest],
        "latest": days[change.latest],
        "change": in_unit(change.size, kind),
        "ci95": [in_unit(end, kind) for end in change.interval],
        "per_day": None if change.rate is None else in_unit(change.rate, kind),
        "per_day_ci95": None if rates is None else [in_unit(end, kind) for end in rates],
        "told": days[change.told],
        "p_value": change.p_value,
    }


def _watched(found: Watch, each: Watched) -> dict[str, Any]:
    kind = each.parameter.kind

    def told(value: float) -> float | None:
        return in_unit(float(value), kind) if math.isfinite(value) else None

    return {
        **_name(each),
        "found": each.parameter.found,
        "moved": each.moved,
        "values": [
            {
                "date": one.date.isoformat(),
                "value": told(each.values[k]),
                "standard_error": told(each.errors[k]),
                "ci95": [told(end) for end in each.intervals[k]],
                "level": told(each.level[k]),
                "limits": [told(end) for end in each.limits[k]],
            }
            for k, one in enumerate(found.recordings)
        ],
        "standard_deviation": told(each.deviation),
        "between_recordings": told(each.between),
        "smallest_step": told(each.smallest_step),
    }
