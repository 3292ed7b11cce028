"""A recording in the words of ISO 9283 and ISO 230-2: accuracy, repeatability, reversal, drift, static compliance.

The standards prescribe their test cycles (ISO 9283:1998: five poses, thirty visits; ISO 230-2:2014: five visits
from each side). A recording made for another purpose seldom follows them, so each figure says how many readings it
rests on, and none is given on fewer than a least number.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from linkwright.core.arm.chain.arrays import motion_directions
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.visits import blocks_of, same_pose
from linkwright.core.diagnose.result import Covered
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.diagnose.several.recordings import nominal_tips
from linkwright.core.sections.numeric import Array

Rows = NDArray[np.int64]

LEAST_VISITS = 5
"""Readings at one pose from which a standard deviation is told: ISO 230-2:2014 asks for five visits."""
_LONGER = 3.0
"""Usual steps: a longer pause between readings of one pose begins a new visit."""
_LEAST = 3
"""Readings in each of two groups (sides, loads, times) whose means are shown."""
ISO_9283, ISO_230 = "ISO 9283:1998", "ISO 230-2:2014"


@dataclass(frozen=True)
class Pose:
    """The readings at one pose: their row indices in the order of time, the same split by what was carried (`alike`),
    and the nominal tip (D,), m."""

    rows: Rows
    alike: tuple[Rows, ...]
    nominal: Array


def iso_figures(recording: Recording, arm: Arm, *, rules: Rules = RULES) -> tuple[Covered, ...]:
    """Every figure that the recording supports, in SI (m; m/N for the static compliance).

    Pose accuracy and reversal need to know where the base frame stands: they are left out where the recording leaves
    frame or tool free. Figures of several poses are the worst of them, `count` the readings that the worst rests on.
    """
    poses = poses_of(recording, arm, rules=rules)
    results: list[Covered] = []
    known = recording.frame == "known" and recording.tool == "known"
    if known:
        results += _worst(accuracies(recording, poses), "AP", "pose accuracy, worst pose", ISO_9283)
    results += _worst(repeatabilities(recording, poses), "RP", "pose repeatability, worst pose", ISO_9283)
    name = "multi-directional pose accuracy variation, worst pose"
    results += _worst(side_variations(recording, poses), "vAP", name, ISO_9283)
    if known:
        name = "drift of pose accuracy, worst pose"
        results += _worst(accuracy_drifts(recording, poses), "dAP", name, ISO_9283)
    name = "static compliance, worst pose"
    results += _worst(static_compliances(recording, arm, poses), "C", name, ISO_9283)
    for joint in range(arm.size if known else 0):
        reversals = joint_reversals(recording, arm, poses, joint)
        if reversals:
            values = np.array([value for value, _ in reversals])
            count = min(count for _, count in reversals)
            where = f"joint {joint + 1}, at the tip"
            largest = float(np.abs(values).max())
            results.append(Covered(f"B_{joint + 1}", f"reversal value of {where}, worst pose", ISO_230, largest, count))
            if len(values) > 1:
                mean = float(values.mean())
                results.append(Covered(f"B̄_{joint + 1}", f"mean reversal value of {where}", ISO_230, mean, count))
    return tuple(results)


def _worst(each: Sequence[tuple[float, int]], symbol: str, name: str, standard: str) -> list[Covered]:
    if not each:
        return []
    value, count = max(each)
    return [Covered(symbol, name, standard, value, count)]


def poses_of(recording: Recording, arm: Arm, *, rules: Rules = RULES) -> tuple[Pose, ...]:
    """The poses with enough readings to say anything, whatever was carried and from whichever side.

    Poses are distinguished by their commands where those are recorded, else by the encoders' readings.
    """
    asked = recording.q if recording.commanded is None else recording.commanded
    labels = clusters(asked / same_pose(arm, rules.residual))
    nominal = nominal_tips(arm, replace(recording, q=asked))[:, : recording.tip.shape[1]]
    time = np.arange(recording.size, dtype=float) if recording.time is None else recording.time
    loads = _loads(recording, rules.residual.same_payload)
    poses: list[Pose] = []
    for rows in blocks_of(labels):
        if len(rows) >= _LEAST:
            ordered = rows[np.argsort(time[rows], kind="stable")]
            alike = np.unique(loads[ordered], axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)
            poses.append(Pose(ordered, tuple(ordered[part] for part in blocks_of(alike)), nominal[rows].mean(axis=0)))
    return tuple(poses)


def clusters(points: Array) -> Rows:
    """Numbers (N,) that are equal for points (N, n) within 1 of each other, directly or through others."""
    unique, where = np.unique(np.round(points, 6), axis=0, return_inverse=True)
    pairs = KDTree(unique).query_pairs(1.0, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(unique), len(unique)))
    return connected_components(links, directed=False)[1][where.reshape(-1)].astype(np.int64)


def _loads(recording: Recording, same: float) -> Array:
    """What is carried at each reading, in steps that count as the same: (N, k)."""
    parts = [np.zeros((recording.size, 1))]
    if recording.payload_mass is not None:
        parts.append(np.round(recording.payload_mass[:, None] / same))
    if recording.force is not None:
        parts.append(np.round(recording.force / same))
    return np.concatenate(parts, axis=1)


def accuracies(recording: Recording, poses: Sequence[Pose]) -> list[tuple[float, int]]:
    """AP_p of each pose and load (m): from the commanded tip to the mean of those reached (ISO 9283:1998)."""
    return [
        (float(np.linalg.norm(recording.tip[rows].mean(axis=0) - pose.nominal)), len(rows))
        for pose in poses
        for rows in pose.alike
        if len(rows) >= LEAST_VISITS
    ]


def repeatability(tips: Array) -> float:
    """RP_l = mean + 3 S of the distances of tips (N, D) from their mean, m (ISO 9283:1998)."""
    distance = np.linalg.norm(tips - tips.mean(axis=0), axis=1)
    return float(distance.mean() + 3.0 * distance.std(ddof=1))


def repeatabilities(recording: Recording, poses: Sequence[Pose]) -> list[tuple[float, int]]:
    """RP_l of each pose, load and side (m): the standard's cycle comes to a pose along one path."""
    return [
        (repeatability(recording.tip[rows]), len(rows))
        for pose in poses
        for alike in pose.alike
        for rows in _sides(recording, alike)
        if len(rows) >= LEAST_VISITS
    ]


