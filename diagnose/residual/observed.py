"""A recording set against the model: residuals in every channel, whitened, and the rows that belong together.

Each reading is one row; its columns are the tip's components and whatever further instruments there are (an encoder on
the joint's side, a target on the base, commands beside encoders), each divided by its own scatter, so that plain least
squares weighs them rightly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from arm.chain.arrays import columns, matrices
from arm.chain.chain import Arm, EffectEntry, FloatVector
from arm.chain.statics import PoseState, solve
from arm.effects import EFFECTS, Settings
from arm.effects.angles.encoder_offset import ENCODER_OFFSET
from arm.effects.geometry.instrument_scale import INSTRUMENT_SCALE
from arm.effects.geometry.link_length import LINK_LENGTH
from arm.effects.loads.base_tilt import weights_added
from arm.errors.model import beams_of
from arm.errors.recorded import Asked, Channels, levels_of, on_shape, seen, shape_of
from arm.errors.tip import ActiveEffect, active_effects
from diagnose.instruments.camera import Sight, is_camera
from diagnose.instruments.level import link_of_levels, stand_of
from diagnose.instruments.view import View, viewed
from diagnose.recording import Recording
from diagnose.rules.residual_rules import ResidualRules
from diagnose.rules.rules import RULES, Rules
from diagnose.several.recordings import Several
from diagnose.several.states import joined
from diagnose.several.views import view_of_several

from .alignment import Alignment, aligned
from .orientation import has_orientation, turn_left
from .recorded_conditions import conditions_of
from .torque import DriveTorque, drive_torques, under_measured
from .wander import clock, growth, without_wander

Array = NDArray[np.float64]

_LEVEL = 1e-9
_TOOL_PASSES, _TOOL_FOUND = 4, 1e-6
"""m; a free tool is put into the arm and sought again until it moves by less than this."""


@dataclass(frozen=True)
class Observed:
    """N readings against the model. `residual` (N, C) holds measured less modelled, m and rad, the tip's D components
    first; `scale` (C,) what each column is divided by; `block` (N,) numbers visits: consecutive readings at one pose.

    `correlation` is that of each reading's noise with the one before, taken out by `whitened`, and so is `wander`: how
    fast the variance of a random walk below the tip's noise grows, per unit of `clock`, of `scale` squared. `about` is
    what was found so large that first order is taken about it: the residual is less by what that moves beyond first
    order.
    `nominal` is the arm undeformed, `state` as its model and `about` deform it: patterns are those about that shape.
    `rules` are those of the whole diagnosis.

    Of several recordings (`Several`) frame and tool are each one's own, and so is how loud its instrument is: `loud`
    (R,) is what `scale` is multiplied by for each recording's readings (None: nothing); where each number is a reading
    of its own, for each kind of number as well.

    `torques` are what measured torques say; where compliance is judged by them, they are the loads in `state`, and
    `by_weights` is the state with those that the model's weights give.

    `view` says what a displacement of the tip shows where something else than its place was measured; the tip's columns
    are those readings then.
    """

    arm: Arm
    unknown_masses: tuple[int, ...]
    recording: Recording
    nominal: PoseState
    state: PoseState
    asked: Asked
    alignment: Alignment
    residual: Array
    scale: Array
    block: NDArray[np.int64]
    correlation: float = 0.0
    about: tuple[EffectEntry, ...] = ()
    rules: Rules = RULES
    loud: Array | None = None
    wander: float = 0.0
    view: View | None = None
    torques: tuple[DriveTorque, ...] = ()
    by_weights: PoseState | None = None

    @property
    def loud_with(self) -> NDArray[np.int64] | None:
        """Which readings (N,), numbered from 0, are as loud as each other; None where all are."""
        slots = self.recording.slots
        if slots is None or slots.shape[1] > 1 or (slots == slots[0]).all():
            return self.which
        told = slots if self.which is None else np.column_stack([self.which, slots])
        return np.unique(told, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)

    @property
    def space(self) -> int:
        """How many components a displacement of the tip has, 2 or 3."""
        return self.components if self.view is None else self.view.shown.shape[2]

    def of_tip(self, moved: Array, turned: Array | None = None) -> Array:
        """What the instrument of the tip sees of displacements (N, 3), m, of the tip: (N, W), all of it as a rule; a
        level sees the turns (N, 3), rad, of what it stands on."""
        return moved[:, : self.components] if self.view is None else self.view.of_tip(moved, turned)

    @property
    def which(self) -> NDArray[np.int64] | None:
        """The recording (N,), from 0, that each reading is from; None where there is but one."""
        return self.recording.which if isinstance(self.recording, Several) else None

    @property
    def components(self) -> int:
        """How many components of the tip were measured: 2 or 3, or how many numbers an instrument read."""
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
        parts = [self.of_tip(channels.tip, channels.level if self.sight is None else channels.turn)]
        parts += [part for part in (channels.joint_side, channels.base, channels.command) if part is not None]
        if self.has_turns and channels.turn is not None:
            parts.append(self.turns(channels.turn))
        return np.concatenate(parts, axis=1)

    @property
    def sight(self) -> Sight | None:
        """What a camera sees; None where none was used."""
        return None if self.view is None else self.view.sight

    @property
    def has_turns(self) -> bool:
        """Whether readings say how the tool is turned."""
        return self.asked.turn and bool(has_orientation(self.recording).any())

    @property
    def turn_columns(self) -> slice:
        """Where in a row the turns of the tool stand; nowhere if there are none."""
        count = self.residual.shape[1]
        return slice(count - (turns_measured(self.space) if self.has_turns else 0), count)

    def turns(self, turn: Array) -> Array:
        """Turns about the base's axes (N, 3) as they were measured, (N, 1 or 3), by a camera about its own: nought
        where a row has none."""
        if self.sight is not None:
            turn = np.einsum("nab,na->nb", self.sight.axes, turn)
        shown = turn[:, -turns_measured(self.space) :]
        return shown * has_orientation(self.recording)[:, None]

    def signature(self, effect: str, settings: Settings) -> Array:
        """What an effect moves in every column (N, C), m and rad."""
        found = self.stacked(seen(self.state, EFFECTS[effect], settings, self.asked))
        if self.sight is not None and effect == INSTRUMENT_SCALE.id:
            # A target that is not printed to scale: all that is read is too large in proportion.
            found[:] = 0.0
            read = self.recording.tip - self.sight.residual
            found[:, : self.components] = settings.values.get("scale", 0.0) * read
        elif self.view is not None and effect == INSTRUMENT_SCALE.id:
            # Positions are too far out in proportion; a distance has no origin, and a touch no number.
            found[:, : self.components][~self.view.framed] = 0.0
        stretch = settings.values.get("stretch", 0.0) if effect == LINK_LENGTH.id else 0.0
        if self.view is not None and stretch != 0.0:
            # In proportion, touches are what they are told by: an arm of no length would touch anything.
            found[:, : self.components] -= stretch * self.view.of_tip(self.view.at - self.view.settled)
        return found

    def drive_moved(self, joint: int) -> Array:
        """What one unit of motion (rad, m) of a joint (from 0) moves in every column (N, C), m and rad."""
        unit = Settings((joint,), MappingProxyType({"offset": 1.0}))
        return self.stacked(seen(self.state, ENCODER_OFFSET, unit, self.asked))

    def whitened(self, columns: Array) -> Array:
        """Columns (N, C) or (N, C, d) as (N * C) or (N * C, d) of unit scatter, without the correlation of neighbouring
        rows (the transformation of S. J. Prais & C. B. Winsten, 1954)."""
        scaled = self.without_memory(self.scaled(columns))
        if self.wander > 0.0:
            tip, others = scaled[:, : self.components], scaled[:, self.components :]
            scaled = np.concatenate([without_wander(tip, self.wanders), others], axis=1)
        return scaled.reshape(scaled.shape[0] * scaled.shape[1], *columns.shape[2:])

    def scaled(self, columns: Array) -> Array:
        """Columns (N, C) or (N, C, d) over their scatter."""
        return self.evened(columns) / (self.scale if columns.ndim == 2 else self.scale[:, None])

    def evened(self, columns: Array) -> Array:
        """Columns (N, ...) over how loud each reading's recording is."""
        return columns if self.loud is None else columns / self.loudness.reshape(-1, *(1,) * (columns.ndim - 1))

    @property
    def loudness(self) -> Array:
        """How loud each reading's instrument is (N,), one where all are alike."""
        group = self.loud_with
        return np.ones(self.rows) if group is None or self.loud is None else self.loud[group]

    def without_memory(self, columns: Array, correlation: float | None = None) -> Array:
        """Columns (N, ...) less what each reading shares with the one before in its recording."""
        rho, which = self.correlation if correlation is None else correlation, self.which
        if which is None or rho == 0.0:
            return without_memory(columns, rho)
        return np.concatenate([without_memory(columns[which == one], rho) for one in np.unique(which).tolist()])

    @property
    def wanders(self) -> Array:
        """By how much the variance of what wanders grows from each reading to the next (N - 1,), of `scale` squared;
        infinite where another recording begins."""
        return growth(clock(self.recording), self.wander, self.which)

    def still(self, left: Array) -> Array:
        """What is left of the tip (N, D), m, without what wanders: each reading less what those before foretell."""
        if self.wander <= 0.0:
            return left
        scale = self.scale[: self.components] * self.loudness[:, None]
        return without_wander(left / scale, self.wanders) * scale

    @property
    def softening(self) -> tuple[EffectEntry, ...]:
        """The flexibility beyond the arm file's, through which loads act in `signature` (see `softened`)."""
        return _softening(self.state, self.arm)

    def softened(self, entries: Sequence[EffectEntry]) -> Observed:
        """The same with loads acting through these entries of flexibility too; the residual stays against the file."""
        return replace(self, state=_with_effects(self.state, self.arm, entries, self.about))

    @property
    def arm_given(self) -> Arm:
        """The arm as the file says: masses unknown again, and the tool without what was found."""
        links = tuple(
            replace(link, mass=None) if index in self.unknown_masses else link
            for index, link in enumerate(self.arm.links)
        )
        if self.sight is not None:
            return self.arm.with_links(links)
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
    wander: float = 0.0,
    about: Sequence[EffectEntry] = (),
    rules: Rules = RULES,
    loud: Array | None = None,
    softening: Sequence[EffectEntry] = (),
) -> Observed:
    """Set a recording against an arm's model.

    Links of unknown mass are taken as weightless; what they weigh is then a matter of the drives' compliance (see
    `candidates`). `scale` is by default one for the tip's components, and estimated for the other channels; `loud` is
    how loud each of several recordings is. `about` what else is known to be at work, still to be fitted: see
    `Observed`. `softening` is flexibility beyond the arm file's through which loads act, in what `about` moves too.
    Raises `arm.errors.model.PropertyNeeded` and the materials' errors where the model lacks a figure.
    """
    if isinstance(recording, Several):
        parts = [observe(arm, each, about=about, rules=rules, softening=softening) for each in recording.parts()]
        return replace(_of_several(parts, recording, scale, correlation), loud=loud)
    arm = arm.on(recording.branch)
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
        turn=bool(has_orientation(recording).any()) or is_camera(recording),
        levels=link_of_levels(recording),
    )
    nominal, state, modelled, alignment, first, view = _placed(
        known, recording, asked, about, rules.residual, softening
    )
    # What a camera sees or is sits beside the tip, at which loads act.
    beside = is_camera(recording)
    for _ in range(_TOOL_PASSES if recording.tool == "free" and not beside else 0):
        # Loads and turns act at the target that was found, not where the file says that the tip is.
        put = alignment.tool
        known = replace(known, tool=_moved(arm.tool, put))
        nominal, state, modelled, further, first, view = _placed(
            known, recording, asked, about, rules.residual, softening
        )
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
    if view is not None and view.sight is not None:
        if (there := has_orientation(recording)).any():
            parts.append(view.sight.turned + np.einsum("nab,na->nb", view.sight.axes, first) * there[:, None])
    elif modelled.turn is not None:
        left = turn_left(recording, nominal, modelled.turn, alignment.rotation) + first
        parts.append(left[:, -turns_measured(2 if alignment.rotation.shape[0] == 2 else 3) :])
    residual = np.concatenate(parts, axis=1)
    block = visits(recording, arm, rules=rules.residual)
    told = all(index == 0 and _upright(nominal) for index in unknown)
    torques = drive_torques(known, recording, nominal, block, rules.residual) if told else ()
    measured = any(each.instead for each in torques)
    return Observed(
        known,
        unknown,
        recording,
        nominal,
        under_measured(state, torques) if measured else state,
        asked,
        alignment,
        residual,
        np.ones(residual.shape[1]) if scale is None else scale,
        block,
        correlation,
        tuple(about),
        rules,
        wander=wander,
        view=view,
        torques=torques,
        by_weights=state if measured else None,
    )


