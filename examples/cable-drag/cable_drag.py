"""A hose bundle that is kept taut across a joint pulls at it, and the joint's drive winds up.

A retractor keeps the bundle taut with a force F that hardly changes. The bundle runs from a clamp at distance a from
the joint's axis, on the link before, to one at distance b on the link after. At the joint's coordinate q both clamps
are d = sqrt(a^2 + b^2 - 2 a b cos(q - q0)) apart, and at q0 nearest. By virtual work the pull turns the joint with
tau = -F dd/dq = -F a b sin(q - q0)/d, and a drive of stiffness K gives by tau/K.
"""

from __future__ import annotations

from collections.abc import Iterator

import linkwright as lw

BEFORE, AFTER = 0.12, 0.15


def _twists(state: lw.PoseState, settings: lw.Settings) -> Iterator[lw.Twist]:
    pull = settings.values.get("pull", 0.0)
    before, after = settings.values.get("before", BEFORE), settings.values.get("after", AFTER)
    nearest = settings.values.get("nearest", 0.0)
    for index, joint in enumerate(state.joints):
        if pull == 0.0 or not joint.revolute or joint.stiffness is None or not settings.acts_at(index):
            continue
        angle = joint.coordinate - nearest
        apart = (before**2 + after**2 - 2.0 * before * after * lw.numeric.cos(angle)) ** 0.5
        torque = -pull * before * after * lw.numeric.sin(angle) / apart
        yield from lw.drive_motion(state, index, torque / joint.stiffness)


CABLE_DRAG = lw.Effect(
    id="cable_drag",
    title="pull of a hose bundle",
    formula="-J_i F a b sin(q_i - q0)/(d K_i), d^2 = a^2 + b^2 - 2 a b cos(q_i - q0)",
    place="joint",
    cause="loads",
    automatic=False,
    needs="wide travel of the joint, through where the clamps are nearest",
    aliases=("encoder_eccentricity", "counterbalance"),
    source="virtual work of a constant pull between two points, e.g. R. C. Hibbeler, Engineering Mechanics: Statics "
    "(14th ed., Pearson, 2016), ch. 11",
    parameters=(
        lw.Parameter(
            "pull",
            "force",
            "pull of the bundle's retractor",
            0.0,
            500.0,
            (5.0, 80.0),
            "dress packs of industrial robots: some ten newtons",
            role="size",
        ),
        lw.Parameter(
            "before", "length", "clamp to axis, on the link before", 0.01, 1.0, (0.1, 0.3), "room beside a joint"
        ),
        lw.Parameter(
            "after", "length", "clamp to axis, on the link after", 0.01, 1.0, (0.1, 0.3), "room beside a joint"
        ),
        lw.Parameter(
            "nearest", "angle", "where the clamps are nearest", -3.2, 3.2, (0.0, 1.0), "how the bundle is routed"
        ),
    ),
    twists=_twists,
    linear=True,
    only="joints that turn",
    recording=lw.traits.RecordingTraits(least_travel=0.5),
)
