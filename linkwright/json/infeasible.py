"""Why a problem has no answer as JSON: what each limit would have to be, and the smallest joint change."""

from __future__ import annotations

from pathlib import PurePath
from typing import Any

from linkwright.core.optimize.infeasible.answer import Infeasibility
from linkwright.core.optimize.limits import Limit
from linkwright.version import program_version

from .fields import fields


def infeasible_json(found: Infeasibility, command: str, problem: object = "") -> dict[str, Any]:
    """What `--json` writes where no design keeps all limits, in the units that people read."""
    return {
        "made_by": f"linkwright {command} {program_version()}",
        "problem": PurePath(str(problem)).name,
        "status": found.verdict,
        "infeasible": {
            "because": found.text,
            "out_of_reach": [
                {**_asked(each.limit), "best": each.limit.figure.shown(each.best), "because": each.because}
                for each in found.out_of_reach
            ],
            "limits": [
                {
                    **_asked(each.limit),
                    "needed": each.limit.figure.shown(each.needed),
                    "outcome": each.outcome,
                    "rests_on": found.rests_on,
                }
                for each in found.limits
            ],
            "joint_change": [
                {**_asked(each.limit), "needed": each.limit.figure.shown(each.needed), "rests_on": found.rests_on}
                for each in found.joint
            ],
            **fields(found, "joint_sum", "combinations", "unsolved", "rests_on", "kept"),
        },
    }


def _asked(limit: Limit) -> dict[str, Any]:
    return {
        "name": limit.name,
        "limit": limit.text,
        "relation": limit.relation,
        "asked": limit.figure.shown(limit.value),
        "unit": limit.figure.unit,
        "assumed": limit.assumed,
    }
