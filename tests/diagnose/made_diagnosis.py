"""Recordings and diagnoses made by hand, as the tests of what people meet need them; nothing here runs the engine."""

import math
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pandas as pd

from linkwright.core.arm.chain.chain import Arm, EffectEntry, Joint, Link, LoadCase
from linkwright.core.arm.chain.kinematics import tip_position
from linkwright.core.arm.chain.statics import solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.recorded import Asked, seen_of_model
from linkwright.core.arm.errors.tip import active_effects
from linkwright.core.arm.files.read import read_arm
from linkwright.core.diagnose.recording import Recording, RejectedRow
from linkwright.core.diagnose.result import (
    Alternative,
    Covered,
    Dependence,
    Detectable,
    Diagnosis,
    Finding,
    FittedParameter,
    Form,
    Location,
    NextPose,
    RejectedForm,
    Rung,
    Unknown,
)
from linkwright.core.materials.catalogue import load_catalogue
from linkwright.core.sections import Tube


def made_arm(space=False):
    """Three links; in space the first joint turns about the vertical axis."""
    material = load_catalogue(user=False).find("aluminium-6061-t6")
    joint = Joint(range=(-math.pi / 2, math.pi / 2), stiffness=60e3)
    joints = [joint, joint, replace(joint, range=(-1.0, 2.0))]
    gravity = (0.0, -9.81, 0.0)
    if space:
        joints = [joint, replace(joint, axis=(0.0, 1.0, 0.0)), replace(joint, axis=(0.0, 1.0, 0.0))]
        gravity = (0.0, 0.0, -9.81)
    links = tuple(Link(length, section=Tube(0.08, 0.004), material=material) for length in (0.4, 0.42, 0.3))
    return Arm("bench <arm> & co", tuple(joints), links, gravity=gravity, payload=LoadCase(2.0))


def made_recording(arm=None, poses=24, repeats=3, seed=3, **changed):
    """Every pose under two payloads, from both sides, with some repeats, while it warms up; no errors in it."""
    arm = made_arm() if arm is None else arm
    rng = np.random.default_rng(seed)
    low, high = (np.array([joint.range[end] for joint in arm.joints]) for end in (0, 1))
    visited = rng.uniform(0.8 * low, 0.8 * high, (poses, arm.size))
    q = np.repeat(visited, repeats, axis=0)
    count = len(q)
    side = np.repeat(rng.choice([-1.0, 1.0], (poses, arm.size)), repeats, axis=0)
    width = 2 if arm.planar() else 3
    made = Recording(
        file="recording.csv",
        q=q,
        tip=tip_position(arm, q)[:, :width],
        row=np.arange(1, count + 1),
        time=20.0 * np.arange(count),
        sides=side,
        payload_mass=np.repeat(rng.choice([0.0, 5.0], poses), repeats),
        temperature=293.15 + np.linspace(0.0, 6.0, count),
        sigma=15e-6,
        warnings=("dir2 is blank in rows 3 to 5: the side is unknown there.",),
    )
    return replace(made, **changed)


