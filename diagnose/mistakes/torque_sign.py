"""Torques that are counted the other way: as what the load does to the drive, or along a turned axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.masses_from_torques import against_any_masses, unweighed
from linkwright.core.diagnose.residual.observe import undeformed
from linkwright.core.diagnose.residual.torque import DriveTorque, Factor, drive_torques
from linkwright.core.diagnose.residual.visits import visits
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.units.quantities import InputError


def refuse_torques_of_another_sign(
    recording: Recording, arm: Arm, headers: Mapping[str, str], *, rules: ResidualRules
) -> None:
    """Raise `InputError` where drives would pull with the load that they hold: of links of unknown mass, with any load
    that they could have."""
    if recording.torque is None:
        return
    if unweighed(arm):
        _refuse(recording, [each.joint for each in against_any_masses(arm, recording, rules=rules)], headers)
        return
    state = undeformed(arm, recording, rules)
    told = drive_torques(arm, recording, state, visits(recording, arm, rules=rules), rules)
    _refuse(recording, [each.joint for each in told if _is_against(each, rules)], headers)


def _refuse(recording: Recording, joints: Sequence[int], headers: Mapping[str, str]) -> None:
    if not joints:
        return
    names = [headers.get(f"tau{joint + 1}", f"tau{joint + 1}") for joint in joints]
    pairs = ", ".join(f"{name}: -1*{name}" for name in names)
    raise InputError(
        recording.file,
        ", ".join(names),
        "goes against what links and payload weigh: torque counts positive where the drive pushes towards increasing "
        f"q; write `columns: {{{pairs}}}` in recording.yaml if it counts the other way",
    )


def _is_against(told: DriveTorque, rules: ResidualRules) -> bool:
    def sure(factor: Factor | None) -> bool:
        return factor is not None and factor.value < -rules.torque_sure * factor.error

    return told.along <= rules.torque_against and (sure(told.links) or sure(told.payload))
