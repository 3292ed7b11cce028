"""Default assumptions of an evaluation where the files say nothing, one sentence each: its notes."""

from __future__ import annotations

import math
from collections.abc import Sequence

from linkwright.core.arm.bodies.warping import FREE, warping_of
from linkwright.core.arm.chain.chain import Arm, LoadCase
from linkwright.core.arm.effects.elastic.lateral_compliance import LATERAL_COMPLIANCE
from linkwright.core.arm.placed.heights import height_sentences
from linkwright.core.sections.taper import Tapered
from linkwright.core.units.quantities import format_quantity


def notes_of(arm: Arm, cases: Sequence[LoadCase]) -> tuple[str, ...]:
    """The assumptions behind the figures of an arm under load cases, most far-reaching first."""
    return (
        *default_gravity(arm),
        *payloads_left_off(cases),
        *level_slides(arm),
        *rigid_bearings(arm),
        *twisted_links(arm, cases),
        *height_sentences(arm),
    )


def default_gravity(arm: Arm) -> list[str]:
    """One line for an arm in space whose file does not say where gravity acts."""
    if arm.gravity_given or arm.flat:
        return []
    acts = ", ".join(format_quantity(component, "acceleration") for component in arm.gravity)
    return [
        f"no gravity is given: it acts along -y of the base frame ([{acts}]); where z is up, write "
        "gravity: [0 m/s^2, 0 m/s^2, -9.81 m/s^2]"
    ]


def level_slides(arm: Arm) -> list[str]:
    """One line for a slide behind two upright axes (a SCARA's spindle) that runs along the link before it."""
    up = (0.0, 0.0, 1.0)
    upright = [joint.revolute and joint.axis == up for joint in arm.joints[:2]]
    if upright != [True, True] or arm.gravity[:2] != (0.0, 0.0) or arm.branches:
        return []
    level = [k for k, joint in enumerate(arm.joints) if not joint.revolute and joint.axis == (1.0, 0.0, 0.0)]
    return [f"joint {k + 1} slides level, along link {k}; `axis: z` at the joint makes it upright" for k in level[:1]]


def twisted_links(arm: Arm, cases: Sequence[LoadCase]) -> list[str]:
    """How open sections twist, one line a link: where loads at the centroid twist it, and which ends hold warping."""
    if all(arm.planar(case) for case in cases):
        return []
    lines: list[str] = []
    for index, link in enumerate(arm.links):
        if link.section is None or not (link.asymmetry.eccentric or link.asymmetry.warps):
            continue
        about = ""
        if link.asymmetry.eccentric:
            offset = math.hypot(*(float(part) for part in link.section.properties(0.3).shear_centre))
            about = f" about its shear centre, {format_quantity(offset, 'length', digits=3)} off its centroid"
        ends = FREE if isinstance(link.section, Tapered) else warping_of(arm, index)
        held = "its warping is free at both ends"
        if ends.at_joint:
            far = "at both ends" if ends.at_far_end else "at its joint and free at the tip"
            held = f"its warping is held {far}"
        also = f"; {held}" if link.asymmetry.warps else ""
        lines.append(f"link {index + 1} ({link.section.shape.replace('_', ' ')}) twists{about}{also}")
    return lines


def payloads_left_off(cases: Sequence[LoadCase]) -> list[str]:
    """One line for the load cases that name no payload while the arm carries one."""
    tips_by_mass: dict[float, list[str]] = {}
    for number, case in enumerate(cases, start=1):
        if case.leaves_off:
            tips_by_mass.setdefault(case.leaves_off, []).append(str(number))
    return [
        f"load case{'s' if len(numbers) > 1 else ''} {', '.join(numbers)} name{'' if len(numbers) > 1 else 's'} no "
        f"payload and so leave{'' if len(numbers) > 1 else 's'} off the arm's {format_quantity(mass, 'mass')}; "
        f"payload: {{mass: {format_quantity(mass, 'mass')}}} keeps it"
        for mass, numbers in tips_by_mass.items()
    ]


def rigid_bearings(arm: Arm) -> list[str]:
    """One line for the joints of an arm in space whose drives give while nothing is known of how their bearings do."""
    if arm.flat or LATERAL_COMPLIANCE.id in arm.leave_out:
        return []
    places = [entry.at for entry in arm.effects if entry.effect == LATERAL_COMPLIANCE.id]
    bare = [
        number
        for number, joint in enumerate(arm.joints, start=1)
        if joint.revolute
        and joint.tilting_stiffness is None
        and (joint.stiffness is not None or joint.actuator is not None)
        and not any(not at or number in at for at in places)
    ]
    if not bare:
        return []
    names = dict.fromkeys(actuator.name for number in bare if (actuator := arm.joints[number - 1].actuator) is not None)
    lacking = f"the catalogue has none for {', '.join(names)}" if names else "none is given"
    return [
        f"the bearing{'s' if len(bare) > 1 else ''} of joint{'s' if len(bare) > 1 else ''} "
        f"{', '.join(map(str, bare))} count{'' if len(bare) > 1 else 's'} as rigid against tilting: {lacking}; "
        "tilting_stiffness at a joint says it"
    ]