def made_diagnosis(verdict="named", arm=None, seed=5, **changed):
    """A diagnosis of each verdict: a drive's compliance at joint 2, or a step that nothing explains."""
    arm = made_arm() if arm is None else arm
    recording = made_recording(arm)
    rng = np.random.default_rng(seed)
    width = recording.tip.shape[1]
    noise = rng.normal(0.0, 15e-6, (recording.size, width))
    tip = recording.tip
    about = tip - tip_position(arm, recording.q * np.array([1.0, 0.0, 0.0]))[:, :width] * 0.4
    across = np.zeros_like(tip)
    across[:, 0], across[:, 1] = -about[:, 1], about[:, 0]
    missing = 3e-4 * across * (1.0 + recording.payload_mass[:, None] / 5.0)
    if verdict in ("none", "insufficient_data"):
        missing = np.zeros_like(missing)
    if verdict == "unknown":
        missing = np.where(recording.time[:, None] > 700.0, 2e-4, 0.0) * np.ones(width)
    before, after = missing + noise, noise + (missing if verdict == "unknown" else 0.0)
    rms = [float(np.sqrt(np.mean(np.sum(item * item, axis=1)))) for item in (before, after)]
    result = Diagnosis(
        arm=arm,
        recording=recording,
        verdict=verdict,
        sentence=_SENTENCES[verdict],
        noise_floor=15e-6 * math.sqrt(width),
        noise_source="The noise floor is 0.0212 mm RMS, from 24 poses read more than once.",
        rms_before=rms[0],
        rms_after=rms[1],
        rms_after_held_out=1.02 * rms[1],
        gate_p=0.4 if verdict in ("none", "insufficient_data") else 2e-4,
        findings=(_finding(verdict, rms),) if verdict in ("named", "alias_class") else (),
        where=_location(verdict, arm),
        unknown=_unknown(missing) if verdict == "unknown" else None,
        ladder=_ladder(verdict, before, after),
        rejected_rows=(RejectedRow(17, "12 times the noise away from its repeats"), RejectedRow(40, "x_mm is blank")),
        rejected_forms=(
            RejectedForm("link_bending", (2,), 0.93, "the criterion is 41 worse <than> that of the named effect"),
            RejectedForm("thermal_expansion", (), 0.02, "what it explains is no more than chance gives"),
        ),
        detectable=(
            Detectable("backlash", (1,), 2e-5, "total", "angle", 4e-5, 0.8),
            Detectable("backlash", (2,), 3e-5, "total", "angle", 9e-5, 0.5),
            Detectable("encoder_offset", (1,), math.nan, "offset", "angle", math.nan, 0.0),
            Detectable("joint_compliance", (2,), 8e-6, "compliance", "compliance", 4.4e-7, 0.9),
        ),
        invisible=(("encoder_offset", (1,)), ("clearance", (1,))),
        next_poses=(
            NextPose((0.5, -0.25, math.pi / 2), 5.0, 1, "joint_compliance at joint 2 from base_compliance"),
            NextPose((-0.5, 0.0, 0.1), None, -1, "joint_compliance at joint 2 from base_compliance"),
        ),
        next_poses_note="A target on the base would decide at once.",
        null_vectors=("A turn of the frame is the same as an offset of encoder 1.",),
        splits=MappingProxyType({"random rows": 1.01 * rms[1], "blocks of poses": 1.02 * rms[1]}),
        figures=(
            Covered("RP", "pose repeatability, worst pose", "ISO 9283:1998", 4.2e-5, 9),
            Covered("C", "static compliance, worst pose", "ISO 9283:1998", 2.5e-6, 6),
        ),
        residual_before=before,
        residual_after=after,
        corrected=_corrected(arm) if verdict in ("named", "alias_class") else arm,
        notes=("No payload was recorded in rows 1 to 3.",),
        seconds=1.25,
    )
    return replace(result, **changed)


_SENTENCES = MappingProxyType(
    {
        "none": "Nothing is missing that this recording could show.",
        "insufficient_data": "The recording cannot say: 3 poses are too few.",
        "named": "Found: compliance of drive 2, 21 urad/(N*m). What remains is the noise floor.",
        "alias_class": "Found: compliance of drive 1 or of the base; the data cannot tell which.",
        "unknown": "Something changed at 700 s that nothing in the library explains.",
    }
)


def _finding(verdict, rms):
    alternatives = (Alternative("link_bending", (2,), 0.9991, 0.4),) if verdict == "alias_class" else ()
    return Finding(
        effect="joint_compliance",
        at=(2,),
        alternatives=alternatives,
        parameters=(FittedParameter("compliance_2", "compliance", (2,), "compliance", 2.1e-5, (2.0e-5, 2.2e-5)),),
        rms_explained=math.sqrt(rms[0] ** 2 - rms[1] ** 2),
        p_value=0.0005,
        rms_without=rms[0],
        rms_without_held_out=1.01 * rms[0],
        reading="The drive of joint 2 gives 21 urad under one newton metre.",
    )


