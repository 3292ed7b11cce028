"""How much of a cause a recording can show: its signal to noise once geometry, or all that the library could say, is
projected out."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from benchmarks.blind.aliases import flat, orthonormal, without
from benchmarks.blind.generator.vectors import Array
from benchmarks.multibody.causes import KINDS, Cause, Stage
from benchmarks.multibody.session import Plan, played
from benchmarks.multibody.unknowns.unknown import Unknown

Write = Callable[[Plan], None]


def change(stage: Stage, write: Write) -> Array:
    """What one cause alone changes of the readings, (3, v), m."""
    plan = Plan(stage.machine, stage.session)
    write(plan)
    return played(plan).reading - stage.tips.reading


def _columns(stage: Stage, coordinates: list[int]) -> list[Array]:
    """How the tip moves with each of some coordinates, flat."""
    planar = stage.machine.arm.planar
    moves = np.stack([rest.jacobian[:, coordinates] for rest in stage.tips.rests], axis=1)  # (3, v, k)
    return [flat(moves[:, :, k], planar) for k in range(len(coordinates))]


def frame_columns(stage: Stage, tool: bool) -> list[Array]:
    """Each mounting's shifts and turns of the frame, and where the target sits if that is free."""
    body, planar = stage.machine, stage.machine.arm.planar
    mounts = np.array(stage.session.mount)
    results = []
    for number in range(max(stage.session.mount) + 1):
        there = np.tile((mounts == number).astype(float), 2 if planar else 3)
        results += [column * there for column in _columns(stage, list(body.base))]
    return results + (_columns(stage, list(body.tool)) if tool else [])


def geometry_columns(stage: Stage) -> list[Array]:
    """Frame, encoders' zeros, lengths and the target's place."""
    body = stage.machine
    return [*frame_columns(stage, tool=True), *_columns(stage, [*body.drive, *body.stretch])]


def basis(columns: list[Array]) -> Array:
    """Orthonormal columns of their span, relative rank tolerance 1e-6."""
    return orthonormal(np.stack(columns, axis=1), 1e-12, 1e-6) if columns else np.zeros((0, 0))


def nuisance(stage: Stage, *, geometric: bool, frame_free: bool, tool_free: bool) -> Array:
    """What is projected out of a cause: all geometry, or only what is declared free where it is geometry itself."""
    if not geometric:
        return basis(geometry_columns(stage))
    return basis(frame_columns(stage, tool_free) if frame_free else [])


def rms(vector: Array, visits: int) -> float:
    """RMS length a reading, m."""
    return math.sqrt(float(vector @ vector) / visits)


def library_spans(stage: Stage) -> list[list[Array]]:
    """What the field's usual causes, one by one, could do to the tip here: each with its shapes' usual freedom."""
    body, session, planar = stage.machine, stage.session, stage.machine.arm.planar
    axes, visits = (2 if planar else 3), session.visits
    warm = [session.warming(lag) for lag in (0.0, 3600.0)]
    time = session.time / max(float(session.time[-1]), 1.0)
    load = stage.tips.load
    spans = [*_of_drives(stage, warm), *_of_links(stage, warm)]
    for place, about in zip(body.base[3:], _columns(stage, list(body.base[3:])), strict=True):
        spans.append(_times(about, load[place]))
    spans.append([c * np.tile(time, axes) for c in _columns(stage, list(body.base))])
    spans.append([flat(stage.tips.reading, planar)])
    if not planar:
        # Askew and aside: an axis that is off has both (Mooring, Roth & Driels, 1991).
        spans += [_columns(stage, [*body.tilt[i], *body.seat[i]]) for i in range(1, body.arm.count)]
    for effect, at, values in _loads(stage):
        cause = Cause(effect, at, values, ())
        spans.append([flat(change(stage, cause.write), planar)])
    return [span for span in spans if max(float(np.abs(c).max()) for c in span) > 0.0 and visits > 0]


