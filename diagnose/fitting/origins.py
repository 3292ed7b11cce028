"""Where fixed transforms stand that the arm file leaves free: found by least squares before anything is diagnosed.

They may be metres long and turned by any angle, so they are found exactly first. Of one transform before which the
measuring frame is known the readings tell the place of points fixed to what lies beyond (W. Kabsch); all else begins
from turns spread over all that there are and goes on by Gauss-Newton through the exact chain, with readings that lie
far off weighed down. What is left of each is linear and stays among the nuisances of every fit.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.arrays import columns, matrices
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.kinematics import place
from linkwright.core.diagnose.instruments.placement import rigid
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.residual.free_origins import moved, of_observed, origin_columns, turned_whole, with_origin
from linkwright.core.diagnose.residual.observe import observe
from linkwright.core.diagnose.residual.observed import Observed, rms_length
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.sections.numeric import Array

from .prepare import nuisances

_TUKEY = 4.685
"""Tukey's biweight: 95 % efficient for Gaussian noise (P. J. Huber, Robust Statistics, Wiley 1981, ch. 7)."""
_HALVINGS = 4
_READINGS = 60
"""Readings, spread over the recording, from which a transform is first found: ten times as many as it has numbers."""
_MOST_STARTS = 64
"""Turns from which transforms are sought; 24, a quarter turn apart, for one."""
_STEPS = 25
"""Of Gauss-Newton from each start; a good one takes five."""
_LONGEST_TURN = 0.6
"""Of one step, rad: beyond, first order says nothing."""
_TOLD = 1e-6
"""A direction that shows a smaller share beside the best is left where it stands."""
_SETTLED = 1e-9
"""A step that moves it by so little (m) is the last."""
_FOUND = 0.003
"""Of the arm's length: with a middle reading no further off no other start is tried; a wrong turn is far off."""


def located(arm: Arm, recording: Recording, *, rules: Rules = RULES) -> Arm:
    """The arm with the fixed transforms that its file leaves free where the readings put them, free as they were; as it
    is where none are. Raises what `observe` raises."""
    if not arm.unknown_origins:
        return arm
    bare = replace(recording, orientation=None, joint_side=None, base_target=None)
    some = _spread_over(bare, _READINGS)
    rigidly = replace(
        arm,
        effects=(),
        joints=tuple(replace(joint, stiffness=None, zones=(), backlash=0.0, clearance=0.0) for joint in arm.joints),
        links=tuple(replace(link, section=None, material=None, mass=0.0) for link in arm.links),
    )
    best: _Trial | None = None
    for start in _starts(rigidly, some):
        trial = _improved(_tried(start, some, rules), some, rules)
        if best is None or trial.middle < best.middle:
            best = trial
        if best.middle <= _FOUND * _reach(best.observed):
            break
    assert best is not None
    placed = tuple(
        replace(joint, origin_rotation=fitted.origin_rotation, origin_translation=fitted.origin_translation)
        for joint, fitted in zip(arm.joints, best.arm.joints, strict=True)
    )
    return _improved(_tried(replace(arm, joints=placed), bare, rules), bare, rules).arm


@dataclass(frozen=True)
class _Trial:
    """An arm set against the readings, and how far the middle one is off, m."""

    arm: Arm
    observed: Observed
    middle: float

    @property
    def residual(self) -> Array:
        """What the tip is off by (N, W), m."""
        return self.observed.tip_residual()


def _tried(arm: Arm, recording: Recording, rules: Rules) -> _Trial:
    observed = observe(arm, recording, rules=rules)
    return _Trial(arm, observed, float(np.median(np.linalg.norm(observed.tip_residual(), axis=1))))


