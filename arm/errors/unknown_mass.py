"""Links of unknown mass: an arm may be asked all that does not depend on what they weigh.

Where nothing gives under them, or what gives says so as a product of compliance and weight (`unknown_weight`), the tip
is where it is whatever they weigh, and they count as weightless. Where their mass moves the tip, the question cannot be
put, and the error says which link and what gives.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from linkwright.core.arm.bodies.beams import MassNeeded
from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.effects.elastic.joint_compliance import JOINT_COMPLIANCE
from linkwright.core.arm.effects.elastic.lateral_compliance import LATERAL_COMPLIANCE
from linkwright.core.sections.numeric import Array

from .model import beams_of
from .tip import ActiveEffect, active_effects, carried_to_tip

_POSES, _SEED = 8, 1
_MOVED = 1e-12
"""m; a kilogram that moves the tip by less moves nothing but rounding."""
_SAME_PAYLOAD = 1e-9
"""Of the payload, or of a kilogram: payloads that differ by less are one, written twice."""


def of_unknown_mass(arm: Arm) -> tuple[int, ...]:
    """The links (from 0) that have neither a section nor a known mass."""
    return tuple(index for index, link in enumerate(arm.links) if link.section is None and link.mass is None)


def without_unknown(arm: Arm, unknown: Sequence[int]) -> Arm:
    """The arm with these links (from 0) weightless."""
    return _with_masses(arm, unknown, {})


def unknown_taken_out(arm: Arm, loads: Sequence[LoadCase] = ()) -> Arm:
    """The arm with its links of unknown mass weightless, where that changes nothing of its tip's error.

    Raises `MassNeeded` where it would: it names the link and what gives under it.
    """
    unknown = of_unknown_mass(arm)
    if not unknown:
        return arm
    bare = without_unknown(arm, unknown)
    if not any(arm.gravity):
        return bare
    remaining = _without_what_products_say(bare)
    lower, upper = np.array([joint.range for joint in arm.joints]).T
    q = lower + (upper - lower) * np.random.default_rng(_SEED).random((_POSES, arm.size))
    cases = tuple(loads) or arm.cases
    for link in unknown:
        heavier = _with_masses(remaining, unknown, {link: 1.0})
        for active in active_effects(remaining):
            if any(_differ(remaining, heavier, active, q, case) for case in cases):
                why = f"{_named(active)} moves the tip by its weight"
                raise MassNeeded(arm, link, why, ", or take what a diagnosis finds of it")
    return bare


def weighs_nothing(arm: Arm) -> bool:
    """Whether an arm that stands under gravity has no weight of its own: 0 kg in every link and joint."""
    bare = all(link.section is None and link.mass == 0.0 for link in arm.links)
    carried = arm.carried_mass - sum(branch.payload.mass for branch in arm.branches if branch.name != arm.tip)
    return bare and carried == 0.0 and any(arm.gravity)


def gives_unknown(arm: Arm) -> tuple[str, ...]:
    """What gives in the arm by a compliance of which only the product with an unknown weight is known, in words."""
    products: list[str] = []
    for entry in arm.effects:
        named = {"compliance", "compliance_about_z", "flexibility", "stiffness"} & set(entry.parameters)
        if "unit_sag" in entry.parameters and not named:
            active = next(effect for effect in active_effects(replace(arm, effects=(entry,))) if effect.settings.values)
            products.append(_named(active))
    return tuple(products)


def payloads_left_out(arm: Arm, payloads: Iterable[float]) -> str | None:
    """What payloads (kg) other than the arm's own would add and the model cannot say, in words; None where it can say
    all of it. A product with an unknown weight was found under one payload, and tells nothing of another's."""
    payload = arm.payload.mass
    other = sorted({mass for mass in payloads if abs(mass - payload) > _SAME_PAYLOAD * max(payload, 1.0)})
    products = gives_unknown(arm) if other else ()
    if not products:
        return None
    masses = ", ".join(f"{mass:.4g}" for mass in other)
    return (
        f"another payload ({masses} kg) is not counted through {', '.join(products)}, known with {payload:.4g} kg "
        "alone as a product with an unknown weight. A recording with the other payload would show its effect"
    )


def _with_masses(arm: Arm, unknown: Sequence[int], masses: dict[int, float]) -> Arm:
    links = tuple(
        replace(link, mass=masses.get(index, 0.0)) if index in unknown else link for index, link in enumerate(arm.links)
    )
    return arm.with_links(links)


def _without_what_products_say(arm: Arm) -> Arm:
    """The arm without what gives under unknown weights by products: they say all that the weights do there."""
    entries = [entry for entry in arm.effects if "unit_sag" in entry.parameters]
    products = {(entry.effect, number) for entry in entries for number in entry.at}
    joints = [
        replace(joint, stiffness=None, zones=()) if (JOINT_COMPLIANCE.id, number) in products else joint
        for number, joint in enumerate(arm.joints, start=1)
    ]
    joints = tuple(
        replace(joint, tilting_stiffness=None) if (LATERAL_COMPLIANCE.id, number) in products else joint
        for number, joint in enumerate(joints, start=1)
    )
    return replace(arm, joints=joints, effects=tuple(entry for entry in arm.effects if entry not in entries))


def _differ(arm: Arm, other: Arm, active: ActiveEffect, q: Array, case: LoadCase) -> bool:
    """Whether an effect moves the tips of two arms otherwise, at poses q (N, n)."""
    moved = [_moved(item, active, q, case) for item in (arm, other)]
    return bool(np.abs(moved[0] - moved[1]).max() > _MOVED)


def _moved(arm: Arm, active: ActiveEffect, q: Array, case: LoadCase) -> Array:
    state: PoseState = solve(arm, [q[:, index] for index in range(arm.size)], beams_of(arm, (case,)), case)
    twists = list(active.effect.twists(state, active.settings))
    if arm.play == "loaded":
        twists += active.effect.play.seated(state, active.settings)
    return columns(carried_to_tip(state, twists), len(q))


def _named(active: ActiveEffect) -> str:
    at = [index + 1 for index in active.settings.at]
    where = f" at {active.effect.place}{'s' if len(at) > 1 else ''} {', '.join(map(str, at))}" if at else ""
    return f"{active.effect.title}{where}"
