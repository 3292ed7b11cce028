"""A link's flange as an arm file gives it: what gives between its far end and all that follows, and its mass."""

from __future__ import annotations

from linkwright.core.arm.chain.balance import PointMass
from linkwright.core.arm.chain.chain import Flange
from linkwright.core.units.reading import Mapping

_STIFFNESSES = ("tilting_stiffness", "torsional_stiffness")


def read_flange(link: Mapping) -> tuple[Flange | None, tuple[PointMass, ...]]:
    """A link's flange where it gives (None: rigid, or none), and its mass at the far end. Raises `InputError`."""
    if not link.has("flange"):
        return None, ()
    with link.mapping("flange").reading() as body:
        values = {name: body.optional_quantity(name, "torsional_stiffness") for name in _STIFFNESSES}
        for name, value in values.items():
            if value is not None and value <= 0.0:
                raise body.error(name, "must be positive; leave it out where the flange is rigid")
        mass = body.not_negative("mass", "mass", 0.0)
        if not mass and not any(values.values()):
            raise body.error("", "says nothing; give tilting_stiffness, torsional_stiffness or mass")
    flange = Flange(**values) if any(values.values()) else None
    return flange, (PointMass(mass, on="end"),) if mass else ()
