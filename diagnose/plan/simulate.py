"""A recording that a model would give: for trying things out, for illustration and for tests.

The physics is the library's own, so a diagnosis that finds it again proves consistency and nothing more.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from linkwright.core.arm.avoid.poses import NoRoom, drawn, room_of
from linkwright.core.arm.chain.arrays import columns, matrices
from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.chain.following import completed
from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.errors.recorded import Asked, Channels, seen, seen_of_model
from linkwright.core.arm.errors.tip import active_effects
from linkwright.core.diagnose.instruments.instrument import Instrument
from linkwright.core.diagnose.instruments.kind import InstrumentKind, Stood
from linkwright.core.diagnose.instruments.level import stand_of
from linkwright.core.diagnose.instruments.registry import kinds_of, slots_of
from linkwright.core.diagnose.instruments.touching import touched
from linkwright.core.diagnose.recording import Recording, since_the_reading_before
from linkwright.core.diagnose.residual.observe import undeformed
from linkwright.core.diagnose.rules.rules import RULES
from linkwright.core.sections.numeric import Array
from linkwright.core.units.temperature import ZERO_CELSIUS

Sides = Literal["both", "one", "random"]

_BETWEEN_READINGS, _BETWEEN_VISITS = 2.0, 20.0
"""s; how long a reading and a move take where no hours are given."""
_OUTLIERS = (10.0, 50.0)
"""Standard deviations by which an outlier is off, from and to."""
_BASE_TARGET = (0.1, 0.0, 0.0)
_DEEP, _TARGET = 5.0, 0.1
"""How many times worse a camera reads depth than what lies across, and how far apart (m) the marks of a target are by
which it reads turns; where nobody says."""
_AWAY, _ON_TOOL = (1.5, 2.0), 0.08
"""How far a camera that stands still is from the middle of the places reached, times how far these reach; and how far
off the tip (m) sits what is on the tool."""


@dataclass(frozen=True)
class Plan:
    """What to record: every one of `poses` with every payload (kg; none: the arm's own), from every side, `repeats`
    times in a row.

    `noise` is the tip's standard deviation for each component (m). `sides` both: each pose is come to twice, every
    joint the second time from the other side; one: all joints upwards; random. `temperature` (K, from and to) wanders
    between the two; `hours` is how long it all takes. `free_frame` measures in a frame that stands anywhere.
    `outliers` is the share of readings that are off by 10 to 50 standard deviations. `joint_side` and `commands` add
    encoders on the joints' side (with `encoder_noise`, rad or m) and logged commands, `orientation` how the tool
    is turned (with `turn_noise`, rad about each axis). `slots` (see `instruments.instrument`; none: the whole place)
    and `instrument` say what is read instead of the tip's place, with the same `noise`; with `anchor_free` the
    recording does not say where the anchor is, and `bar` is where along bars the tip touches (m). A tilt's noise is
    in rad. `camera_noise` is that of a camera's depths (m) and of its turns about each axis (rad), by default five
    times `noise` and what `noise` makes of a target of 0.1 m. `at` are readings that name what to record in its
    place: poses, sides, payloads, temperatures and times are theirs. `torque_noise` (n,; none: no torques) is that of
    the torques that the drives hold at rest, without friction (N*m, of slides N). Readings at which an instrument reads
    nothing are left out; with `every_row` they stay, as zero.
    """

    poses: int
    noise: float = 15e-6
    repeats: int = 3
    payloads: tuple[float, ...] = ()
    sides: Sides = "both"
    temperature: tuple[float, float] | None = None
    hours: float | None = None
    seed: int = 1
    free_frame: bool = False
    outliers: float = 0.0
    joint_side: bool = False
    commands: bool = False
    base_target: bool = False
    encoder_noise: float = 2e-6
    orientation: bool = False
    turn_noise: float = 20e-6
    slots: tuple[int, ...] = ()
    instrument: Instrument = field(default_factory=Instrument)
    anchor_free: bool = False
    bar: tuple[float, ...] = ()
    at: Recording | None = None
    torque_noise: tuple[float, ...] = ()
    camera_noise: tuple[float, float] | None = None
    every_row: bool = False

    @property
    def of_camera(self) -> tuple[float, float]:
        """The noise of a camera's depths (m) and turns (rad)."""
        return self.camera_noise or (_DEEP * self.noise, self.noise / _TARGET)

    def declared_in(self, recording: Recording) -> Recording:
        """A recording that says how large its noise is."""
        if self.noise <= 0.0:
            return recording
        if not any(kind.name == "camera" for kind in kinds_of(self.slots)):
            return replace(recording, sigma=self.noise)
        deep, turns = self.of_camera
        axes = (self.noise, self.noise, deep)
        mean = math.sqrt(sum(axis * axis for axis in axes) / 3.0)
        return replace(recording, sigma=mean, sigma_axes=axes, sigma_angle=turns)


@dataclass(frozen=True)
class Simulation:
    """A simulated recording; `error` (N, 3) is what the model's physics moves the tip by (m), `idle` names effects of
    the arm's `effects` that move nothing in it."""

    recording: Recording
    error: Array
    idle: tuple[str, ...]


def simulate(arm: Arm, plan: Plan) -> Simulation:
    """A recording of an arm with all the physics of its model; play has come to lie by load and side of approach.

    Poses are a scrambled Sobol sequence over the joint ranges, in the order in which it runs, so that neighbours in
    time are not neighbours in space. Rows come out as poses * payloads * sides * repeats.
    Poses that put the arm where its file has it avoid to are left out, and others taken.
    Raises what `arm.errors.model.beams_of` raises where the arm lacks a figure, ValueError for a plan without rows,
    `NoRoom` where what is to be avoided leaves too few poses.
    """
    if plan.poses < 1 or plan.repeats < 1:
        raise ValueError("a recording has at least one pose and one reading of it")
    random = np.random.default_rng(plan.seed)
    bare = _visited(arm, plan, random) if plan.at is None else plan.at
    kind = kinds_of(plan.slots)[0] if plan.slots else None
    camera = kind is not None and kind.name == "camera"
    if kind is not None and kind.label:
        bare = _touching(bare, arm, plan, random)
    state = undeformed(arm, bare, RULES.residual)
    if plan.torque_noise:
        loads = [np.broadcast_to(np.asarray(joint.drive_load), (bare.size,)) for joint in state.joints]
        # Noise of its own: the same seed gives the same tips with and without torques.
        scatter = np.array(plan.torque_noise) * np.random.default_rng([plan.seed, 1]).standard_normal(bare.q.shape)
        bare = replace(bare, torque=scatter - np.stack(loads, axis=1))
    channels = Asked(
        bare.size,
        joint_side=plan.joint_side,
        base_target=_BASE_TARGET if plan.base_target else None,
        command=plan.commands,
        turn=plan.orientation or (kind is not None and kind.turns_with == "tool"),
        levels=None if kind is None or kind.turns_with != "link" else np.full(bare.size, plan.instrument.tilt_link),
    )
    moved = seen_of_model(state, active_effects(arm), channels)
    tips, idle = columns(state.tip(), bare.size) + moved.tip, _idle(state, arm, channels)
    if kind is None:
        return Simulation(_of_tip(bare, arm, tips, moved, state, plan, random), moved.tip, idle)
    axes = None
    if moved.turn is not None:
        axes = Rotation.from_rotvec(moved.turn).as_matrix() @ matrices(state.frames.orientation, bare.size)
    if camera and axes is not None:
        return Simulation(_by_camera(bare, tips, axes, plan, random), moved.tip, idle)
    if bare.touches is not None:
        return Simulation(bare, moved.tip, idle)
    recording, error = _in_part(bare, arm, kind, tips, axes, moved, plan, random)
    return Simulation(recording, error, idle)


def _of_tip(
    bare: Recording, arm: Arm, tips: Array, moved: Channels, state: PoseState, plan: Plan, random: np.random.Generator
) -> Recording:
    """What is read of whole tips (N, 3), m, and of what is recorded beside them."""
    width = 2 if arm.planar() else 3
    tip = tips[:, :width] + plan.noise * random.standard_normal((bare.size, width))
    tip = tip + _outliers(plan, random, tip.shape)
    base = None
    if moved.base is not None:
        base = np.array(_BASE_TARGET) + moved.base + plan.noise * random.standard_normal((bare.size, 3))
    orientation = None
    if moved.turn is not None:
        turn = moved.turn + plan.turn_noise * random.standard_normal((bare.size, 3)) * ([0, 0, 1] if width == 2 else 1)
        orientation = Rotation.from_rotvec(turn).as_matrix() @ matrices(state.frames.orientation, bare.size)
    if plan.free_frame:
        tip, base, orientation = _elsewhere(random, tip, base, orientation)
    return replace(
        bare,
        tip=tip,
        orientation=orientation,
        seat="unused" if orientation is None else "free",
        joint_side=_encoders(bare.q, moved.joint_side, plan, random, 1.0),
        commanded=_encoders(bare.q, moved.command, plan, random, -1.0, noisy=False),
        base_target=base,
        frame="free" if plan.free_frame else bare.frame,
    )


def _by_camera(bare: Recording, tip: Array, turned: Array, plan: Plan, random: np.random.Generator) -> Recording:
    """Where a camera sees a target of which one is on the tool, the other anywhere and turned anyhow; a camera that
    stands still looks at the middle of the places reached (whether the target can be seen is not asked)."""
    on_tool = plan.instrument.camera == "on_tool"
    middle = tip.mean(axis=0)
    reach = float(np.linalg.norm(tip - middle, axis=1).max())
    way = random.standard_normal(3)
    way /= np.linalg.norm(way)
    stands = middle + random.uniform(*_AWAY) * reach * way
    fixed: Array = Rotation.from_quat(random.standard_normal(4)).as_matrix()
    if not on_tool:
        fixed = np.asarray(Rotation.align_vectors(-way[None], [[0.0, 0.0, 1.0]])[0].as_matrix())
    seat: Array = Rotation.from_quat(random.standard_normal(4)).as_matrix()
    carried, at = turned @ seat, tip + turned @ random.uniform(-_ON_TOOL, _ON_TOOL, 3)
    if on_tool:
        place, seen = np.einsum("nab,na->nb", carried, stands - at), np.transpose(carried, (0, 2, 1)) @ fixed
    else:
        place, seen = (at - stands) @ fixed, fixed.T @ carried
    deep, turns = plan.of_camera
    across = np.array([1.0, 1.0, deep / plan.noise if plan.noise > 0.0 else 1.0])
    noise = np.array([plan.noise, plan.noise, deep]) * random.standard_normal(place.shape)
    shaken = Rotation.from_rotvec(turns * random.standard_normal(place.shape)).as_matrix() @ seen
    return replace(
        bare,
        tip=place + noise + across * _outliers(plan, random, place.shape),
        orientation=shaken,
        seat="free",
        frame="free",
        tool="free",
        slots=np.tile(plan.slots, (bare.size, 1)),
        instrument=plan.instrument,
    )


def _in_part(
    bare: Recording,
    arm: Arm,
    kind: InstrumentKind,
    tips: Array,
    axes: Array | None,
    moved: Channels,
    plan: Plan,
    random: np.random.Generator,
) -> tuple[Recording, Array]:
    """What an instrument reads of tips (N, 3) and axes of the last link (N, 3, 3) where it does not read their place,
    and what moves the tips of the readings that it gives."""
    free = plan.free_frame and not kind.turns_with
    recording = replace(
        bare,
        tip=np.zeros((bare.size, len(plan.slots))),
        slots=np.tile(plan.slots, (bare.size, 1)),
        instrument=plan.instrument,
        frame="free" if free else "known",
    )
    if free:
        tips, _, _ = _elsewhere(random, tips, None, None)
    stand = None
    if moved.level is not None:
        stand = stand_of(recording, arm)
        assert stand is not None
        stand = stand.turned(moved.level)
    whole = kind.simulated(Stood(tips, axes, stand, arm), plan.instrument, random)
    first = slots_of(kind.name)[0]
    read = whole[:, [slot - first for slot in plan.slots]]
    read = read + plan.noise * random.standard_normal(read.shape) + _outliers(plan, random, read.shape)
    instrument = kind.recorded(plan.instrument, anchor_free=plan.anchor_free)
    there = np.asarray(np.isfinite(read).all(axis=1), dtype=np.bool_)
    recording = replace(recording, tip=np.where(there[:, None], read, 0.0), instrument=instrument)
    if there.all() or plan.every_row:
        return recording, moved.tip
    if not there.any():
        raise NoRoom(f"the {kind.name.replace('_', ' ')} reads nothing at any of the poses")
    kept = recording.kept(there)
    time = None if kept.time is None else kept.time - kept.time[0]
    last = since_the_reading_before(kept.q)
    return replace(kept, row=np.arange(1, kept.size + 1), time=time, last_moves=last), moved.tip[there]


def _touching(bare: Recording, arm: Arm, plan: Plan, random: np.random.Generator) -> Recording:
    """The readings brought to where the arm, with all its physics, touches points or planes."""
    visit = np.repeat(np.arange(bare.size // plan.repeats), plan.repeats)
    if plan.at is not None:
        visit = np.cumsum(np.concatenate([[0], np.any(np.diff(bare.q, axis=0) != 0.0, axis=1)])).astype(np.int64)
    off = plan.noise * random.standard_normal((bare.size, 3)) + _outliers(plan, random, (bare.size, 3))

    def tips(q: Array) -> Array:
        state = undeformed(arm, replace(bare, q=q), RULES.residual)
        moved = seen_of_model(state, active_effects(arm), Asked(bare.size))
        return columns(state.tip(), bare.size) + moved.tip

    planes = kinds_of(plan.slots)[0].name == "plane"
    touches = touched(
        arm, bare.q, visit, off, tips, random, planes=planes, bar=plan.bar, planned=bare.touches,
        planned_along=bare.bar_at if plan.bar else None,
    )  # fmt: skip
    q = _written(touches.q, arm)
    named = replace(plan.instrument, labels=bare.instrument.labels or tuple(f"{k + 1}" for k in range(touches.count)))
    whole = replace(
        bare,
        q=q,
        tip=np.zeros((bare.size, len(plan.slots))),
        slots=np.tile(plan.slots, (bare.size, 1)),
        touches=touches.label,
        bar_at=touches.along if plan.bar else None,
        instrument=named,
    ).kept(touches.keep & room_of(arm, None).allows(arm, q))
    last = since_the_reading_before(whole.q)
    return replace(whole, row=np.arange(1, whole.size + 1), last_moves=last)


def _visited(arm: Arm, plan: Plan, random: np.random.Generator) -> Recording:
    """Joint coordinates and conditions of every reading, the tip still to come."""
    from scipy.stats import qmc  # here, for it loads all of scipy's statistics

    sobol = qmc.Sobol(arm.size, scramble=True, rng=random)
    ends, room = np.array([joint.range for joint in arm.joints]), room_of(arm, None)
    count = 2 ** max(1, math.ceil(math.log2(plan.poses)))

    def allowed(q: Array) -> Array:
        whole = completed(arm, _written(q, arm))
        return whole[room.allows(arm, whole)]

    poses = drawn(
        room, (ends[:, 0], ends[:, 1]), lambda low, high: low + (high - low) * sobol.random(count), allowed,
        plan.poses,
    )  # fmt: skip
    if len(poses) < plan.poses:
        raise NoRoom(f"what is to be avoided leaves {len(poses)} poses of the {plan.poses} asked for, of many tried")
    payloads = plan.payloads or (None,)
    q, sides, mass = [], [], []
    for payload in payloads:
        order = random.permutation(plan.poses) if len(payloads) > 1 else np.arange(plan.poses)
        for pose in order.tolist():
            first = np.ones(arm.size) if plan.sides == "one" else random.choice([-1.0, 1.0], arm.size)
            for side in (first, -first) if plan.sides == "both" else (first,):
                q.append(poses[pose])
                sides.append(side)
                mass.append(np.nan if payload is None else payload)
    visits = len(q)
    rows = visits * plan.repeats
    time = np.arange(rows) * _BETWEEN_READINGS + np.repeat(np.arange(visits), plan.repeats) * _BETWEEN_VISITS
    if plan.hours is not None and rows > 1:
        time = time * (3600.0 * plan.hours / time[-1])
    read = np.repeat(np.array(q), plan.repeats, axis=0)
    return Recording(
        file="",
        q=read,
        last_moves=since_the_reading_before(read),
        tip=np.zeros((rows, 2)),
        row=np.arange(1, rows + 1),
        time=np.round(time, 1),
        sides=np.repeat(np.array(sides), plan.repeats, axis=0),
        payload_mass=np.repeat(np.array(mass), plan.repeats) if plan.payloads else None,
        temperature=None if plan.temperature is None else _temperature(time, plan.temperature, random),
        branch=arm.tip,
    )


def _written(q: Array, arm: Arm) -> Array:
    """Coordinates rounded to what a file holds of them: 1e-5 deg or 1e-5 mm."""
    unit = np.array([math.radians(1e-5) if joint.revolute else 1e-8 for joint in arm.joints])
    return np.round(q / unit) * unit


def _temperature(time: Array, limits: tuple[float, float], random: np.random.Generator) -> Array:
    """A slow walk that touches both limits (K): no line in time, so that drift and warming can be distinguished."""
    phase = time / max(float(time[-1]), 1.0)
    waves = np.zeros_like(phase)
    for cycles in (1.4, 2.3, 3.7):
        waves += np.sin(2.0 * math.pi * (cycles * phase + random.uniform())) / cycles
    spread = float(np.ptp(waves))
    share = (waves - waves.min()) / spread if spread > 0.0 else np.zeros_like(waves)
    celsius = limits[0] + (limits[1] - limits[0]) * share - ZERO_CELSIUS
    return np.round(celsius, 3) + ZERO_CELSIUS


def _outliers(plan: Plan, random: np.random.Generator, shape: tuple[int, ...]) -> Array:
    rows, width = shape
    off = random.uniform(size=rows) < plan.outliers
    direction = random.standard_normal((rows, width))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    size = plan.noise * random.uniform(*_OUTLIERS, size=rows)
    return np.where(off, size, 0.0)[:, None] * direction


def _encoders(
    q: Array, moved: Array | None, plan: Plan, random: np.random.Generator, sign: float, *, noisy: bool = True
) -> Array | None:
    if moved is None:
        return None
    return q + sign * moved + (plan.encoder_noise * random.standard_normal(q.shape) if noisy else 0.0)


def _elsewhere(
    random: np.random.Generator, tip: Array, base: Array | None, orientation: Array | None
) -> tuple[Array, Array | None, Array | None]:
    """What was measured from an instrument that stands some metres away, turned anyhow."""
    width = tip.shape[1]
    if width == 2:
        turn = Rotation.from_euler("z", random.uniform(-math.pi, math.pi)).as_matrix()
    else:
        turn = Rotation.from_quat(random.standard_normal(4)).as_matrix()
    shift = random.uniform(-2.0, 2.0, 3)
    moved = tip @ turn[:width, :width].T + shift[:width]
    return moved, None if base is None else base @ turn.T + shift, None if orientation is None else turn @ orientation


def _idle(state: PoseState, arm: Arm, asked: Asked) -> tuple[str, ...]:
    """Effects of the arm's `effects` that no instrument of this recording sees anything of."""
    added = active_effects(arm)[len(active_effects(arm)) - len(arm.effects) :]

    def silent(channels: Channels) -> bool:
        parts: Sequence[Array | None] = (
            channels.tip, channels.joint_side, channels.base, channels.command, channels.turn, channels.level
        )  # fmt: skip
        return all(part is None or not np.any(part) for part in parts)

    return tuple(item.effect.id for item in added if silent(seen(state, item.effect, item.settings, asked)))
