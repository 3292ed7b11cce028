"""Everything that the library could add to the model, as patterns over a recording's readings.

A candidate is an effect at a place (one joint or link, or all that share it) with its shapes fixed; its columns are the
displacements for one unit of each of its sizes. Shapes (a lag, a threshold, an order) make variants of one candidate.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS, Effect, Parameter, Readings, Settings, kind_at
from linkwright.core.arm.effects.effect import Condition
from linkwright.core.arm.effects.loads.added_weights import bearing
from linkwright.core.arm.files.read import acts_on_slides
from linkwright.core.diagnose.residual.observed import Observed
from linkwright.core.sections.numeric import Array

from .unknown_weights import columns_under_weights, only_products

_STEP = 1e-3
"""Sizes are tried at this share of their typical upper end: small enough for what is linear to first order only."""


_ALIKE = 1e-6
"""Patterns that differ by so small a share differ by rounding."""

Family = tuple[str, tuple[int, ...], bool, int | None]


@dataclass(frozen=True)
class Candidate:
    """An effect at places (from 0) with its shapes (SI), or a form outside the library (`effect` then is its name).

    `sizes` names the parameter of each column; `shared` says that one parameter serves all places. `share` marks
    physics that the arm file has data for but leaves out: its one column is the whole effect, and its size should come
    out as 1. `only` is the one of several recordings (from 0) in which it acts: what it has more there than in the
    others. None: it acts in all alike.
    """

    effect: str
    at: tuple[int, ...]
    sizes: tuple[str, ...]
    shapes: Mapping[str, float]
    shared: bool = False
    share: bool = False
    outside: bool = False
    only: int | None = None

    @property
    def family(self) -> Family:
        """What variants of one candidate have in common."""
        return (self.effect, self.at, self.share, self.only)

    @property
    def variant(self) -> tuple[Family, tuple[str, ...], tuple[tuple[str, float], ...]]:
        """What tells it from the others of its family: its sizes and its shapes."""
        return (self.family, self.sizes, tuple(self.shapes.items()))

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers, from 1, of the joints or links where it acts."""
        return tuple(index + 1 for index in self.at)

    @property
    def free_shapes(self) -> tuple[str, ...]:
        """The shapes that may take any value between those of the grid."""
        if self.outside:
            return tuple(name for name in self.shapes if name == "core" or name.startswith("at_"))
        return tuple(name for name, value in self.shapes.items() if name not in self.whole_shapes and value > 0.0)

    @property
    def whole_shapes(self) -> tuple[str, ...]:
        """The shapes that are whole numbers and stay on their grid."""
        known = () if self.outside else EFFECTS[self.effect].shapes
        return tuple(parameter.name for parameter in known if parameter.whole)

    @property
    def of_drives(self) -> bool:
        """Whether it is how drives give (see `arm.effects.Effect`)."""
        return not self.outside and EFFECTS[self.effect].drive.gives

    def from_slopes(self, slopes: Sequence[float]) -> list[float]:
        """The sizes that move the tip as much as these of the pattern of small ones, to which a linear fit scales it.
        Products with unknown weights, more than there are sizes, stay as they are."""
        turned = None if self.outside else EFFECTS[self.effect].recording.size_from_slope
        return [value if turned is None or len(slopes) != len(self.sizes) else turned(value) for value in slopes]

    def settings(self, values: Mapping[str, float]) -> Settings:
        """The effect's settings at sizes of these values."""
        return Settings(self.at, MappingProxyType({**self.shapes, **values}))


def of_single_numbers(effect: Effect) -> bool:
    """Whether an effect is geometry of which every number at a joint or link says something by itself: a zero, a
    length."""
    sizes = [parameter for parameter in effect.sizes if not parameter.of_all]
    at_one = effect.place in ("joint", "link") and effect.cause == "geometry" and effect.linear
    return at_one and not effect.shapes and (len(sizes) == 1 or all(parameter.optional for parameter in sizes))


