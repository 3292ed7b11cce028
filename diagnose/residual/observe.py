"""Setting a recording against an arm's model: what the model moves in every channel, and what is left.

Each recording is set in its frame, with its tool where that is free; several become one. What was found so
large that first order is taken about it deforms the arm by finite motions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from linkwright.core.arm.chain.arrays import columns, matrices
from linkwright.core.arm.chain.chain import Arm, EffectEntry
from linkwright.core.arm.chain.conditions import Conditions, in_pieces
from linkwright.core.arm.chain.statics import PoseState, solve
from linkwright.core.arm.errors.exact import Deformed
from linkwright.core.arm.errors.model import beams_of
from linkwright.core.arm.errors.recorded import Asked, Channels, levels_of, on_shape, seen, shape_of
from linkwright.core.arm.errors.tip import ActiveEffect, active_effects
from linkwright.core.arm.errors.unknown_mass import of_unknown_mass, without_unknown
from linkwright.core.diagnose.instruments.camera import is_camera
from linkwright.core.diagnose.instruments.level import link_of_levels, stand_of
from linkwright.core.diagnose.instruments.registry import turns_with
from linkwright.core.diagnose.instruments.view import View, viewed
from linkwright.core.diagnose.recording import Recording
from linkwright.core.diagnose.rules.residual_rules import ResidualRules
from linkwright.core.diagnose.rules.rules import RULES, Rules
from linkwright.core.diagnose.several.recordings import Several
from linkwright.core.diagnose.several.states import joined
from linkwright.core.diagnose.several.views import view_of_several

from .alignment import Alignment, aligned
from .observed import Observed, kept, softening_of, tool_moved, turns_measured, with_effects
from .orientation import has_orientation, turn_left
from .recorded_conditions import conditions_of
from .visits import visits

Array = NDArray[np.float64]
Placed = TypeVar("Placed")
_Placed = tuple[PoseState, PoseState, Channels, Array, View | None]

_AT_ONCE = 8192
"""Readings that are computed together where only residuals are kept: as fast as all at once, with little memory."""
_TOOL_PASSES, _TOOL_FOUND = 4, 1e-6
"""m; a free tool is put into the arm and sought again until it moves by less than this."""


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
    Raises `arm.bodies.beams.PropertyNeeded` and the materials' errors where the model lacks a figure.
    """
    if isinstance(recording, Several):
        parts = [observe(arm, part, about=about, rules=rules, softening=softening) for part in recording.parts()]
        return replace(_of_several(parts, recording, scale, correlation), loud=loud)
    arm = arm.on(recording.branch)
    unknown = of_unknown_mass(arm)
    target, channels = recording.base_target, _asked(recording)

    def placed(known: Arm) -> tuple[_Placed, Alignment]:
        return _placed(known, recording, channels, about, rules.residual, softening)

    known, observed, alignment = _with_free_tool(without_unknown(arm, unknown), recording, placed)
    nominal, state, modelled, first, view = observed
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
    elif modelled.turn is not None and has_orientation(recording).any():
        left = turn_left(recording, nominal, modelled.turn, alignment.rotation) + first
        parts.append(left[:, -turns_measured(2 if alignment.rotation.shape[0] == 2 else 3) :])
    residual = np.concatenate(parts, axis=1)
    block = visits(recording, arm, rules=rules.residual)
    return Observed(
        known,
        unknown,
        recording,
        nominal,
        state,
        channels,
        alignment,
        residual,
        np.ones(residual.shape[1]) if scale is None else scale,
        block,
        correlation,
        tuple(about),
        rules,
        wander=wander,
        view=view,
    )


def residual_in_pieces(
    arm: Arm,
    recording: Recording,
    *,
    rules: Rules = RULES,
    heard: Callable[[int, int], None] | None = None,
    at_once: int = _AT_ONCE,
) -> Array:
    """The tip's residual (N, D), m, as `observe` finds it, without anything else that it holds: the model is evaluated
    for `at_once` readings after another, so that long recordings need little memory. `heard` hears how many are done,
    and of how many."""
    return np.concatenate([_in_pieces(arm.on(part.branch), part, rules, heard, at_once) for part in recording.parts()])