def observed_about(
    observed: Observed,
    about: Sequence[EffectEntry],
    softening: Sequence[EffectEntry],
    recording: Recording | None = None,
) -> Observed:
    """The same readings, or others of the same instrument (`recording`), with first order taken about the arm as the
    entries `about` beside its own deform it, loads acting through `softening` too; scatter, memory and loudness
    stay."""
    return observe(
        observed.arm_given,
        observed.recording if recording is None else recording,
        scale=observed.scale,
        correlation=observed.correlation,
        wander=observed.wander,
        about=about,
        rules=observed.rules,
        loud=observed.loud,
        softening=softening,
    )


def _of_several(parts: Sequence[Observed], recording: Several, scale: Array | None, correlation: float) -> Observed:
    """Several recordings that were set against one model, each in its own frame and with its own tool, as one."""
    counts = [each.rows for each in parts]
    first = parts[0]
    blocks = np.cumsum([0, *(int(each.block[-1]) + 1 for each in parts)])
    said = tuple(
        f"{name}: {text}"
        for name, each in zip(recording.names, parts, strict=True)
        for text in each.alignment.undetermined
    )
    width = first.space
    # The arm has the file's tool: what was found of each recording's is in its own state.
    nowhere = Alignment(np.eye(width), np.zeros(width), np.zeros(width), first.alignment.residual, said)
    residual = np.concatenate([each.residual for each in parts])
    return Observed(
        replace(first.arm, tool=first.arm_given.tool),
        first.unknown_masses,
        recording,
        joined([each.nominal for each in parts], counts),
        joined([each.state for each in parts], counts),
        replace(
            joined([replace(each.asked, rows=0, levels=None) for each in parts], counts),
            rows=sum(counts),
            levels=_levels_of_several(parts),
        ),
        nowhere,
        residual,
        np.ones(residual.shape[1]) if scale is None else scale,
        np.concatenate([each.block + start for each, start in zip(parts, blocks[:-1], strict=True)]),
        correlation,
        first.about,
        first.rules,
        view=view_of_several([each.view for each in parts], recording.names),
        torques=tuple(
            replace(told, of=name) for name, each in zip(recording.names, parts, strict=True) for told in each.torques
        ),
        by_weights=None
        if all(each.by_weights is None for each in parts)
        else joined([each.by_weights or each.state for each in parts], counts),
    )