def _sides(recording: Recording, rows: Rows) -> list[Rows]:
    """Rows split by the sides from which the joints came; all together where nobody knows them."""
    if recording.sides is None:
        return [rows]
    labels = np.unique(recording.sides[rows], axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)
    return [rows[part] for part in blocks_of(labels)]


def _known_sides(recording: Recording, rows: Rows) -> dict[tuple[float, ...], Rows]:
    """Rows by the sides of all joints, where all are known."""
    if recording.sides is None:
        return {}
    groups = {tuple(recording.sides[part[0]].tolist()): part for part in _sides(recording, rows)}
    return {sides: part for sides, part in groups.items() if 0.0 not in sides}


def side_variations(recording: Recording, poses: Sequence[Pose]) -> list[tuple[float, int]]:
    """vAP of each pose and load (m): the largest distance between the means of different sides (ISO 9283:1998).

    The standard comes along the three axes of the base; here sides are those of the joints.
    """
    results: list[tuple[float, int]] = []
    for pose in poses:
        for alike in pose.alike:
            groups = [rows for rows in _known_sides(recording, alike).values() if len(rows) >= _LEAST]
            if len(groups) > 1:
                means = np.stack([recording.tip[rows].mean(axis=0) for rows in groups])
                apart = np.linalg.norm(means[:, None] - means[None], axis=2)
                results.append((float(apart.max()), min(len(rows) for rows in groups)))
    return results


