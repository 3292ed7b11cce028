"""The displacements of an effect on a few chains, checked against its declarations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

import casadi as ca
import numpy as np

from linkwright.core.arm.chain.statics import PoseState
from linkwright.core.arm.effects.effect import Disc, Effect, Interval, Settings, Twist
from linkwright.core.sections.numeric import Array

from .chains import ROWS, TOLERANCE, Chain, chains, faults_on

Moved = dict[tuple[str, int], tuple[Any, ...]]
"""Displacement and rotation (six components) put in at each node."""


def behaviour_faults(effect: Effect) -> list[str]:
    """What is wrong with an effect's physics, as phrases; each is said once, for the first chain that shows it."""
    tried = chains()
    return faults_on(tried, partial(_faults, effect), _where) or list(_idle_sizes(effect, tried))


def _where(chain: Chain) -> str:
    return f"the chain in {'the plane' if chain.arm.planar() else 'space'} ({chain.arm.angles} angles)"


def _faults(effect: Effect, chain: Chain) -> Iterator[str]:
    readings = chain.readings()
    usual = _values(effect)
    strange = list(_strange(effect, chain, usual))
    yield from strange
    if strange:
        return
    whole = _table(_moved(effect, readings, usual))
    if not all(np.isfinite(part).all() for part in whole.values()):
        yield "gives values that are not finite"
        return
    yield from _breaches(effect, chain, readings, usual, whole)
    # A lag asks for the readings before: one alone knows nothing of it.
    alone = {**usual, **{shape.name: shape.default for shape in effect.shapes if "time" in shape.requires}}
    every = _table(_moved(effect, readings, alone))
    for row in range(ROWS):
        one = _table(_moved(effect, chain.reading(row), alone), 1)
        if not _alike(one, {node: part[:, row : row + 1] for node, part in every.items()}):
            yield "gives other values for floats than for arrays"
            break
    yield from _symbolic(effect, chain, usual)


def _breaches(
    effect: Effect, chain: Chain, readings: PoseState, usual: dict[str, float], whole: Mapping[tuple[str, int], Array]
) -> Iterator[str]:
    """Where an effect does not keep what it promises; `whole` is what it does by its `usual` values."""
    if effect.sizes and _moves(effect, readings, {**usual, **{size.name: 0.0 for size in effect.sizes}}):
        yield "moves something at a size of 0"
    if effect.linear and effect.sizes:
        twice = _table(_moved(effect, readings, {**usual, **{s.name: 2.0 * usual[s.name] for s in effect.sizes}}))
        if not _alike(twice, {node: 2.0 * part for node, part in whole.items()}):
            yield "is not linear in its sizes, though it promises so"
    for index, joint in enumerate(chain.arm.joints if effect.place in ("joint", "link") else ()):
        if not effect.can_act(index, revolute=joint.revolute) and _moves(effect, readings, usual, (index,)):
            yield f"moves something where it cannot act ({effect.only})"
    for condition in effect.requires:
        if _moves(effect, chain.readings(condition), usual):
            yield f"moves something without {condition}, which it requires"


def _values(effect: Effect) -> dict[str, float]:
    """The upper end of what is typical for every size and shape."""
    return {size.name: size.typical[1] for size in (*effect.sizes, *effect.shapes)}


def _settings(values: Mapping[str, float], at: tuple[int, ...] = ()) -> Settings:
    return Settings(at, MappingProxyType(dict(values)))