def _levels_of_several(parts: Sequence[Observed]) -> NDArray[np.int64] | None:
    """On which link a level stands at each reading of several recordings (N,), -1 where there is none."""
    if all(each.asked.levels is None for each in parts):
        return None
    none = [np.full(each.rows, -1) if each.asked.levels is None else each.asked.levels for each in parts]
    return np.concatenate(none).astype(np.int64)


def _placed(
    arm: Arm,
    recording: Recording,
    asked: Asked,
    about: Sequence[EffectEntry],
    rules: ResidualRules,
    softening: Sequence[EffectEntry],
) -> tuple[PoseState, PoseState, Channels, Alignment, Array, View | None]:
    """The arm at the readings, undeformed and as it stands, what its model moves in every channel (`about` too), and
    measured set against modelled tips; of what else is known to be at work, the turn to first order (N, 3); and what
    the instrument sees, where that is not the tip's place."""
    nominal = solve(
        arm,
        [recording.q[:, index] for index in range(arm.size)],
        beams_of(arm),
        conditions=conditions_of(recording, arm, rules=rules),
        payload_mass=recording.payload_mass,
        tip_force=None if recording.force is None else _columns(recording.force),
    )
    nominal = _with_effects(nominal, arm, softening, about)
    own = active_effects(arm)
    whole = (*own, *_entries(arm, about))
    shape = shape_of(nominal, whole, asked)
    modelled = replace(on_shape(shape, own, asked), tip=shape.tip, turn=shape.turn if asked.turn else None)
    first, turn, level = _to_first_order(shape.state, arm, about, asked)
    # Frame and tool are set against the arm as it is; what first order then fits is all of what was found.
    tips = columns(nominal.tip(), recording.size) + shape.tip
    if recording.slots is not None:
        directions = matrices(shape.state.frames.orientation, recording.size)
        if is_camera(recording):
            straight = matrices(nominal.frames.orientation, recording.size)
            directions, level = Rotation.from_rotvec(shape.turn).as_matrix() @ straight, turn
        stand = stand_of(recording, arm)
        stands = None if stand is None else stand.turned(levels_of(shape, whole, asked))
        view = viewed(recording, tips, directions, stands, flat=arm.planar(), rules=rules)
        residual = view.residual + view.of_tip(first, level)
        placed = Alignment(view.rotation, view.translation, view.tool, residual, view.undetermined)
        return nominal, shape.state, modelled, placed, turn, view
    width = recording.tip.shape[1]
    alignment = aligned(recording, shape.state, tips[:, :width], rules=rules)
    placed = replace(alignment, residual=alignment.residual + first[:, :width])
    return nominal, shape.state, modelled, placed, turn, None