def _times(column: Array, *functions: Array) -> list[Array]:
    """A column times functions of the visits."""
    return [column * np.tile(f, column.size // f.size) for f in functions]


def _of_drives(stage: Stage, warm: list[Array]) -> list[list[Array]]:
    """What is wrong at joints, as functions of their coordinates, loads, sides and warmth."""
    body, session, load = stage.machine, stage.session, stage.tips.load
    spans: list[list[Array]] = []
    for i, column in enumerate(_columns(stage, list(body.drive))):
        q, torque, side = session.q[i], load[body.drive[i]], session.side[i]
        spans.append(_times(column, q, np.sin(q), np.cos(q)))
        spans += [_times(column, np.sin(order * q), np.cos(order * q)) for order in range(2, 9)]
        if i:
            spans.append(_times(column, session.q[i - 1]))
        phi = session.q[: i + 1].sum(axis=0)
        spans += [_times(column, np.sin(phi), np.cos(phi)), _times(column, torque), _times(column, np.sign(torque))]
        top = max(float(np.abs(torque).max()), 1e-9)
        spans += [_times(column, np.tanh(torque / (share * top))) for share in (0.15, 0.3, 0.6)]
        spans.append(_times(column, side, side * np.abs(torque)))
        spans.append(_times(column, torque * session.loaded_for))
        spans += [_times(column, item) for item in warm]
    return spans


def _of_links(stage: Stage, warm: list[Array]) -> list[list[Array]]:
    """What links do that grow as they warm and give under their loads."""
    body, load, planar = stage.machine, stage.tips.load, stage.machine.arm.planar
    spans: list[list[Array]] = []
    for i, column in enumerate(_columns(stage, list(body.stretch))):
        spans += [_times(column, item) for item in warm]
        given = [k for node in body.nodes[i] for k in node]
        if given:
            moved = np.stack([rest.jacobian[:, given] for rest in stage.tips.rests], axis=1)
            spans.append([flat(np.einsum("avk,kv,k->av", moved, load[given], body.compliance[given]), planar)])
    return spans


def _loads(stage: Stage) -> list[tuple[str, tuple[int, ...], dict[str, float]]]:
    arm = stage.machine.arm
    tilts = ("about_z",) if arm.planar else ("about_x", "about_y")
    links = [("link_mass", (i + 1,), {"mass": 0.5}) for i in range(arm.count)]
    return [("payload", (), {"mass": 0.5}), *links, *(("base_tilt", (), {tilt: 1e-2}) for tilt in tilts)]


def beyond_library(vector: Array, spans: list[list[Array]], geometry: Array, groups: int = 3) -> Array:
    """What is left of a change beside geometry and the `groups` causes that describe most of it, one by one."""
    taken, left = geometry, without(vector, geometry)
    for _ in range(groups):
        best: tuple[float, Array | None] = (0.0, None)
        for span in spans:
            own = basis([without(column, taken) for column in span])
            won = float(np.linalg.norm(own.T @ left)) if own.size else 0.0
            if won > best[0]:
                best = (won, own)
        if best[1] is None:
            break
        taken, left = np.hstack([taken, best[1]]), without(left, best[1])
    return left


def dosed(
    cause: Cause, stage: Stage, wanted: float, *, frame_free: bool, tool_free: bool
) -> tuple[Cause, float, Array] | None:
    """The cause at a visible RMS of `wanted` (m), as nearly as plausible sizes allow: it, its RMS, and what is left of
    its change. None where geometry hides nearly all of it, or where no plausible size comes within a factor of two."""
    kind, planar, visits = KINDS[cause.effect], stage.machine.arm.planar, stage.session.visits
    hidden = nuisance(stage, geometric=kind.geometric, frame_free=frame_free, tool_free=tool_free)
    for _ in range(2):
        whole = flat(change(stage, cause.write), planar)
        left = rms(without(whole, hidden), visits)
        if left < 1e-9 or left < 0.03 * rms(whole, visits):
            return None
        size = max(abs(cause.parameters[name]) for name in cause.scaled)
        cause = cause.dosed(min(wanted / left, kind.greatest / size))
    vector = without(flat(change(stage, cause.write), planar), hidden)
    reached = rms(vector, visits)
    return (cause, reached, vector) if 0.5 < reached / wanted < 2.0 else None


def sized(
    unknown: Unknown, stage: Stage, wanted: float, spans: list[list[Array]], geometry: Array
) -> tuple[float, float, float] | None:
    """The size at which what the library cannot say of an unknown has an RMS of `wanted` (m), that RMS, and the RMS
    beside geometry alone. None where the library can say nearly all of it, or where it would move the tip by more than
    10 mm."""
    planar, visits = stage.machine.arm.planar, stage.session.visits
    size = 1.0
    for last in (False, False, True):
        whole = flat(change(stage, partial(unknown.act, size=size)), planar)
        left = rms(beyond_library(whole, spans, geometry), visits)
        if left < 1e-9 or left < 0.05 * rms(without(whole, geometry), visits) or rms(whole, visits) > 0.01:
            return None
        if last:
            return (size, left, rms(without(whole, geometry), visits)) if 0.5 < left / wanted < 2.0 else None
        size *= min(max(wanted / left, 1e-3), 50.0)
    return None