def candidates(observed: Observed, without: frozenset[str] = frozenset()) -> Iterator[tuple[Candidate, Array]]:
    """Every candidate of the library with its columns (N, C, d); those that move nothing are left out.

    `without` takes effects out by id.
    """
    for effect in EFFECTS.values():
        if effect.id in without:
            continue
        for candidate in _of_effect(observed, effect):
            columns = columns_of(observed, candidate)
            if columns is None:
                continue
            moving = np.asarray(columns.any(axis=(0, 1)))
            if columns.shape[2] == len(candidate.sizes) and not moving.all():
                # In the plane a shift out of it, say, moves nothing: no size of this candidate.
                sizes = tuple(name for name, moves in zip(candidate.sizes, moving.tolist(), strict=True) if moves)
                candidate, columns = replace(candidate, sizes=sizes), columns[:, :, moving]
            if effect.place == "tip" and _of_several_tips(observed):
                yield from _in_each(observed, candidate, columns)
                continue
            if _only_the_sum_shows(effect, candidate, columns):
                continue
            yield candidate, columns
            yield from _in_one(observed, candidate, columns)


def _only_the_sum_shows(effect: Effect, candidate: Candidate, columns: Array) -> bool:
    """Whether sizes move the tip alike at every reading, so that but their sum shows, for which one of them stands."""
    if effect.recording.told_as is None or len(candidate.sizes) < 2:
        return False
    flat = columns.reshape(-1, columns.shape[2])
    singular = np.linalg.svd(flat / np.linalg.norm(flat, axis=0), compute_uv=False)
    return bool(singular[-1] < _ALIKE * singular[0])


def _in_one(observed: Observed, candidate: Candidate, columns: Array) -> Iterator[tuple[Candidate, Array]]:
    """A candidate in each of several recordings but the first alone, where it need not be the same in all."""
    recording, effect = observed.recording, EFFECTS[candidate.effect]
    plain = effect.linear and not (candidate.share or candidate.shared or only_products(observed, effect, candidate.at))
    if not plain or (effect.watch.lasts == "the arm" and not recording.units):
        return
    for index in range(1, len(recording.singles)):
        columns_here = of_one(observed, columns, index)
        # What a branch has may show in one recording alone, which is no difference between them.
        if columns_here.any() and not (observed.arm.branches and np.array_equal(columns_here, columns)):
            yield replace(candidate, only=index), columns_here


def _of_several_tips(observed: Observed) -> bool:
    """Whether the recordings are of several arms on one torso."""
    return len({item.branch for item in observed.recording.singles}) > 1


def _in_each(observed: Observed, candidate: Candidate, columns: Array) -> Iterator[tuple[Candidate, Array]]:
    """What a tip has of its own, in each of several recordings alone."""
    for index in range(len(observed.recording.singles)):
        columns_here = of_one(observed, columns, index)
        if columns_here.any():
            yield replace(candidate, only=index), columns_here


def of_one(observed: Observed, columns: Array, only: int | None) -> Array:
    """Columns (N, C, d) in the readings of one of several recordings (from 0) alone; as they are where
    none is named."""
    if only is None:
        return columns
    rows = observed.which == only
    columns_here = np.zeros(columns.shape)  # the rows of the others are never touched, so that they take no memory
    columns_here[rows] = columns[rows]
    return columns_here


def columns_of(observed: Observed, candidate: Candidate) -> Array | None:
    """A candidate's columns (N, C, d) for one unit of each size, m and rad; None where it moves nothing."""
    effect = EFFECTS[candidate.effect]
    if candidate.share:
        pattern = observed.signature(effect.id, Settings())
        return pattern[:, :, None] if pattern.any() else None
    if only_products(observed, effect, candidate.at):
        columns = columns_under_weights(observed, effect.id, candidate.at)
        return columns if columns.any() else None
    parts: list[Array] = []
    for name in candidate.sizes:
        parameter = parameter_of(effect, name)
        step = _STEP * max(abs(parameter.typical[0]), abs(parameter.typical[1]))
        parts.append(observed.signature(effect.id, candidate.settings({name: step})) / step)
    # One size's column is one piece of memory.
    columns = of_one(observed, np.moveaxis(np.stack(parts), 0, 2), candidate.only)
    return columns if columns.any() else None


def parameter_of(effect: Effect, name: str) -> Parameter:
    """An effect's parameter by name."""
    return next(parameter for parameter in effect.parameters if parameter.name == name)


