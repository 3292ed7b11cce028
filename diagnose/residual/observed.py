"""A recording set against the model: residuals in every channel, whitened, and the rows that belong together.

Each reading is one row; its columns are the tip's components and whatever further instruments there are (an encoder on
the joint's side, a target on the base, commands beside encoders), each divided by its own scatter, so that plain least
squares weighs them rightly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from arm.chain import Arm, EffectEntry, FloatVector
from arm.effects import EFFECTS, Settings
from arm.error import active_effects
from arm.model import beams_of
from arm.recorded import Asked, Channels, beyond, seen, seen_of_model
from arm.statics import PoseState, solve

from .alignment import Alignment, aligned
from .conditions import conditions_of
from .orientation import has_orientation, turn_left
from .recording import SAME_ANGLE, SAME_LENGTH, Recording

Array = NDArray[np.float64]

_SHORT_STAY = 6
"""Readings of a visit, where a stay at one pose is twice as long or longer."""
_TOOL_PASSES, _TOOL_FOUND = 4, 1e-6
"""m; a free tool is put into the arm and sought again until it moves by less than this."""


@dataclass(frozen=True)
class Observed:
    """N readings against the model. `residual` (N, C) holds measured less modelled, m and rad, the tip's D components
    first; `scale` (C,) what each column is divided by; `block` (N,) numbers visits: consecutive readings at one pose.

    `correlation` is that of each reading's noise with the one before, taken out by `whitened`. `about` is what was
    found so large that first order is taken about it: the residual is less by what that moves beyond first order.
    """

    arm: Arm
    unknown_masses: tuple[int, ...]
    recording: Recording
    state: PoseState
    asked: Asked
    alignment: Alignment
    residual: Array
    scale: Array
    block: NDArray[np.int64]
    correlation: float = 0.0
    about: tuple[EffectEntry, ...] = ()

    @property
    def components(self) -> int:
        """How many components of the tip were measured, 2 or 3."""
        return self.recording.tip.shape[1]

    @property
    def rows(self) -> int:
        """The number of readings."""
        return len(self.residual)

    def tip_residual(self) -> Array:
        """The tip's residual (N, D), m."""
        return self.residual[:, : self.components]

    def stacked(self, channels: Channels) -> Array:
        """Channels as (N, C), in the order of `residual`."""
        parts = [channels.tip[:, : self.components]]
        parts += [part for part in (channels.joint_side, channels.base, channels.command) if part is not None]
        if channels.turn is not None:
            parts.append(self.turns(channels.turn))
        return np.concatenate(parts, axis=1)

    @property
    def turn_columns(self) -> slice:
        """Where in a row the turns of the tool stand; nowhere if there are none."""
        count = self.residual.shape[1]
        return slice(count - (turns_measured(self.components) if self.asked.turn else 0), count)

    def turns(self, turn: Array) -> Array:
        """Turns about the base's axes (N, 3) as they were measured, (N, 1 or 3): nought where a row has none."""
        shown = turn[:, -turns_measured(self.components) :]
        return shown * has_orientation(self.recording)[:, None]

    def signature(self, effect: str, settings: Settings) -> Array:
        """What an effect moves in every column (N, C), m and rad."""
        return self.stacked(seen(self.state, EFFECTS[effect], settings, self.asked))

    def whitened(self, columns: Array) -> Array:
        """Columns (N, C) or (N, C, d) as (N * C) or (N * C, d) of unit scatter, without the correlation of neighbouring
        rows (the transformation of S. J. Prais & C. B. Winsten, 1954)."""
        scaled = without_memory(columns / (self.scale if columns.ndim == 2 else self.scale[:, None]), self.correlation)
        return scaled.reshape(scaled.shape[0] * scaled.shape[1], *columns.shape[2:])

    @property
    def softening(self) -> tuple[EffectEntry, ...]:
        """The flexibility beyond the arm file's, through which loads act in `signature` (see `softened`)."""
        return self.state.arm.effects[len(self.arm.effects) :]

    def softened(self, entries: Sequence[EffectEntry]) -> Observed:
        """The same with loads acting through these entries of flexibility too; the residual stays against the file."""
        arm = replace(self.state.arm, effects=(*self.arm.effects, *entries))
        return replace(self, state=replace(self.state, arm=arm))

    @property
    def arm_given(self) -> Arm:
        """The arm as the file says: masses unknown again, and the tool without what was found."""
        links = tuple(
            replace(link, mass=None) if index in self.unknown_masses else link
            for index, link in enumerate(self.arm.links)
        )
        return replace(self.arm, tool=_moved(self.arm.tool, -self.alignment.tool)).with_links(links)


