"""Torques that are counted the other way: as what the load does to the drive, or along a turned axis."""

from __future__ import annotations

from collections.abc import Sequence

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass
from linkwright.core.diagnose.reading.foreign.headers import Headers
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.masses_from_torques import against_any_masses
from linkwright.core.diagnose.residual.observe import undeformed
from linkwright.core.diagnose.residual.torque import DriveTorque, Factor, drive_torques
from linkwright.core.diagnose.residual.visits import visits
from linkwright.core.diagnose.rules.residual_rules import ResidualRules


def refuse_torques_of_another_sign(recording: Recording, arm: Arm, headers: Headers, *, rules: ResidualRules) -> None:
    """Raise `InputError` where drives would pull with the load that they hold: of links of unknown mass, with any load
    that they could have."""
    if recording.torque is None:
        return
    if of_unknown_mass(arm):
        _refuse(recording, [mass.joint for mass in against_any_masses(arm, recording, rules=rules)], headers)
        return
    state = undeformed(arm, recording, rules)
    drives = drive_torques(arm, recording, state, visits(recording, arm, rules=rules), rules)
    _refuse(recording, [drive.joint for drive in drives if _is_against(drive, rules)], headers)


def _refuse(recording: Recording, joints: Sequence[int], headers: Headers) -> None:
    if not joints:
        return
    names = [headers.get(f"tau{joint + 1}", f"tau{joint + 1}") for joint in joints]
    message = (
        "goes against what links and payload weigh: torque counts positive where the drive pushes towards increasing q"
    )
    raise headers.refusal(recording.file, ", ".join(names), message, {"columns": {name: f"-{name}" for name in names}})


def _is_against(drive: DriveTorque, rules: ResidualRules) -> bool:
    def sure(factor: Factor | None) -> bool:
        return factor is not None and factor.value < -rules.torque_sure * factor.error

    return drive.along <= rules.torque_against and (sure(drive.links) or sure(drive.payload))
