"""A link's material is stiffer or softer than its data sheet: all that the link gives changes in proportion."""

from __future__ import annotations

import math
from collections.abc import Iterator

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.chain.vectors import scale
from linkwright.core.arm.effects.effect import Effect, Settings, Twist, size
from linkwright.core.arm.effects.traits import LinkTraits, RecordingTraits

from .axial import AXIAL
from .link_bending import LINK_BENDING
from .shear_deformation import SHEAR_DEFORMATION
from .slope_propagation import SLOPE_PROPAGATION
from .torsion import TORSION

LINK_ELASTIC: tuple[Effect, ...] = (LINK_BENDING, SLOPE_PROPAGATION, AXIAL, TORSION, SHEAR_DEFORMATION)
"""How a link gives, in proportion to its load and to the reciprocal of its moduli."""


def _twists(state: PoseState, settings: Settings) -> Iterator[Twist]:
    excess = settings.values.get("excess", 0.0)
    if excess == 0.0:
        return
    more = 1.0 / (1.0 + excess) - 1.0
    for effect in LINK_ELASTIC:
        if effect.id not in state.arm.leave_out:
            for twist in effect.twists(state, Settings(settings.at)):
                yield Twist(twist.node, twist.index, scale(more, twist.translation), scale(more, twist.rotation))


def _size_from_slope(excess: float) -> float:
    """The pattern is that of a small excess x, and what the link gives goes with 1/(1 + x)."""
    return 1.0 / (1.0 - excess) - 1.0 if excess < 1.0 else math.inf


LINK_MODULUS = Effect(
    id="link_modulus",
    title="true moduli of the links",
    formula="(1/(1 + x) - 1) times bending, slope, axial strain, torsion and shear of link i, x = E/E_nominal - 1",
    place="link",
    cause="flexibility",
    needs="payloads",
    aliases=("joint_compliance", "link_bending", "slope_propagation"),
    source="Gere & Goodno, Mechanics of Materials: deflections go with 1/E (and 1/G, Poisson's ratio kept)",
    parameters=(
        size("excess", "dimensionless", -0.9, 3.0, (0.05, 0.4)).means(
            "true modulus over the one in the file, less one",
            "metals scatter by 5 %; castings, laminates and plastics by up to 40 %",
        ),
    ),
    twists=_twists,
    link=LinkTraits(along=True, flexible=True),
    together=True,
    rank=70,
    recording=RecordingTraits(size_from_slope=_size_from_slope),
)