def _with_effects(
    state: PoseState, arm: Arm, softening: Sequence[EffectEntry], about: Sequence[EffectEntry]
) -> PoseState:
    """The state of an arm through whose `softening` loads act too; the weights `about` hang from where plumb is."""
    effects = (*arm.effects, *softening, *weights_added(about))
    return replace(state, arm=replace(state.arm, effects=effects))


def _softening(state: PoseState, arm: Arm) -> tuple[EffectEntry, ...]:
    """The flexibility of a state beyond that of the arm."""
    beyond = state.arm.effects[len(arm.effects) :]
    return tuple(entry for entry in beyond if entry not in weights_added(beyond))


def _to_first_order(
    state: PoseState, arm: Arm, about: Sequence[EffectEntry], asked: Asked
) -> tuple[Array, Array, Array]:
    """What entries beside the arm's own move and turn the tip by to first order about `state`, and turn what levels
    stand on; (N, 3) m and rad."""
    found = [seen(state, each.effect, each.settings, asked) for each in _entries(arm, about)]
    nothing = np.zeros((asked.rows, 3))
    return (
        sum((each.tip for each in found), nothing),
        sum((each.turn for each in found if each.turn is not None), nothing),
        sum((each.level for each in found if each.level is not None), nothing),
    )


def _entries(arm: Arm, about: Sequence[EffectEntry]) -> tuple[ActiveEffect, ...]:
    """Entries beside the arm's own, as effects at work."""
    return active_effects(replace(arm, effects=(*arm.effects, *about)))[len(active_effects(arm)) :]


