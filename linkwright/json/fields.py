"""Fields of a result as entries of JSON."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.sections.numeric import Array


def fields(item: object, *keys: str) -> dict[str, Any]:
    """Some fields of an object by key. A key is the name of its field, or says it (`since_s=since`); one that ends in
    `_mm` gives the metres of the field without that ending in mm."""
    found: dict[str, Any] = {}
    for each in keys:
        key, _, name = each.partition("=")
        value = getattr(item, name or key.removesuffix("_mm"))
        found[key] = in_mm(value) if key.endswith("_mm") else list(value) if isinstance(value, tuple) else value
    return found


def in_mm(metres: float | Sequence[Any] | None) -> Any:
    """A length or points (m) in mm; None where it is not known."""
    if isinstance(metres, Sequence):
        return [in_mm(each) for each in metres]
    return None if metres is None or not math.isfinite(metres) else 1e3 * metres


def joint_columns(arm: Arm, q: Array, prefix: str = "q") -> dict[str, Array]:
    """Joint coordinates (N, n), or changes of them, as columns in degrees and mm: `q1_deg`, `q2_mm`."""
    return {
        f"{prefix}{number}_{'deg' if joint.revolute else 'mm'}": np.degrees(values) if joint.revolute else 1e3 * values
        for number, (joint, values) in enumerate(zip(arm.joints, q.T, strict=True), start=1)
    }
