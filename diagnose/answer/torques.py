"""What measured torques say of the weights, in words."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.fitting.loads.torque_loads import TorqueLoads
from linkwright.core.diagnose.residual.masses_from_torques import Weighed
from linkwright.core.diagnose.residual.torque import DriveTorque, Factor
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.units.quantities import format_quantity


def of_torque_loads(loads: TorqueLoads, rules: ResidualRules) -> tuple[str, ...]:
    """Whether links and payload weigh on the drives what the model says, by their torques; the friction found; and
    under what weights all that gives was judged."""
    sentences: list[str] = []
    if loads.carried is not None:
        held = format_quantity(loads.carried, "mass", digits=3)
        sentences.append(f"By the torques {held} hang at the tip throughout, which neither recording nor file has.")
    if loads.hung is not None:
        least, most = (format_quantity(mass, "mass", digits=2) for mass in loads.hung)
        sentences.append(
            f"By the torques {least} to {most} hang at the tip that were not recorded, different from visit to "
            "visit. Record them as `payload_kg`."
        )
    if loads.pushed is not None:
        most = format_quantity(loads.pushed, "force", digits=2)
        sentences.append(
            f"By the torques forces of up to {most} act on the tip that were not recorded. Record them as `fx_N`, ..."
        )
    for name, group in groupby(loads.torques, key=lambda torque: torque.of):
        before = f"{name}: " if name else ""
        sentences += [before + text for text in _of_one(list(group), loads.arm, rules)]
    return (*sentences, *_judged_under(loads))


def _judged_under(loads: TorqueLoads) -> list[str]:
    """Under what weights all that gives was judged, and what of the torques they do not make."""
    if not any((loads.carried, loads.hung, loads.pushed, *(torque.instead for torque in loads.torques))):
        return []
    sentences = ["What gives (drives, links, bearings) is judged under the loads that the torques show."]
    parts = [
        f"link {k + 1} {format_quantity(loads.arm.links[k].mass or 0.0, 'mass', digits=3)} (within "
        f"{196.0 * error:.2g} %)"
        for k, error in loads.links
    ]
    if parts:
        shown = f"{', '.join(parts)}{', and other centres of mass' * loads.moved}"
        sentences.append(f"The corrected arm has the weights that the torques show: {shown}.")
    sentences += [
        f"Weights of links and payload do not explain {100.0 * share:.2g} % of the changes in load on drive "
        f"{joint + 1}. A counterbalance or a force at the tip does. The compliance of this drive and beyond is known "
        "no better than this share."
        for joint, share in loads.unmade
    ]
    return sentences


def of_unknown_weights(shown: Weighed) -> tuple[str, ...]:
    """What the torques say that links of unknown mass weigh, and what of it they cannot say."""
    links, most = _numbered("link", shown.links), list[str]()
    for joint, load, _ in shown.drives:
        kind = "torque" if shown.arm.joints[joint].revolute else "force"
        most.append(f"{format_quantity(load, kind, digits=3)} on drive {joint + 1}")
    sure = ", ".join(f"{196.0 * error:.2g} % at drive {joint + 1}" for joint, _, error in shown.drives)
    sentences = [
        f"What {links} of unknown mass weigh{'s' * (len(shown.links) == 1)} is fitted to the torques: up to "
        f"{', '.join(most)}. Compliance is judged by these weights, and is known no better: within {sure}.",
        f"The written arm has masses of {links} that make these loads{', beside their lines too' * shown.beside}. "
        "Torques at rest show first moments, and no masses by themselves.",
    ]
    if shown.untold:
        sentences.append(f"The weight of {_numbered('link', shown.untold)} loads no drive, and stays unknown.")
    return tuple(sentences)


def _numbered(what: str, places: Sequence[int]) -> str:
    return f"{what}{'s' * (len(places) > 1)} {', '.join(str(place + 1) for place in places)}"


def _of_one(torques: Sequence[DriveTorque], arm: Arm, rules: ResidualRules) -> list[str]:
    sentences = list[str]()
    for each in torques:
        if each.scaled and each.links is not None and each.links.differs(rules):
            sentences.append(
                f"The torque of drive {each.joint + 1} is {_times(each.links)} what links and payload both give. Either"
                " its scale (a torque constant) is off, or weights and centres are off in this proportion. A payload"
                " whose mass and centre are known decides. Until then compliance is judged by the weights."
            )
        elif each.links is not None and each.links.differs(rules):
            sentences.append(
                f"By the torque of drive {each.joint + 1} the links{' and the payload' * each.together} beyond it weigh"
                f" on it {_times(each.links)} what the arm file says. Check masses and centres, or a counterbalance."
            )
    unscaled = [torque for torque in torques if not torque.scaled]
    sentences += _of_payload([(item.joint, item.payload) for item in unscaled if item.payload is not None], rules)
    if not sentences and (agreed := _agreed(torques, rules)):
        sentences.append(agreed)
    kinds = ["torque" if joint.revolute else "force" for joint in arm.joints]
    rubs = [
        f"{format_quantity(abs(torque.friction), kinds[torque.joint], digits=2)} at drive {torque.joint + 1}"
        for torque in torques
        if torque.friction is not None and abs(torque.friction) > rules.torque_seen * torque.spread
    ]
    if rubs:
        sentences.append(f"Friction by the torques: {', '.join(rubs)}.")
    return sentences


def _of_payload(factors: Sequence[tuple[int, Factor]], rules: ResidualRules) -> list[str]:
    """How much the payload weighs; drive by drive where they do not agree on one factor, which a mass would have."""
    common = _common([item for _, item in factors])
    if common is None:
        return []
    least = (max(rules.torque_off, rules.torque_sure * item.error) for _, item in factors)
    if any(abs(item.value - common.value) > far for (_, item), far in zip(factors, least, strict=True)):
        by_drive = ", ".join(f"{_times(item)} at drive {joint + 1}" for joint, item in factors)
        return [
            "By the torques the payload differs from the recording or the arm file by another factor at each drive: "
            f"{by_drive}. Its centre of mass is more likely off than its mass."
        ]
    sentence = f"By the torques the payload is {_times(common)} what the recording or the arm file says."
    return [sentence] if common.differs(rules) else []


def _agreed(torques: Sequence[DriveTorque], rules: ResidualRules) -> str:
    """That the torques bear the weights out, as far as they tell."""
    known = [torque for torque in torques if torque.links is not None and rules.torque_sure * torque.links.error <= 0.5]
    if not known:
        return ""
    worst = max(abs(item.links.value - 1.0) for item in known if item.links is not None)
    drives = f"drive{'s' * (len(known) > 1)} {', '.join(str(item.joint + 1) for item in known)}"
    return f"Torques confirm the weights of the links: within {100.0 * worst:.2g} % at {drives}."


def _common(factors: Sequence[Factor]) -> Factor | None:
    """One factor from several, each by how well it is known."""
    if not factors:
        return None
    weight = np.array([1.0 / max(factor.error, 1e-12) ** 2 for factor in factors])
    value = float(weight @ [factor.value for factor in factors] / weight.sum())
    return Factor(value, float(1.0 / np.sqrt(weight.sum())))


def _times(factor: Factor) -> str:
    span = 1.96 * factor.error
    return f"{factor.value:.3g} times ({factor.value - span:.3g} to {factor.value + span:.3g})"