def beyond_first_order(observed: Observed, about: Sequence[EffectEntry]) -> Array:
    """What entries beside the arm's own move the tip by beyond first order about the state observed, (N, D), m."""
    if not about:
        return np.zeros((observed.rows, observed.components))
    arm, asked = observed.arm, observed.asked
    own = active_effects(arm)
    whole = (*own, *_entries(arm, about))
    with_them, without = (
        shape_of(_with_effects(observed.nominal, arm, _softening(observed.nominal, arm), weights), effects, asked)
        for effects, weights in ((whole, about), (own, ()))
    )
    first, turn, level = _to_first_order(observed.by_weights or observed.state, arm, about, asked)
    if observed.view is None:
        return (with_them.tip - without.tip - first)[:, : observed.components]
    turned = [None, None]
    if observed.sight is not None:
        turned, level = [with_them.turn, without.turn], turn
    if asked.levels is not None:
        turned = [levels_of(shape, effects, asked) for shape, effects in ((with_them, whole), (without, own))]
    beyond = observed.view.change(with_them.tip, turned[0]) - observed.view.change(without.tip, turned[1])
    return beyond - observed.view.of_tip(first, level)


def _upright(state: PoseState) -> bool:
    """Whether nothing that the first link weighs loads its drive."""
    joint, pull = state.joints[0], np.array(state.arm.gravity, dtype=float)
    axis = columns(joint.axis, 1)[0]
    across = np.cross(axis, pull) if joint.revolute else axis * float(axis @ pull)
    return float(np.linalg.norm(across)) <= _LEVEL * float(np.linalg.norm(pull))