def kind_of(arm: Arm, candidate: Candidate, name: str) -> str:
    """The kind of quantity that a candidate's parameter is in this arm, by name (see `units.quantities`)."""
    if candidate.share:
        return "dimensionless"
    effect = EFFECTS[candidate.effect]
    slides = acts_on_slides(effect, candidate.numbers, arm.joints)
    return kind_at(parameter_of(effect, name), slides=slides)


def _of_effect(observed: Observed, effect: Effect) -> Iterator[Candidate]:
    if effect.automatic and effect.id in observed.arm.leave_out:
        acting = tuple(i for i in _places(observed, effect) if observed.signature(effect.id, Settings((i,))).any())
        yield Candidate(effect.id, acting, ("share",), MappingProxyType({}), share=True)
    if not any(_held(observed, parameter.requires) for parameter in effect.sizes):
        return
    for at, shapes in itertools.product(_where(observed, effect), _variants(effect)):
        shapes_here = {
            parameter.name: value * _load_scale(observed, at) if parameter.relative_to_load else value
            for parameter, value in shapes
        }
        if not _needs_met(observed, effect, at, shapes_here):
            continue
        for sizes in _sizes(observed, effect, at):
            yield Candidate(effect.id, at, sizes, MappingProxyType(shapes_here), shared=len(at) > 1)


def _where(observed: Observed, effect: Effect) -> list[tuple[int, ...]]:
    """The places of an effect: each by itself, and all together where one parameter may serve them all."""
    if effect.place in ("base", "tip"):
        return [()]
    joints = enumerate(observed.arm.joints)
    everywhere = [k for k, item in joints if effect.can_act(k, revolute=item.revolute, passive=item.passive)]
    return [*((k,) for k in everywhere), *([tuple(everywhere)] if effect.together and len(everywhere) > 1 else [])]


def _variants(effect: Effect) -> Iterator[tuple[tuple[Parameter, float], ...]]:
    """The values that an effect's shapes may have together."""
    shaped = [parameter for parameter in effect.parameters if parameter.role == "shape" and parameter.grid]
    return itertools.product(*([(parameter, value) for value in parameter.grid] for parameter in shaped))


def _sizes(observed: Observed, effect: Effect, at: tuple[int, ...]) -> Iterator[tuple[str, ...]]:
    """The sizes that are fitted together: all that the recording shows, and those without which there is no effect."""
    here = effect.sizes_here(observed.arm, at)
    sizes = tuple(parameter.name for parameter in here if _held(observed, parameter.requires))
    if only_products(observed, effect, at):
        # About its z a base does not turn under weights.
        sizes = sizes[:1]
    needed = tuple(name for name in sizes if not parameter_of(effect, name).optional)
    fewer = [needed] if needed else [(name,) for name in sizes]
    return iter([sizes, *(item for item in fewer if item != sizes)])


def _needs_met(observed: Observed, effect: Effect, at: tuple[int, ...], shapes: Mapping[str, float]) -> bool:
    """Whether the recording holds what a variant asks for; else it would move nothing, or repeat another variant."""
    above = [parameter for parameter in effect.shapes if shapes.get(parameter.name, 0.0) > 0.0]
    conditions: list[Condition] = [
        *effect.requires,
        *(condition for parameter in above for condition in parameter.requires),
    ]
    if not _held(observed, conditions):
        return False
    if (
        effect.recording.least_travel > 0.0
        and float(np.ptp(observed.recording.q[:, at[0]])) < effect.recording.least_travel
    ):
        return False
    return effect.recording.shown_by(
        Readings(observed.state, observed.recording.q, observed.recording.time), at, shapes
    )


def _held(observed: Observed, conditions: Sequence[Condition]) -> bool:
    """Whether the recording holds all these conditions."""
    return all(getattr(observed.state.conditions, condition) is not None for condition in conditions)


def _places(observed: Observed, effect: Effect) -> tuple[int, ...]:
    return () if effect.place in ("base", "tip") else tuple(range(observed.arm.size))


def _load_scale(observed: Observed, at: tuple[int, ...]) -> float:
    """The greatest load (N*m, N) on the drives at these places; one where they carry none."""
    joints = bearing(observed.state).joints
    joints = [joints[index] for index in at] if at else list(joints)
    return max(float(np.max(np.abs(joint.drive_load))) for joint in joints) or 1.0