def _strange(effect: Effect, chain: Chain, values: Mapping[str, float]) -> Iterator[str]:
    """What is neither twist nor play, or stands at no node of the chain."""
    state, settings = chain.readings(), _settings({**values, **_given(effect)})
    twists = [*effect.twists(state, settings), *effect.play.seated(state, settings)]
    for play in effect.play.free(chain.design(0), settings):
        if isinstance(play, Interval):
            twists += play.twists
            if not play.twists:
                yield "has an interval of play without a twist"
        elif not isinstance(play, Disc):  # pyright: ignore[reportUnnecessaryIsInstance]
            yield f"has play that is neither Interval nor Disc: {play!r}"
        elif not play.radius >= 0.0 or not 0 <= play.index < chain.arm.size:
            yield "has a disc of play of negative radius, or at no joint"
    for twist in twists:
        if not isinstance(twist, Twist):  # pyright: ignore[reportUnnecessaryIsInstance]
            yield f"gives what is no Twist: {twist!r}"
        elif twist.node not in ("base", "joint", "link", "tip"):
            yield f"has a twist at the node {twist.node!r}; base, joint, link, tip would do"
        elif not 0 <= twist.index < chain.arm.size:
            yield f"has a twist at {twist.node} {twist.index}, which the chain does not have"


def _given(effect: Effect) -> dict[str, float]:
    return {
        parameter.name: parameter.typical[1]
        for parameter in effect.parameters
        if parameter.role == "given" and not effect.sizes
    }


def _moved(effect: Effect, state: PoseState, values: Mapping[str, float], at: tuple[int, ...] = ()) -> Moved:
    settings = _settings(values, at)
    return _gathered([*effect.twists(state, settings), *effect.play.seated(state, settings)])


def _gathered(twists: Iterable[Twist]) -> Moved:
    moved: Moved = {}
    for twist in twists:
        node = (twist.node, twist.index)
        parts = (*twist.translation, *twist.rotation)
        moved[node] = tuple(a + b for a, b in zip(moved[node], parts, strict=True)) if node in moved else parts
    return moved


def _table(moved: Moved, rows: int = ROWS) -> dict[tuple[str, int], Array]:
    """Each node's components as numbers (6, rows)."""
    return {
        node: np.stack([np.broadcast_to(np.asarray(part, dtype=float), (rows,)) for part in parts])
        for node, parts in moved.items()
    }


def _moves(effect: Effect, state: PoseState, values: Mapping[str, float], at: tuple[int, ...] = ()) -> bool:
    return any(part.any() for part in _table(_moved(effect, state, values, at)).values())


def _alike(some: Mapping[tuple[str, int], Array], others: Mapping[tuple[str, int], Array]) -> bool:
    """Whether both move every node alike, to rounding; what is missing moves nothing."""
    for node in {*some, *others}:
        one, other = some.get(node, np.zeros(1)), others.get(node, np.zeros(1))
        size = max(float(np.max(np.abs(one))), float(np.max(np.abs(other))))
        if not np.all(np.abs(one - other) <= TOLERANCE * size):
            return False
    return True


def _symbolic(effect: Effect, chain: Chain, values: Mapping[str, float]) -> Iterator[str]:
    """A design's twists and intervals in CasADi's symbols, against those in floats."""
    settings = _settings({**values, **_given(effect)})

    def parts(state: PoseState) -> list[Any]:
        play = [item.twists if isinstance(item, Interval) else () for item in effect.play.free(state, settings)]
        twists = [*effect.twists(state, settings), *(twist for item in play for twist in item)]
        moved = _gathered(twists)
        return [part for node in sorted(moved) for part in moved[node]]

    q, state = chain.symbolic()
    made = parts(state)
    function = ca.Function("moved", [q], [ca.vertcat(*map(ca.SX, made)) if made else ca.SX(0, 1)])
    for row in range(ROWS):
        expected = np.array([float(part) for part in parts(chain.design(row))])
        given = np.array(function(chain.q[row])).ravel()
        scale = float(np.max(np.abs(expected), initial=0.0))
        if given.shape != expected.shape or not np.all(np.abs(given - expected) <= TOLERANCE * scale):
            yield "gives other values for CasADi's symbols than for floats"
            return


def _idle_sizes(effect: Effect, tried: Iterable[Chain]) -> Iterator[str]:
    shapes = {shape.name: shape.typical[1] for shape in effect.shapes}
    states = [chain.readings() for chain in tried]
    for size in effect.sizes:
        if not any(_moves(effect, state, {**shapes, size.name: size.typical[1]}) for state in states):
            yield f"the size {size.name} moves nothing, on no chain"