def _location(verdict, arm):
    if verdict in ("none", "insufficient_data"):
        return Location(None, (0.0,) * arm.size, (), None, None, (Dependence("q2", 0.7, 0.02),))
    if verdict == "unknown":
        shares = (0.3, 0.2, 0.1)
        return Location(None, shares, ("time",), "radial", 700.0, (Dependence("time", 5e-4, 0.95),))
    dependences = (Dependence("payload_kg", 5e-4, 0.6), Dependence("q2", 1e-3, 0.4), Dependence("time", 0.8, 0.01))
    return Location(2, (0.55, 0.98, 0.31), ("payload_kg", "q2"), "tangential", None, dependences)


def _unknown(missing):
    return Unknown(
        depends_on=("time",),
        amplitude=float(np.sqrt(np.mean(np.sum(missing * missing, axis=1)))),
        shape="a step of 0.28 mm at 700 s",
        forms=(
            Form("step in time", 0.98, 0.97, "A shift of the tip at 700 s."),
            Form("force field", 0.2, 0.1, "A force at the tip."),
        ),
        rejected=(RejectedForm("frame_drift", (), 0.7, "it grows evenly, the mismatch does not"),),
        since=700.0,
        decide="Record one pose again and again while the clamps are tightened.",
        predicted=0.95 * missing,
        held_out_share=0.93,
    )


def _ladder(verdict, before, after):
    def rung(label, vectors, held_out=1.02):
        length = np.linalg.norm(vectors, axis=1)
        rms = float(np.sqrt(np.mean(length**2)))
        return Rung(label, rms, float(length.mean()), float(length.max()), held_out * rms)

    first = rung("the arm file", before)
    if verdict not in ("named", "alias_class"):
        return (first,)
    return (first, rung("+ joint_compliance at 2", after), rung("without joint_compliance at 2", before, 1.01))


def _corrected(arm):
    entry = EffectEntry("joint_compliance", (2,), MappingProxyType({"compliance": 2.1e-5}))
    return replace(arm, effects=(*arm.effects, entry))


RECORDED = 3e-5
"""rad/(N*m) of drive 2 that the arm file does not have."""


def softer(arm, compliance, joint=2):
    """The arm with a drive that gives more."""
    if not compliance:
        return arm
    entry = EffectEntry("joint_compliance", (joint,), MappingProxyType({"compliance": compliance}))
    return replace(arm, effects=(entry,))


def measured(arm, q, payload, rng, noise):
    """Tips (N, 2 or 3) m that an instrument would read: the arm's whole model, with noise."""
    state = solve(arm, list(q.T), beams_of(arm), payload_mass=payload)
    moved = seen_of_model(state, active_effects(arm), Asked(len(q))).tip
    tip = (tip_position(arm, q) + moved)[:, : 2 if arm.planar() else 3]
    return tip + rng.normal(0.0, noise, tip.shape)


def write_recording(folder, compliance=RECORDED, name="recording.csv", seed=8):
    """48 poses of the arm in a folder's arm.yaml (two joints) under two payloads, each read twice."""
    rng = np.random.default_rng(seed)
    q = np.repeat(np.random.default_rng(8).uniform(-1.3, 1.3, (48, 2)), 2, axis=0)
    payload = np.repeat(np.tile([0.0, 6.0], 24), 2)
    tip = 1e3 * measured(softer(read_arm(folder / "arm.yaml"), compliance), q, payload, rng, 1e-5)
    columns = {"q1_deg": np.degrees(q[:, 0]), "q2_deg": np.degrees(q[:, 1]), "payload_kg": payload}
    columns |= {"x_mm": tip[:, 0], "y_mm": tip[:, 1]}
    pd.DataFrame(columns).to_csv(folder / name, index=False)
