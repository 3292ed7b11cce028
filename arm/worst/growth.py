"""What thermal growth adds to an arm's worst error where its model leaves it out.

An arm that works at another temperature than 20 degC, at which its lengths hold (ISO 1), is longer or shorter there.
The model counts that only where the arm's `effects` name thermal expansion; where they do not, this says what they
leave out, by the same effect's twists.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from linkwright.core.arm.chain.chain import Arm, EffectEntry, LoadCase
from linkwright.core.arm.effects.thermal.thermal_expansion import THERMAL_EXPANSION
from linkwright.core.arm.errors.calibrated import calibrated_temperature
from linkwright.core.arm.errors.model import error_model
from linkwright.core.sections.numeric import Array
from linkwright.core.units.quantities import format_quantity
from linkwright.core.units.temperature import REFERENCE_TEMPERATURE, ZERO_CELSIUS

from .parts import worst_search
from .workspace import Workspace

_SAME = 1e-6
"""Temperatures (K) that differ by less are one."""


@dataclass(frozen=True)
class GrowthLeftOut:
    """Thermal growth that a model leaves out: from `since` (K), 20 degC or where the arm was calibrated, to
    `temperature` (K).

    `error` is the worst error (m) over the workspace with it, None where no link's material says how much it grows;
    `unknown` are the links (from 0) whose material does not, and whose growth is therefore not in it.
    """

    temperature: float
    error: float | None
    unknown: tuple[int, ...]
    since: float = REFERENCE_TEMPERATURE

    def words(self, error: float) -> str:
        """A warning, beside the worst error (m) without growth."""
        span = f"{self.temperature - self.since:+.4g} K from {self.since - ZERO_CELSIUS:.4g} degC"
        opening = f"thermal expansion is not counted ({span})"
        numbers = " and ".join(str(link + 1) for link in self.unknown)
        if self.error is None:
            return f"{opening}, and no link's material has a thermal_expansion that would tell what it adds"
        with_it, without = (format_quantity(item, "length", "mm", 4) for item in (self.error, error))
        rest = f", without that of link {numbers}, which is not known" if self.unknown else ""
        return (
            f"{opening}: with it the worst error is {with_it}, not {without}{rest}; "
            f"effects: [{{effect: {THERMAL_EXPANSION.id}}}] in the arm file counts it"
        )


def growth_left_out(
    arm: Arm, cases: Sequence[LoadCase], space: Workspace, p: Array, *, gap: float
) -> GrowthLeftOut | None:
    """The thermal growth that an arm's model leaves out over a workspace, for beams p (see `arm.errors.model`); None
    at 20 degC, or at the temperature at which it was calibrated where errors count from that, and where the arm's
    `effects` have it, at whatever links."""
    counted = any(entry.effect == THERMAL_EXPANSION.id for entry in arm.effects)
    since = REFERENCE_TEMPERATURE
    if any(case.relative_to is not None for case in cases):
        calibrated_at = calibrated_temperature(cases)
        since = arm.temperature if calibrated_at is None else calibrated_at
    if counted or abs(arm.temperature - since) < _SAME:
        return None
    materials = [None if link.material is None else link.material.at(arm.temperature) for link in arm.links]
    grows = [material is not None and material.thermal_expansion is not None for material in materials]
    unknown = tuple(index for index, known in enumerate(grows) if not known)
    if not any(grows):
        return GrowthLeftOut(arm.temperature, None, unknown, since)
    at = tuple(number for number, known in enumerate(grows, start=1) if known)
    grown = replace(arm, effects=(*arm.effects, EffectEntry(THERMAL_EXPANSION.id, at)))
    worst = worst_search(error_model(grown, cases), space, gap=gap).worst(p)
    return GrowthLeftOut(arm.temperature, worst.error, unknown, since)
