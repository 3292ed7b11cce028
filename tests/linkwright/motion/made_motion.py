"""Motion logs and diagnoses of them made by hand, for what people meet; nothing here runs the engine."""

from dataclasses import replace

import numpy as np

from linkwright.core.arm.chain.chain import EffectEntry
from linkwright.core.diagnose.motion.log import MotionLog
from linkwright.core.diagnose.motion.result import (
    Alternative,
    Deviation,
    MotionDiagnosis,
    MotionFinding,
    MotionUnknown,
    OfJoint,
    OfLog,
    Rollout,
    RolloutOfJoint,
    RolloutTraces,
    Traces,
)
from linkwright.core.diagnose.recording import RejectedRow
from linkwright.core.diagnose.result import FittedParameter
from tests.diagnose.made_diagnosis import made_arm

COULOMB, VISCOUS = (9.0, 13.0, 4.0), (6.0, 8.0, 2.0)


def made_log(arm=None, count=1500, seed=1, file="log.csv", **changed):
    """Fifteen seconds at 100 Hz: every joint swings with its own frequency; torques of friction alone, and noise."""
    arm = made_arm() if arm is None else arm
    time = np.arange(count) / 100.0
    rates = np.array([0.7, 1.1, 1.7])[: arm.size]
    q = 0.8 * np.sin(np.outer(time, rates))
    velocity = 0.8 * rates * np.cos(np.outer(time, rates))
    noise = 0.2 * np.random.default_rng(seed).standard_normal(q.shape)
    torque = np.array(COULOMB) * np.tanh(velocity / 0.01) + np.array(VISCOUS) * velocity + noise
    made = MotionLog(
        file=file,
        time=time,
        q=q,
        torque=torque,
        row=np.arange(1, count + 1),
        velocity=velocity,
        rejected=(RejectedRow(7, "torque 2 is 1e282 N*m"),),
        warnings=("1 stamp stands twice.",),
    )
    return replace(made, **changed)


def fitted(name, joint, kind, value, half):
    """A parameter with its interval."""
    return FittedParameter(f"{name}_{joint}", name, (joint,), kind, value, (value - half, value + half))


def made_finding(joint, effect, name, kind, value, explained, **changed):
    """A finding at a joint."""
    rms = tuple(explained if k + 1 == joint else 0.0 for k in range(3))
    made = MotionFinding(
        effect=effect,
        at=(joint,),
        parameters=(fitted(name, joint, kind, value, 0.05 * value),),
        alternatives=(),
        rms_explained=rms,
        rms_without_held_out=tuple(value + 0.3 for value in rms),
        evidence=420.0,
        p_value=0.001,
        reading=f"{effect.replace('_', ' ')} at joint {joint}.",
        draws=199,
    )
    return replace(made, **changed)


def made_motion(verdict="named", arm=None, **changed):
    """A diagnosis of each verdict: friction at all joints, or what nothing explains at joint 3."""
    arm = made_arm() if arm is None else arm
    log = made_log(arm)
    if verdict == "none":
        log = replace(log, torque=0.2 * np.random.default_rng(2).standard_normal(log.q.shape))
    after = np.array(COULOMB) * np.tanh(log.velocity / 0.01) + np.array(VISCOUS) * log.velocity
    named = verdict in ("named", "alias_class", "unknown")
    before = np.zeros_like(after)
    rms = [float(np.sqrt(np.mean(column**2))) for column in log.torque.T]
    left = [0.2 if named else value for value in rms]
    sizes = (
        ("friction_coulomb", "torque", "torque", COULOMB, 0.8),
        ("friction_viscous", "coefficient", "viscous_friction", VISCOUS, 0.4),
    )
    findings = tuple(
        made_finding(joint, effect, name, kind, values[joint - 1], share * rms[joint - 1])
        for joint in (1, 2, 3)
        for effect, name, kind, values, share in sizes
    )
    if verdict == "alias_class":
        others = (
            Alternative((("torque_offset", (1,)), ("friction_asymmetry", (1,))), 0.0),
            Alternative((("friction_load", (1,)),), 2.5),
        )
        findings = (replace(findings[0], alternatives=others), *findings[1:])
    unknown = None
    if verdict == "unknown":
        unknown = MotionUnknown(
            (3,), ("q3", "speed"), 0.9, "a bump near 20 degrees", "turn joint 3 slowly both ways", 3
        )
    joints = [OfJoint(k + 1, rms[k], left[k], left[k], 0.2, left[k] / rms[k], (), 0.4) for k in range(3)]
    if unknown is not None:
        joints[2] = replace(joints[2], depends_on=unknown.depends_on, p_unknown=0.002)
    total = [float(np.sqrt(np.mean(np.square(item)))) for item in (rms, left)]
    effects = tuple(
        EffectEntry(finding.effect, finding.at, {finding.parameters[0].parameter: 1.0}) for finding in findings
    )
    made = MotionDiagnosis(
        arm=arm,
        logs=(log,),
        verdict=verdict,
        sentence="Friction is what the model lacks." if named else "Nothing is missing.",
        per_joint=tuple(joints),
        findings=findings if named else (),
        unknown=unknown,
        rms_before=total[0],
        rms_after=total[1],
        rms_held_out=total[1],
        noise_floor=0.2,
        gate_p=0.001 if named else 0.6,
        split="every third stretch of 5 s",
        cutoff=8.0,
        rates=(100.0,),
        traces=(
            Traces(
                *("log.csv", log.time, log.q, log.velocity, log.torque, before, after),
                friction=after,
                moves=np.abs(log.velocity) > 0.03,
            ),
        ),
        of_logs=(OfLog("log.csv", "log.csv", "", "", log.size, total[0], total[1], total[1], (7,)),),
        corrected=replace(arm, effects=effects) if named else arm,
        notes=("Intervals are by blocks of 5 s.",),
        seconds=2.5,
    )
    return replace(made, **changed)


def made_rollout(log, windows=12, samples=51):
    """Windows of half a second: before, joints run away and the second leaves its range; after, they are close."""
    rows = np.arange(windows)[:, None] * (samples - 1) + np.arange(samples)
    measured, time = log.q[rows], log.time[rows]
    since = (time - time[:, :1])[:, :, None]
    before, after = measured + 3.0 * since**2, measured + 0.01 * since
    before[3, 20:] = np.nan

    def apart(values):
        return np.concatenate((values, np.full((windows, 1, *values.shape[2:]), np.nan)), axis=1).reshape(
            windows * (samples + 1), *values.shape[2:]
        )

    joints = tuple(
        RolloutOfJoint(
            joint, *(Deviation(0.1 * size, 0.2 * size, 0.4 * size, 0.5 * size) for size in (1.0 * joint, 0.01, 0.02))
        )
        for joint in range(1, log.q.shape[1] + 1)
    )
    traces = RolloutTraces("log.csv", *(apart(values) for values in (time, measured, before, after)))
    return Rollout(0.5, windows, (1, 0, 0), joints, (traces,), ("friction_load",))