def _in_pieces(
    arm: Arm, recording: Recording, rules: Rules, heard: Callable[[int, int], None] | None, at_once: int
) -> Array:
    """The tip's residual (N, D), m, of one recording."""
    pieces = [slice(start, min(start + at_once, recording.size)) for start in range(0, recording.size, at_once)]

    def placed(known: Arm) -> tuple[None, Alignment]:
        arm_effects, effects = active_effects(known), list[_Stood]()
        held = in_pieces(conditions_of(recording, known, rules=rules.residual), pieces)
        for rows, conditions in zip(pieces, held, strict=True):
            some = kept(recording, np.arange(rows.start, rows.stop))
            channels = _asked(some)
            nominal = undeformed(known, some, rules.residual, conditions)
            effects.append(_stood(some, nominal, shape_of(nominal, arm_effects, channels), arm_effects, channels))
            if heard is not None:
                heard(rows.stop, recording.size)
        return None, _set_against(recording, known, _Stood.joined(effects), rules.residual)[0]

    return _with_free_tool(without_unknown(arm, of_unknown_mass(arm)), recording, placed)[2].residual


def _asked(recording: Recording) -> Asked:
    """What a recording holds beside the tip's place."""
    target = recording.base_target
    return Asked(
        recording.size,
        joint_side=recording.joint_side is not None,
        base_target=None if target is None else _mean(target),
        command=recording.commanded is not None,
        turn=bool(has_orientation(recording).any()) or _turns_with_tool(recording),
        levels=link_of_levels(recording),
    )


def _with_free_tool(
    arm: Arm, recording: Recording, placed: Callable[[Arm], tuple[Placed, Alignment]]
) -> tuple[Arm, Placed, Alignment]:
    """What is found of an arm `placed` at the readings, once a free tool has been put into it; the arm with that."""
    given = arm.tool
    result, alignment = placed(arm)
    # What a camera sees or is sits beside the tip, at which loads act.
    beside = is_camera(recording)
    for _ in range(_TOOL_PASSES if recording.tool == "free" and not beside else 0):
        # Loads and turns act at the target that was found, not where the file says that the tip is.
        put = alignment.tool
        arm = replace(arm, tool=tool_moved(given, put))
        result, further = placed(arm)
        done = np.abs(further.tool).max() < _TOOL_FOUND
        # What a last pass moves it by is within the nuisances; the arm has what was put into it.
        alignment = replace(further, tool=put if done else put + further.tool)
        if done:
            break
    return arm, result, alignment