def without_memory(columns: Array, correlation: float) -> Array:
    """Columns (N, ...) less what each reading shares with the one before (Prais & Winsten, see `Observed.whitened`)."""
    if correlation == 0.0:
        return columns
    left = (columns[1:] - correlation * columns[:-1]) / np.sqrt(1.0 - correlation * correlation)
    return np.concatenate([columns[:1], left])


def kept(recording: Recording, keep: NDArray[np.bool_] | NDArray[np.int64]) -> Recording:
    """The recording with only the rows of `keep`."""
    changed: dict[str, object] = {}
    for name, value in vars(recording).items():
        if isinstance(value, np.ndarray) and len(value) == recording.size:
            changed[name] = value[keep]
    changed["other"] = {name: values[keep] for name, values in recording.other.items()}
    return replace(recording, **changed)  # pyright: ignore[reportArgumentType]


def observe(
    arm: Arm,
    recording: Recording,
    *,
    scale: Array | None = None,
    correlation: float = 0.0,
    about: Sequence[EffectEntry] = (),
) -> Observed:
    """Set a recording against an arm's model.

    Links of unknown mass are taken as weightless; what they weigh is then a matter of the drives' compliance (see
    `candidates`). `scale` is by default one for the tip's components, and estimated for the other channels. `about`
    what else is known to be at work, still to be fitted: see `Observed`.
    Raises `arm.model.PropertyNeeded` and the materials' errors where the model lacks a figure.
    """
    unknown = tuple(index for index, link in enumerate(arm.links) if link.section is None and link.mass is None)
    known = arm.with_links(
        tuple(replace(link, mass=0.0) if index in unknown else link for index, link in enumerate(arm.links))
    )
    target = recording.base_target
    asked = Asked(
        recording.size,
        joint_side=recording.joint_side is not None,
        base_target=None if target is None else _mean(target),
        command=recording.commanded is not None,
        turn=bool(has_orientation(recording).any()),
    )
    state, modelled, alignment, first = _placed(known, recording, asked, about)
    for _ in range(_TOOL_PASSES if recording.tool == "free" else 0):
        # Loads and turns act at the target that was found, not where the file says that the tip is.
        put = alignment.tool
        known = replace(known, tool=_moved(arm.tool, put))
        state, modelled, further, first = _placed(known, recording, asked, about)
        done = np.abs(further.tool).max() < _TOOL_FOUND
        # What a last pass moves it by is within the nuisances; the arm has what was put into it.
        alignment = replace(further, tool=put if done else put + further.tool)
        if done:
            break
    parts = [alignment.residual]
    if recording.joint_side is not None and modelled.joint_side is not None:
        parts.append(recording.joint_side - recording.q - modelled.joint_side)
    if target is not None and modelled.base is not None:
        parts.append(target - target.mean(axis=0) - modelled.base)
    if recording.commanded is not None and modelled.command is not None:
        parts.append(recording.q - recording.commanded - modelled.command)
    if modelled.turn is not None:
        left = turn_left(recording, state, modelled.turn + first[1], alignment.rotation) + first[2]
        parts.append(left[:, -turns_measured(recording.tip.shape[1]) :])
    residual = np.concatenate(parts, axis=1)
    return Observed(
        known,
        unknown,
        recording,
        state,
        asked,
        alignment,
        residual,
        np.ones(residual.shape[1]) if scale is None else scale,
        visits(recording, arm),
        correlation,
        tuple(about),
    )


def _placed(
    arm: Arm, recording: Recording, asked: Asked, about: Sequence[EffectEntry]
) -> tuple[PoseState, Channels, Alignment, tuple[Array, Array, Array]]:
    """The arm at the readings, what its model moves in every channel, and measured set against modelled tips; of what
    else is known to be at work, the shift to first order, the turn and the turn to first order, (N, 3)."""
    state = solve(
        arm,
        [recording.q[:, index] for index in range(arm.size)],
        beams_of(arm),
        conditions=conditions_of(recording, arm),
        payload_mass=recording.payload_mass,
        tip_force=None if recording.force is None else _columns(recording.force),
    )
    modelled = seen_of_model(state, active_effects(arm), asked)
    width = recording.tip.shape[1]
    further, turned, first, turn = _about(state, arm, about, asked)
    nominal = np.stack([np.broadcast_to(np.asarray(x, dtype=float), (recording.size,)) for x in state.tip()], axis=1)
    # Frame and tool are set against the arm as it is; what first order then fits is all of what was found.
    alignment = aligned(recording, state, (nominal + modelled.tip + further + first)[:, :width])
    placed = replace(alignment, residual=alignment.residual + first[:, :width])
    return state, modelled, placed, (first, turned + turn, turn)


