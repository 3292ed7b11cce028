"""Measured torques of the drives against what links and payload weigh: factors of either, friction, what is held.

At rest a drive holds the load and the friction of the side from which it came; moving, viscous friction too. So each
joint's torque is fitted, visit by visit, by the first moments of the links beyond, what the payload (and a force at the
tip) adds, a constant of the sensor, the side of approach and the velocity, by least squares (C. G. Atkeson, C. H. An &
J. M. Hollerbach, Int. J. Robot. Res. 5(3) (1986) 101, doi:10.1177/027836498600500306).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.arrays import columns
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.sections.numeric import Array

from .recorded_conditions import conditions_of

_TOLD = 1e-6


@dataclass(frozen=True)
class Factor:
    """How many times as much as the model says, and its standard error."""

    value: float
    error: float

    def differs(self, rules: ResidualRules) -> bool:
        """Whether that is another than one, beyond doubt and by more than anybody would leave be."""
        off = abs(self.value - 1.0)
        return off > rules.torque_off and off > rules.torque_sure * self.error


@dataclass(frozen=True)
class DriveTorque:
    """What a drive's torque says (joint from 0): how many times as much as in the model the `links` and the `payload`
    weigh on it (None: it does not tell), the Coulomb friction (N*m, N; None where no side is known), what the fit
    leaves, `scatter`, and how far the load spreads, `spread` (standard deviations, N*m or N); `along` is how the torque
    goes with the load that the model gives (-1 to 1). `instead` says that what gives is judged under the weights that
    it shows. `together` says that the payload is in `links`: it was always the same. `of` names the recording, where
    there are several.
    """

    joint: int
    links: Factor | None
    payload: Factor | None
    friction: float | None
    scatter: float
    spread: float
    along: float
    instead: bool
    together: bool
    of: str = ""

    @property
    def scaled(self) -> bool:
        """Whether links and payload weigh more in the same proportion: rather the torque's scale is off."""
        if self.links is None or self.payload is None:
            return False
        apart = abs(self.links.value - self.payload.value)
        return apart <= 2.0 * float(np.hypot(self.links.error, self.payload.error))

    def differs(self, rules: ResidualRules) -> bool:
        """Whether links or payload weigh other on it than in the model."""
        return any(factor is not None and factor.differs(rules) for factor in (self.links, self.payload))


@dataclass(frozen=True)
class DriveDesign:
    """What a drive's torque is fitted by, visit by visit: `load` (V,) that links and payload make together, a constant
    and what is not alike everywhere of payload, side and velocity (`of_drive`, each (V,)), and first moments `each` (V,
    k); `weigh` (V,) is what the model has the links weigh, with the payload where that cannot be told by itself
    (`together`)."""

    load: Array
    weigh: Array
    of_drive: Mapping[str, Array]
    each: Array
    together: bool

    @property
    def spread(self) -> float:
        """How far the load spreads, a standard deviation, N*m or N."""
        return float(np.std(self.load))

    @property
    def columns(self) -> Array:
        """What is fitted (V, 1 + own + k): the constant, the own columns, the moments."""
        return np.column_stack([np.ones(len(self.load)), *self.of_drive.values(), self.each])

    def share(self, rules: ResidualRules) -> Array | None:
        """By what of the moments' coefficients (k,) one has how many times as much as in the model the links weigh:
        how much of that is in what the moments found make of them; None where they weigh next to nothing."""
        if float(np.ptp(self.weigh)) <= rules.torque_seen * self.spread:
            return None
        about = self.weigh - self.weigh.mean()
        return (self.each - self.each.mean(axis=0)).T @ about / float(about @ about)

    def errors(self, scatter: float, rules: ResidualRules) -> dict[str, float]:
        """The standard errors where each visit scatters by so much, N*m or N: of the factors of payload and links, of
        friction (side, N*m or N) and of what goes with velocity."""
        columns = self.columns
        covariance = scatter**2 * np.linalg.pinv(columns.T @ columns, rcond=_TOLD**2, hermitian=True)
        errors = {name: float(np.sqrt(covariance[k, k])) for k, name in enumerate(self.of_drive, start=1)}
        share, first = self.share(rules), 1 + len(self.of_drive)
        if share is not None:
            errors["links"] = float(np.sqrt(max(share @ covariance[first:, first:] @ share, 0.0)))
        return errors


def drive_designs(
    arm: Arm, recording: Recording, state: PoseState, visit: NDArray[np.int64], rules: ResidualRules
) -> tuple[DriveDesign, ...]:
    """What the torque of each drive is fitted by at the visits (N,) of a recording, where `state` is the arm at its
    readings."""
    bare = loads_on_drives(arm, recording, payload=False, rules=rules)
    number = np.unique(visit, return_inverse=True)[1].reshape(-1)
    designs: list[DriveDesign] = []
    for joint in range(arm.size):
        whole = np.broadcast_to(np.asarray(state.joints[joint].drive_load, dtype=float), (recording.size,))
        links = bare[:, joint]
        designs.append(_design(joint, recording, number, -links, links - whole, _moments(arm, state, joint), rules))
    return tuple(designs)