def observed_about(
    observed: Observed,
    about: Sequence[EffectEntry],
    softening: Sequence[EffectEntry],
    recording: Recording | None = None,
) -> Observed:
    """The same readings, or others of the same instrument (`recording`), with first order taken about the arm as the
    entries `about` beside its deform it, loads acting through `softening` too; scatter, memory and loudness
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
    """Several recordings that were set against one model, each in its frame and with its tool, as one."""
    counts = [part.rows for part in parts]
    first = parts[0]
    blocks = np.cumsum([0, *(int(part.block[-1]) + 1 for part in parts)])
    sentences = tuple(
        f"{name}: {text}"
        for name, part in zip(recording.names, parts, strict=True)
        for text in part.alignment.undetermined
    )
    width = first.space
    # The arm has the file's tool: what was found of each recording's is in its state.
    nowhere = Alignment(np.eye(width), np.zeros(width), np.zeros(width), first.alignment.residual, sentences)
    residual = np.concatenate([part.residual for part in parts])
    return Observed(
        replace(first.arm, tool=first.arm_given.tool),
        first.unknown_masses,
        recording,
        joined([part.nominal for part in parts], counts),
        joined([part.state for part in parts], counts),
        replace(
            joined([replace(part.asked, rows=0, levels=None) for part in parts], counts),
            rows=sum(counts),
            levels=_levels_of_several(parts),
        ),
        nowhere,
        residual,
        np.ones(residual.shape[1]) if scale is None else scale,
        np.concatenate([part.block + start for part, start in zip(parts, blocks[:-1], strict=True)]),
        correlation,
        first.about,
        first.rules,
        view=view_of_several([part.view for part in parts], recording.names),
    )


def _levels_of_several(parts: Sequence[Observed]) -> NDArray[np.int64] | None:
    """On which link a level stands at each reading of several recordings (N,), -1 where there is none."""
    if all(part.asked.levels is None for part in parts):
        return None
    none = [np.full(part.rows, -1) if part.asked.levels is None else part.asked.levels for part in parts]
    return np.concatenate(none).astype(np.int64)


def undeformed(arm: Arm, recording: Recording, rules: ResidualRules, conditions: Conditions | None = None) -> PoseState:
    """The arm at the readings of a recording, under what it bears there, where nothing gives; `conditions` are those
    of the recording itself by default."""
    turned: dict[str, Any] = {}
    if recording.moment is not None:
        # In the plane a moment stays there: zero beside its axis, not columns of it.
        turned["moment"] = tuple(moment if moment.any() else 0.0 for moment in recording.moment.T)
    return solve(
        arm,
        [recording.q[:, index] for index in range(arm.size)],
        beams_of(arm),
        replace(arm.payload, **turned),
        conditions=conditions_of(recording, arm, rules=rules) if conditions is None else conditions,
        payload_mass=recording.payload_mass,
        tip_force=None if recording.force is None else _columns(recording.force),
    )


def _placed(
    arm: Arm,
    recording: Recording,
    channels: Asked,
    about: Sequence[EffectEntry],
    rules: ResidualRules,
    softening: Sequence[EffectEntry],
) -> tuple[_Placed, Alignment]:
    """The arm at the readings, undeformed and as it stands, what its model moves in every channel (`about` too), the
    turn (N, 3) to first order of what else is known to be at work, and what the instrument sees, where that is not the
    tip's place; and measured set against modelled tips."""
    nominal = with_effects(undeformed(arm, recording, rules), arm, softening, about)
    effects = active_effects(arm)
    whole = (*effects, *_entries(arm, about))
    shape = shape_of(nominal, whole, channels)
    modelled = replace(on_shape(shape, effects, channels), tip=shape.tip, turn=shape.turn if channels.turn else None)
    first, turn, level = _to_first_order(shape.state, arm, about, channels)
    # Frame and tool are set against the arm as it is; what first order then fits is all of what was found.
    alignment, view = _set_against(recording, arm, _stood(recording, nominal, shape, whole, channels), rules)
    seen_first = (
        first[:, : recording.tip.shape[1]]
        if view is None
        else view.of_tip(first, turn if _turns_with_tool(recording) else level)
    )
    result = (nominal, shape.state, modelled, turn, view)
    return result, replace(alignment, residual=alignment.residual + seen_first)


@dataclass(frozen=True)
class _Stood:
    """Where an arm stands at N readings: its tips (N, 3) m, the last link's axes, and how what levels stand on is
    turned (N, 3) rad, None without one."""

    tips: Array
    directions: Array
    levels: Array | None

    @classmethod
    def joined(cls, parts: Sequence[_Stood]) -> _Stood:
        """Those of one reading after another."""
        levels = [part.levels for part in parts if part.levels is not None]
        tips, directions = (np.concatenate([getattr(part, name) for part in parts]) for name in ("tips", "directions"))
        return cls(tips, directions, np.concatenate(levels) if levels else None)