def joint_reversals(recording: Recording, arm: Arm, poses: Sequence[Pose], joint: int) -> list[tuple[float, int]]:
    """The reversal of `joint` (from 0) at each pose and load: mean position coming from below (towards increasing
    coordinates) less that coming from above, along the joint's motion of the tip, m (ISO 230-2:2014).

    Only sides that differ in this joint alone are compared. A joint that lags behind in both directions, as by friction
    or backlash, gives a negative value.
    """
    results: list[tuple[float, int]] = []
    if recording.sides is None:
        return results
    for pose in poses:
        direction = motion_directions(arm, recording.q[pose.rows[:1]])[0, joint, : recording.tip.shape[1]]
        for alike in pose.alike:
            groups = _known_sides(recording, alike)
            for sides, rows in groups.items():
                other = groups.get((*sides[:joint], -1.0, *sides[joint + 1 :]))
                if sides[joint] != 1.0 or other is None or min(len(rows), len(other)) < _LEAST:
                    continue
                gap = recording.tip[rows].mean(axis=0) - recording.tip[other].mean(axis=0)
                results.append((float(gap @ direction), min(len(rows), len(other))))
    return results


def accuracy_drifts(recording: Recording, poses: Sequence[Pose]) -> list[tuple[float, int]]:
    """dAP of each pose and load (m): how far AP_p of any later visit is from that of the first (ISO 9283:1998).

    A visit is a run of readings without another pose, or a long pause, between them.
    """
    results: list[tuple[float, int]] = []
    for pose in poses:
        for rows in pose.alike:
            runs = [run for run in _runs(recording, rows, _LONGER) if len(run) >= _LEAST]
            if len(runs) > 1:
                accuracy = [float(np.linalg.norm(recording.tip[run].mean(axis=0) - pose.nominal)) for run in runs]
                drift = max(abs(value - accuracy[0]) for value in accuracy[1:])
                results.append((drift, min(len(run) for run in runs)))
    return results


def _runs(recording: Recording, rows: Rows, longer: float) -> list[Rows]:
    """Rows of one pose and load, split where another pose, another load or a long pause lies between."""
    time = recording.time
    order = np.argsort(np.arange(recording.size) if time is None else time, kind="stable")
    rank = np.empty(recording.size, dtype=np.int64)
    rank[order] = np.arange(recording.size)
    apart = np.diff(rank[rows]) > 1
    if time is not None and recording.size > 1:
        apart |= np.diff(time[rows]) > longer * float(np.median(np.diff(time[order]))) + 1e-9
    return np.split(rows, np.flatnonzero(apart) + 1)


def static_compliances(recording: Recording, arm: Arm, poses: Sequence[Pose]) -> list[tuple[float, int]]:
    """How far the tip gives at each pose, per newton of difference between two loads, m/N (ISO 9283:1998).

    Of all pairs of loads at a pose the one that differs most counts.
    """
    results: list[tuple[float, int]] = []
    if recording.payload_mass is None and recording.force is None:
        return results
    pull = np.zeros((recording.size, 3))
    if recording.payload_mass is not None:
        pull += recording.payload_mass[:, None] * np.array(arm.gravity)
    if recording.force is not None:
        pull += recording.force
    for pose in poses:
        groups = [rows for rows in pose.alike if len(rows) >= _LEAST]
        pairs = [(one, other) for index, one in enumerate(groups) for other in groups[:index]]
        steps = [float(np.linalg.norm(pull[one].mean(axis=0) - pull[other].mean(axis=0))) for one, other in pairs]
        if steps and max(steps) > 1.0:
            one, other = pairs[int(np.argmax(steps))]
            moved = np.linalg.norm(recording.tip[one].mean(axis=0) - recording.tip[other].mean(axis=0))
            results.append((float(moved) / max(steps), min(len(one), len(other))))
    return results