def loads_on_drives(arm: Arm, recording: Recording, *, payload: bool, rules: ResidualRules) -> Array:
    """The load on each drive (N, n), N*m or N, with what a recording has at the tip or without."""
    at_tip: dict[str, Any] = {"payload_mass": np.zeros(recording.size), "tip_force": (0.0, 0.0, 0.0)}
    if payload:
        force = None if recording.force is None else tuple(recording.force.T)
        at_tip = {"payload_mass": recording.payload_mass, "tip_force": force}
    state = solve(
        arm,
        [recording.q[:, index] for index in range(arm.size)],
        beams_of(arm),
        conditions=conditions_of(recording, arm, rules=rules),
        **at_tip,
    )
    by_joint = [np.broadcast_to(np.asarray(joint.drive_load, dtype=float), (recording.size,)) for joint in state.joints]
    return np.stack(by_joint, axis=1)


def drive_torques(
    arm: Arm, recording: Recording, state: PoseState, visit: NDArray[np.int64], rules: ResidualRules
) -> tuple[DriveTorque, ...]:
    """What the torques of a recording say, of each drive that carries a load in the model; none without torques.

    `state` is the arm at the readings, `visit` (N,) which visit each belongs to.
    """
    if recording.torque is None:
        return ()
    number = np.unique(visit, return_inverse=True)[1].reshape(-1)
    designs = drive_designs(arm, recording, state, visit, rules)
    torques = (_of_drive(joint, recording, number, design, rules) for joint, design in enumerate(designs))
    return tuple(torque for torque in torques if torque is not None)


def _moments(arm: Arm, state: PoseState, joint: int) -> Array:
    """What unit first moments of the links beyond a joint that turns make its drive hold (N, k), whatever their masses
    and centres: steps from joint to joint are such moments too. Of a slide, what all beyond it weighs."""
    rows = np.size(state.joints[0].coordinate)
    axis, pull = columns(state.joints[joint].axis, rows), np.array(arm.gravity, dtype=float)
    if not state.joints[joint].revolute:
        return -(axis @ pull)[:, None]
    moments: list[Array] = []
    for link in state.frames.links[joint:]:
        moments += [-np.sum(axis * np.cross(columns(part, rows), pull), axis=1) for part in
                  (link.along, link.height, link.width)]  # fmt: skip
    return np.stack(moments, axis=1)


def _design(
    joint: int,
    recording: Recording,
    visit: NDArray[np.int64],
    links: Array,
    payload: Array,
    moments: Array,
    rules: ResidualRules,
) -> DriveDesign:
    """What a drive's torque is fitted by, where links and payload make it hold (N,), and unit moments (N, k)."""
    count = np.bincount(visit)

    def mean(values: Array) -> Array:
        return np.bincount(visit, weights=values) / count

    load = mean(links + payload)
    further = [None if item is None else mean(item[:, joint]) for item in (recording.sides, recording.velocity)]
    wanted = {"payload": mean(payload), "side": further[0], "velocity": further[1]}
    spread = float(np.std(load))
    least = {"payload": spread, "side": 1.0, "velocity": 0.0}
    variables = {
        name: values
        for name, values in wanted.items()
        if values is not None and float(np.ptp(values)) > rules.torque_seen * least[name]
    }
    means = np.stack([mean(column) for column in moments.T], axis=1)
    means = means[:, np.ptp(means, axis=0) > 0.0]
    if "payload" in variables:
        # One payload throughout is a part of what the links weigh.
        beside = np.column_stack([np.ones(len(load)), means])
        payload_rest = variables["payload"] - beside @ np.linalg.lstsq(beside, variables["payload"], rcond=_TOLD)[0]
        if float(np.std(payload_rest)) <= rules.torque_seen * spread:
            del variables["payload"]
    together = "payload" not in variables and bool(payload.any())
    return DriveDesign(load, load if together else mean(links), MappingProxyType(variables), means, together)


def _of_drive(
    joint: int, recording: Recording, visit: NDArray[np.int64], fitted: DriveDesign, rules: ResidualRules
) -> DriveTorque | None:
    assert recording.torque is not None
    count, columns, spread, load = np.bincount(visit), fitted.of_drive, fitted.spread, fitted.load
    torque = np.bincount(visit, weights=recording.torque[:, joint]) / count
    design = fitted.columns
    values, _, rank, _ = np.linalg.lstsq(design, torque, rcond=_TOLD)
    freedom = len(torque) - int(rank)
    if spread <= rules.torque_least * float(np.std(torque)) or freedom < rules.enough_freedom or not np.std(torque):
        return None  # what the model has it hold is next to nothing of what it holds: a joint upright, or at rest
    left = torque - design @ values
    scatter = float(np.sqrt(np.sum(left**2) / freedom))
    errors, share = fitted.errors(scatter, rules), fitted.share(rules)
    known = {name: Factor(float(values[k]), errors[name]) for k, name in enumerate(columns, start=1)}
    if share is not None:
        known["links"] = Factor(float(share @ values[1 + len(columns) :]), errors["links"])
    rub = np.zeros(len(torque))
    for name in ("side", "velocity"):
        if name in known:
            rub += known[name].value * columns[name]
    held = torque - values[0] - rub
    made = DriveTorque(
        joint,
        known.get("links"),
        known.get("payload"),
        known["side"].value if "side" in known else None,
        scatter,
        spread,
        float(np.corrcoef(held, load)[0, 1]),
        instead=False,
        together=fitted.together,
    )
    return replace(made, instead=made.differs(rules) and not made.scaled)