def _stood(
    recording: Recording, nominal: PoseState, shape: Deformed, effects: Sequence[ActiveEffect], channels: Asked
) -> _Stood:
    rows, width = channels.rows, recording.tip.shape[1] if recording.slots is None else 3
    if _turns_with_tool(recording):
        straight = matrices(nominal.frames.orientation, rows)
        directions = Rotation.from_rotvec(shape.turn).as_matrix() @ straight
    else:
        directions = matrices(shape.state.frames.orientation, rows, width)
    levels = None if channels.levels is None else levels_of(shape, effects, channels)
    return _Stood(columns(nominal.tip(), rows) + shape.tip, directions, levels)


def _set_against(recording: Recording, arm: Arm, stood: _Stood, rules: ResidualRules) -> tuple[Alignment, View | None]:
    """What was measured against where the arm stands, frame and tool free where the recording says so."""
    if recording.slots is None:
        width = recording.tip.shape[1]
        return aligned(recording, stood.directions, stood.tips[:, :width], rules=rules), None
    stand = stand_of(recording, arm)
    stands = None if stand is None or stood.levels is None else stand.turned(stood.levels)
    view = viewed(recording, stood.tips, stood.directions, stands, flat=arm.planar(), rules=rules)
    return Alignment(view.rotation, view.translation, view.tool, view.residual, view.undetermined), view


def _to_first_order(
    state: PoseState, arm: Arm, about: Sequence[EffectEntry], channels: Asked
) -> tuple[Array, Array, Array]:
    """What entries beside the arm's move and turn the tip by to first order about `state`, and turn what levels
    stand on; (N, 3) m and rad."""
    displacements = [seen(state, entry.effect, entry.settings, channels) for entry in _entries(arm, about)]
    nothing = np.zeros((channels.rows, 3))
    return (
        sum((displacement.tip for displacement in displacements), nothing),
        sum((displacement.turn for displacement in displacements if displacement.turn is not None), nothing),
        sum((displacement.level for displacement in displacements if displacement.level is not None), nothing),
    )


def _entries(arm: Arm, about: Sequence[EffectEntry]) -> tuple[ActiveEffect, ...]:
    """Entries beside the arm's own, as effects at work."""
    return active_effects(replace(arm, effects=(*arm.effects, *about)))[len(active_effects(arm)) :]


def beyond_first_order(observed: Observed, about: Sequence[EffectEntry]) -> Array:
    """What entries beside the arm's move the tip by beyond first order about the state observed, (N, D), m."""
    if not about:
        return np.zeros((observed.rows, observed.components))
    arm, asked = observed.arm, observed.asked
    arm_effects = active_effects(arm)
    whole = (*arm_effects, *_entries(arm, about))
    with_them, without = (
        shape_of(with_effects(observed.nominal, arm, softening_of(observed.nominal, arm), weights), effects, asked)
        for effects, weights in ((whole, about), (arm_effects, ()))
    )
    first, turn, level = _to_first_order(observed.state, arm, about, asked)
    if observed.view is None:
        return (with_them.tip - without.tip - first)[:, : observed.components]
    turned = [None, None]
    if _turns_with_tool(observed.recording):
        turned, level = [with_them.turn, without.turn], turn
    if asked.levels is not None:
        turned = [levels_of(shape, effects, asked) for shape, effects in ((with_them, whole), (without, arm_effects))]
    beyond = observed.view.change(with_them.tip, turned[0]) - observed.view.change(without.tip, turned[1])
    return beyond - observed.view.of_tip(first, level)


def _turns_with_tool(recording: Recording) -> bool:
    """Whether what is read changes with how the tool is turned."""
    return turns_with(recording.slots) == "tool"


def _mean(points: Array) -> tuple[float, float, float]:
    middle = points.mean(axis=0)
    return (float(middle[0]), float(middle[1]), float(middle[2]))


def _columns(array: Array) -> tuple[Array, Array, Array]:
    return (array[:, 0], array[:, 1], array[:, 2])