def _moved(tool: FloatVector, by: Array) -> FloatVector:
    x, y, z = [*by.tolist(), 0.0][:3]
    return (tool[0] + x, tool[1] + y, tool[2] + z)


def visits(recording: Recording, arm: Arm, *, rules: ResidualRules = RULES.residual) -> NDArray[np.int64]:
    """Which visit (from 0) each reading belongs to: consecutive readings at one pose, payload and side."""
    same = same_pose(arm, rules)
    new = (np.abs(np.diff(recording.q, axis=0)) > same).any(axis=1)
    for held in (recording.payload_mass, recording.sides, recording.force, recording.observed_as):
        if held is not None:
            changed = np.diff(held, axis=0) != 0.0
            new |= changed if changed.ndim == 1 else changed.any(axis=1)
    block = np.concatenate([[0], np.cumsum(new)]).astype(np.int64)
    return block if recording.time is None else _long_stays_cut(block, rules.short_stay)


def same_pose(arm: Arm, rules: ResidualRules) -> Array:
    """How close coordinates (n,) of one pose lie, rad and m."""
    return np.array([rules.same_coordinate(joint.revolute) for joint in arm.joints])


def _long_stays_cut(block: NDArray[np.int64], short: int) -> NDArray[np.int64]:
    """Visits with long stays as several of a few readings each: meanwhile arms warm and frames drift."""
    count = np.bincount(block)
    within = np.arange(len(block)) - np.repeat(np.cumsum(count) - count, count)
    part = np.where(count[block] >= 2 * short, within // short, 0)
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
    same = same_pose(observed.arm, observed.rules.residual)
    rounded = np.round(observed.recording.q / (observed.rules.residual.one_pose * same)).astype(np.int64)
    return np.unique(rounded, axis=0, return_inverse=True)[1].reshape(-1).astype(np.int64)


def one_condition(observed: Observed) -> bool:
    """Whether all readings are of one pose, payload, side, force and temperature, however often it was read."""
    recording = observed.recording
    near = observed.rules.residual.one_pose * same_pose(observed.arm, observed.rules.residual)
    held = [each for each in (recording.payload_mass, recording.sides, recording.force) if each is not None]
    still = bool((np.ptp(recording.q, axis=0) <= near).all())
    warmed = [each for each in (recording.temperature, recording.link_temperature) if each is not None]
    still &= all(float(np.ptp(each, axis=0).max()) <= observed.rules.residual.other_temperature for each in warmed)
    return still and all(float(np.ptp(each, axis=0).max()) <= observed.rules.residual.other_load for each in held)


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