def _about(
    state: PoseState, arm: Arm, about: Sequence[EffectEntry], asked: Asked
) -> tuple[Array, Array, Array, Array]:
    """What entries beside the arm's own move and turn the tip by beyond first order, and to first order; (N, 3) each,
    m, rad, m and rad."""
    nothing = np.zeros((asked.rows, 3))
    if not about:
        return nothing, nothing, nothing, nothing
    own = active_effects(arm)
    whole = active_effects(replace(arm, effects=(*arm.effects, *about)))
    found = [seen(state, each.effect, each.settings, asked) for each in whole[len(own) :]]
    first = sum((each.tip for each in found), nothing)
    turn = sum((each.turn for each in found if each.turn is not None), nothing)
    (shift, turned), (own_shift, own_turned) = beyond(state, whole, asked), beyond(state, own, asked)
    return shift - own_shift, turned - own_turned, first, turn


def beyond_first_order(observed: Observed, about: Sequence[EffectEntry]) -> Array:
    """What entries beside the arm's own move the tip by beyond first order, (N, D), m."""
    return _about(observed.state, observed.arm, about, observed.asked)[0][:, : observed.components]


def _moved(tool: FloatVector, by: Array) -> FloatVector:
    x, y, z = [*by.tolist(), 0.0][:3]
    return (tool[0] + x, tool[1] + y, tool[2] + z)


def visits(recording: Recording, arm: Arm) -> NDArray[np.int64]:
    """Which visit (from 0) each reading belongs to: consecutive readings at one pose, payload and side."""
    same = np.array([SAME_ANGLE if joint.revolute else SAME_LENGTH for joint in arm.joints])
    new = (np.abs(np.diff(recording.q, axis=0)) > same).any(axis=1)
    for held in (recording.payload_mass, recording.sides, recording.force):
        if held is not None:
            changed = np.diff(held, axis=0) != 0.0
            new |= changed if changed.ndim == 1 else changed.any(axis=1)
    block = np.concatenate([[0], np.cumsum(new)]).astype(np.int64)
    return block if recording.time is None else _long_stays_cut(block)


def _long_stays_cut(block: NDArray[np.int64]) -> NDArray[np.int64]:
    """Visits with long stays as several of a few readings each: meanwhile arms warm and frames drift."""
    count = np.bincount(block)
    within = np.arange(len(block)) - np.repeat(np.cumsum(count) - count, count)
    part = np.where(count[block] >= 2 * _SHORT_STAY, within // _SHORT_STAY, 0)
    new = (np.diff(block) != 0) | (np.diff(part) != 0)
    return np.concatenate([[0], np.cumsum(new)]).astype(np.int64)


def looks_quieter(observed: Observed) -> float:
    """How many times quieter readings of one visit look than they are, since each shares noise with the one before."""
    rho = observed.correlation
    if rho <= 0.0:
        return 1.0
    shared, pairs = 0.0, 0.0
    for rows in blocks_of(observed.block):
        lags = np.arange(1, len(rows))
        # Each visit counts by its degrees of freedom; its readings differ by what they do not share on average.
        each = 2.0 * float(np.sum((len(rows) - lags) * rho**lags)) / max(len(rows) * (len(rows) - 1), 1)
        shared += (len(rows) - 1) * each
        pairs += len(rows) - 1
    return 1.0 / np.sqrt(1.0 - shared / pairs) if pairs > 0.0 else 1.0


def poses(observed: Observed) -> NDArray[np.int64]:
    """Which pose (from 0) each reading belongs to, however often and under whatever load it was visited."""
    same = np.array([SAME_ANGLE if joint.revolute else SAME_LENGTH for joint in observed.arm.joints])
    rounded = np.round(observed.recording.q / (4.0 * same)).astype(np.int64)
    return np.unique(rounded, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)


def turns_measured(components: int) -> int:
    """About how many axes the tool can be turned: one in the plane."""
    return 1 if components == 2 else 3


def _mean(points: Array) -> tuple[float, float, float]:
    middle = points.mean(axis=0)
    return (float(middle[0]), float(middle[1]), float(middle[2]))


def _columns(array: Array) -> tuple[Array, Array, Array]:
    return (array[:, 0], array[:, 1], array[:, 2])


def rms_length(vectors: Array) -> float:
    """The root mean square length of vectors (N, D)."""
    return float(np.sqrt(np.mean(np.sum(vectors * vectors, axis=1)))) if len(vectors) else 0.0


def blocks_of(block: NDArray[np.int64]) -> Sequence[NDArray[np.int64]]:
    """The row numbers of each visit."""
    order = np.argsort(block, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(block[order])) + 1)