def _improved(trial: _Trial, recording: Recording, rules: Rules) -> _Trial:
    """Gauss-Newton, frame and tool fitted beside; a step that makes things worse is halved."""
    for _ in range(_STEPS):
        observed, width = trial.observed, trial.observed.components
        ways = of_observed(observed)
        size = np.array([1.0 / _reach(observed) if way.turns else 1.0 for way in ways])
        root = np.sqrt(_weights(trial.residual))[:, None, None]
        beside, _ = nuisances(observed, origins=False)
        design = np.concatenate([origin_columns(observed, ways) * size, beside], axis=2)[:, :width] * root
        design = design.reshape(-1, design.shape[2])
        scale = np.linalg.norm(design, axis=0)
        scale = np.where(scale > 1e-12 * max(float(scale.max(initial=0.0)), 1e-300), scale, np.inf)
        target = (trial.residual * root[:, :, 0]).reshape(-1)
        step = np.linalg.lstsq(design / scale, target, rcond=_TOLD)[0][: len(ways)] / scale[: len(ways)]
        step *= size
        largest = max((abs(value) for value, way in zip(step, ways, strict=True) if way.turns), default=0.0)
        step *= min(1.0, _LONGEST_TURN / max(largest, 1e-300))
        before = float(np.sum(target**2))
        for _ in range(_HALVINGS):
            other = _tried(moved(trial.arm, ways, step), recording, rules)
            if float(np.sum((other.residual * root[:, :, 0]) ** 2)) <= before:
                break
            step = 0.5 * step
        else:
            return trial
        trial = other
        if float(np.abs(step / size).max(initial=0.0)) < _SETTLED:
            break
    return trial


def _weights(residual: Array) -> Array:
    distance = np.linalg.norm(residual, axis=1)
    scale = max(1.4826 * float(np.median(distance)), 1e-9)
    return np.clip(1.0 - (distance / (_TUKEY * scale)) ** 2, 0.0, None) ** 2


def _reach(observed: Observed) -> float:
    """The size of the arm beside its transforms, m: by what a turn counts."""
    arm = observed.arm
    return max(sum(arm.lengths), rms_length(np.atleast_2d(np.array(arm.tool))), 1e-3)


def _spread_over(recording: Recording, count: int) -> Recording:
    """So many readings, spread over the recording."""
    if recording.size <= count:
        return recording
    keep = np.zeros(recording.size, dtype=bool)
    keep[np.linspace(0, recording.size - 1, count).round().astype(int)] = True
    return recording.kept(keep)


def _starts(arm: Arm, recording: Recording) -> Iterator[Arm]:
    """Arms to begin from, the likeliest first."""
    first = _by_points(arm, recording)
    if first is not None:
        yield first
    flat = recording.tip.shape[1] == 2 and arm.planar()
    turned = [index for index in arm.unknown_origins if turned_whole(arm.joints[index])]
    angles = Rotation.from_rotvec(np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)[:, None] * np.array([0.0, 0.0, 1.0]))
    turns: Sequence[Rotation] = list(angles if flat else Rotation.create_group("O"))
    chosen = itertools.product(turns, repeat=len(turned))
    every = list(itertools.islice(chosen, _MOST_STARTS)) if len(turned) < 2 else list(chosen)
    if len(every) > _MOST_STARTS:
        picked = np.random.default_rng(0).choice(len(every), _MOST_STARTS, replace=False)
        every = [every[k] for k in [0, *picked.tolist()]]
    for item in every:
        joints = list(arm.joints)
        for index, turn in zip(turned, item, strict=True):
            joints[index] = with_origin(joints[index], turn.as_matrix(), np.array(joints[index].origin_translation))
        yield replace(arm, joints=tuple(joints))


def _by_points(arm: Arm, recording: Recording) -> Arm | None:
    """The arm whose one transform, free as a whole, takes the points fixed beyond it to where they were measured; None
    where the readings do not say that."""
    if len(arm.unknown_origins) != 1 or recording.slots is not None or recording.frame == "free":
        return None
    (index,) = arm.unknown_origins
    joint, width = arm.joints[index], recording.tip.shape[1]
    if len(joint.origin_free) < 6 or (width == 2 and not arm.planar()):
        return None
    bare = replace(
        arm,
        joints=tuple(
            with_origin(item, np.eye(3), np.zeros(3)) if k == index else item for k, item in enumerate(arm.joints)
        ),
    )
    rows = recording.size
    frames = place(bare, [recording.q[:, k] for k in range(arm.size)])
    at = np.zeros((rows, 3))
    for k in range(index):
        at = at + columns(frames.joints[k].lead, rows) + columns(frames.links[k].vector, rows)
    axes = matrices(frames.joints[index].frame, rows, width)
    beyond = np.einsum("nji,nj->ni", axes, (columns(frames.tip(), rows) - at)[:, :width])
    seen = np.einsum("nji,nj->ni", axes, recording.tip - at[:, :width])
    rotation, shift = rigid(beyond, seen)
    whole, along = np.eye(3), np.zeros(3)
    whole[:width, :width], along[:width] = rotation, shift
    return replace(
        arm, joints=tuple(with_origin(item, whole, along) if k == index else item for k, item in enumerate(arm.joints))
    )
