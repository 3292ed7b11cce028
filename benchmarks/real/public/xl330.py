"""A hobby servo without a current: a Dynamixel XL330 swings a pendulum, diagnosed by the voltages of its loop.

Logs by three gains are learned on, those by the greatest judge: what is left of the voltage where the joint moves, by
our file and by the models that the authors of BAM published, all on the same low-passed samples.

M. Duclusaud, G. Passault, V. Padois & O. Ly, Extended friction models for the physics simulation of servo actuators,
ICRA 2025, 12091-12097.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.real.public.where import public_folder
from linkwright.core.arm.files.read import read_arm
from linkwright.core.arm.motion.dynamics import model_torque
from linkwright.core.diagnose.motion.diagnosis import diagnose_motion
from linkwright.core.diagnose.motion.preparation import PreparedLog, prepare
from linkwright.core.diagnose.motion.reading.read import read_log
from linkwright.core.diagnose.motion.result import MotionDiagnosis
from linkwright.core.diagnose.rules.rules import RULES

Array = NDArray[np.float64]

MOTIONS = ("sin_sin", "up_and_down", "sin_time_square")
LEARNED, JUDGED = (100, 200, 400), 800
"""Gains of the firmware."""
_ROUNDS = 60
"""Times that friction by a torque is worked out of that torque: it takes less than half, and halves at each."""


@dataclass(frozen=True)
class Left:
    """What a model leaves of the voltages of one motion, V RMS and mean of absolute values."""

    rms: float
    mean: float


@dataclass(frozen=True)
class Compared:
    """A diagnosis, the torque constant (N*m/V) that the pendulum's weight makes, what BAM's authors `published`, and by
    model (ours is called "ours") what is `left` of each judged motion."""

    diagnosis: MotionDiagnosis
    constant: float
    published: Mapping[str, Mapping[str, float]]
    left: Mapping[str, Mapping[str, Left]]


def compared() -> Compared:
    """Our file, and published models, on logs that neither was fitted to."""
    folder = public_folder("xl330")
    arm = read_arm(folder / "arm.yaml")
    logs = {
        (name, gain): read_log(folder / f"{name}_{gain}.csv", arm) for name in MOTIONS for gain in (*LEARNED, JUDGED)
    }
    diagnosis = diagnose_motion(arm, [log for (_, gain), log in logs.items() if gain in LEARNED])
    (constant,) = diagnosis.logs[0].weighed or (float("nan"),)
    published = json.loads((folder / "published.json").read_text(encoding="utf-8"))
    left: dict[str, dict[str, Left]] = {}
    for name in MOTIONS:
        log = logs[name, JUDGED]
        prepared = prepare(diagnosis.corrected, replace(log, torque_constants_free=False), rules=RULES)
        torque = model_torque(prepared.motion)[:, 0]
        left.setdefault("ours", {})[name] = _left(prepared, torque / constant)
        for model, values in published.items():
            left.setdefault(model, {})[name] = _left(prepared, voltage_by_bam(prepared, values))
    return Compared(diagnosis, constant, published, left)


def voltage_by_bam(log: PreparedLog, values: Mapping[str, float]) -> Array:
    """The voltage (N,) that a motion takes by one of BAM's models M1 to M6, as their equations have it: friction as a
    torque against the motion, by the torques of motor and weight."""
    link = log.motion.arm.links[0]
    mass, length = link.mass, link.length
    assert isinstance(mass, float)
    q, speed, spin = log.motion.q[:, 0], log.motion.velocity[:, 0], log.motion.acceleration[:, 0]
    has = values.get
    weight = -mass * 9.80665 * length * np.sin(q + has("q_offset", 0.0))
    needed = (mass * length**2 + values["armature"]) * spin - weight + values["friction_viscous"] * speed
    slow = np.exp(-(np.abs(speed / has("dtheta_stribeck", 1.0)) ** has("alpha", 1.0)))
    motor = needed
    for _ in range(_ROUNDS):
        along, against = has("load_friction_motor", 0.0), has("load_friction_external", 0.0)
        dry = values["friction_base"] + slow * has("friction_stribeck", 0.0)
        if "load_friction_base" in values:
            share = values["load_friction_base"] + slow * has("load_friction_stribeck", 0.0)
            dry = dry + share * np.abs(weight - motor)
        elif "load_friction_motor" in values:
            dry = dry + np.abs(weight * against - motor * along)
            of_slow = has("load_friction_external_stribeck", 0.0), has("load_friction_motor_stribeck", 0.0)
            dry = dry + slow * np.abs(weight * of_slow[0] - motor * of_slow[1])
            driven = np.abs(weight) < np.abs(motor)
            squares = np.where(
                driven,
                has("load_friction_external_quad", 0.0) * weight**2,
                has("load_friction_motor_quad", 0.0) * motor**2,
            )
            dry = dry + slow * squares * (np.sign(weight) != np.sign(motor))
        motor = 0.5 * (motor + needed + dry * np.sign(speed))
    return np.asarray(values["R"] / values["kt"] * motor + values["kt"] * speed)


def _left(log: PreparedLog, voltage: Array) -> Left:
    """What a voltage (N,) leaves where the joint moves steadily."""
    off = np.concatenate([log.filtered((log.measured[:, 0] - voltage)[s.start : s.stop]) for s in log.stretches])
    counting = off[log.kept][log.moving[:, 0]]
    return Left(float(np.sqrt(np.mean(counting**2))), float(np.mean(np.abs(counting))))


def evaluate(tell: Callable[[str], None] = print) -> None:
    """Print what is said of the servo, its constants beside the published ones, and what each model leaves."""
    result = compared()
    tell("## XL330 servo\n")
    tell(f"{result.diagnosis.sentence}\n")
    tell("| | kt/R, N m/V | kt^2/R and viscous, N m s/rad | dry, N m | rotor, kg m^2 | by load |")
    tell("|---|---|---|---|---|---|")
    found = {(item.effect, p.parameter): p.value for item in result.diagnosis.findings for p in item.parameters}
    speed = found.get(("friction_viscous", "coefficient"), 0.0) + found.get(("back_emf", "coefficient"), 0.0)
    by_load = {name: value for (effect, name), value in found.items() if effect in ("gear_efficiency", "friction_load")}
    dry, rotor = (found.get(key, 0.0) for key in (("friction_coulomb", "torque"), ("armature", "inertia")))
    tell(f"| ours | {result.constant:.4f} | {speed:.4f} | {dry:.4f} | {rotor:.5f} | {_worded(by_load)} |")
    for model, values in result.published.items():
        speed = values["kt"] ** 2 / values["R"] + values["friction_viscous"]
        shares = {name: value for name, value in values.items() if name.startswith("load_") and value > 1e-3}
        figures = f"{values['kt'] / values['R']:.4f} | {speed:.4f} | {values['friction_base']:.4f}"
        tell(f"| {model} | {figures} | {values['armature']:.5f} | {_worded(shares)} |")
    tell(f"\nLeft of voltages by gain {JUDGED}, V RMS (mean of absolute values):\n")
    tell(f"| | {' | '.join(MOTIONS)} |\n|---|{'---|' * len(MOTIONS)}")
    for model, each in result.left.items():
        tell(f"| {model} | {' | '.join(f'{each[name].rms:.3f} ({each[name].mean:.3f})' for name in MOTIONS)} |")


def _worded(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name.removeprefix('load_friction_')} {value:.3f}" for name, value in values.items())
