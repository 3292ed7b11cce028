"""Groups of a motion diagnosis: what makes columns, and the candidate causes that are put together of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from linkwright.core.arm.chain.chain import Arm
from linkwright.core.arm.effects import EFFECTS
from linkwright.core.arm.effects.drives.armature import ARMATURE
from linkwright.core.arm.effects.drives.torque_offset import TORQUE_OFFSET
from linkwright.core.arm.effects.effect import Effect, Parameter, Settings
from linkwright.core.arm.effects.elastic.joint_compliance import drive_compliance
from linkwright.core.arm.effects.friction.friction_coulomb import FRICTION_COULOMB
from linkwright.core.arm.effects.friction.friction_viscous import FRICTION_VISCOUS
from linkwright.core.arm.effects.loads.inertial import OfInertia
from linkwright.core.arm.effects.torques import Bent, OfEachDrive, direction
from linkwright.core.arm.motion.motion import Motion
from linkwright.core.arm.motion.rigid import PARAMETERS
from linkwright.core.diagnose.rules.rules import Rules
from linkwright.core.sections.numeric import Array

_OF_ALL_ROBOTS = ("dimensionless", "time")
"""Kinds of quantity that do not grow with the robot."""
PLAIN = (FRICTION_COULOMB, FRICTION_VISCOUS, TORQUE_OFFSET, ARMATURE)
"""What every drive has: W. Khalil & E. Dombre, Modeling, Identification and Control of Robots (2002), ch. 12."""


def _sharper(motion: Motion, values: Mapping[str, float], joint: int) -> Array:
    speed = motion.velocity[:, joint]
    return values.get("torque", 0.0) * (np.sign(speed) - direction(speed))


SHARPER = Effect(
    id="sharper_sign",
    title="friction whose sign changes faster, or slower, than the model's",
    formula="f (sign(q') - smoothed sign(q'))",
    place="joint",
    cause="friction in motion",
    needs="",
    aliases=(),
    source="",
    parameters=(Parameter("torque", "torque", "", -1e4, 1e4, (0.1, 20.0), "", role="torque"),),
    torques=OfEachDrive(_sharper),
    linear=True,
)
"""How sharp the sign of a speed that is read from coordinates is, nobody knows. Fitted beside the rest; no cause."""


@dataclass(frozen=True)
class Source:
    """What makes columns: an effect at a place (joints or links from 0; empty: base or tip) with values of its shapes.
    Its `sizes` are the columns `start` and following of the whole model. `by_load`: it acts in proportion to the torque
    that a drive gives, and changes with the model. `joints` (from 0) are those whose torque it changes. Sizes `usual`
    (d,) are common."""

    effect: Effect
    at: tuple[int, ...]
    shapes: Mapping[str, float]
    sizes: tuple[Parameter, ...]
    start: int
    by_load: bool
    joints: tuple[int, ...] = ()
    usual: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def delays(self) -> bool:
        """Whether it shifts the torque in time: what is of the instrument and measured as a time."""
        return self.effect.recording.of_instrument and [size.kind for size in self.sizes] == ["time"]

    @property
    def columns(self) -> NDArray[np.int64]:
        """Its columns in the whole model."""
        return np.arange(self.start, self.start + len(self.sizes))

    @property
    def place(self) -> tuple[str, tuple[int, ...]]:
        """Its effect and where it acts, whatever its shapes."""
        return self.effect.id, self.at

    @property
    def bent(self) -> bool:
        """Whether its torque is not in proportion to its size."""
        return isinstance(self.effect.torques, Bent)

    def torques(self, motion: Motion, by_parameter: Array | None = None, about: float = 0.0) -> dict[int, Array]:
        """What one unit of each size takes of the drives: by joint (N, d). `by_parameter` is the motion's regressor (N,
        n, 10 n) where it is at hand, for what changes the links' inertial parameters. What is not in proportion to its
        size is taken as it is at the size `about`, by its slope where that is nothing."""
        assert self.effect.torques is not None
        if isinstance(self.effect.torques, Bent):
            settings = Settings(self.at, {**self.shapes, self.sizes[0].name: about})
            each = self.effect.torques(motion, settings) if about else self.effect.torques.slope(motion, settings)
            return {joint: column[:, None] / (about or 1.0) for joint, column in each.items()}
        if by_parameter is not None and isinstance(self.effect.torques, OfInertia):
            units = [Settings(self.at, {**self.shapes, size.name: 1.0}) for size in self.sizes]
            each = [self.effect.torques.parameters(motion.arm, unit).reshape(-1) for unit in units]
            whole = by_parameter @ np.stack(each, axis=1)
            return {joint: whole[:, joint] for joint in self.joints}
        torques: dict[int, Array] = {}
        for number, size in enumerate(self.sizes):
            values = {**self.shapes, size.name: 1.0}
            for joint, torque in self.effect.torques(motion, Settings(self.at, values)).items():
                if joint not in torques:
                    torques[joint] = np.zeros((motion.size, len(self.sizes)))
                torques[joint][:, number] = torque
        return torques


@dataclass(frozen=True)
class Body:
    """The `link` (from 0) that inertial numbers change: `had` (10,) are its parameters by the arm file, `units` (10,
    10) those of one unit of each of the effect's numbers, of which a group holds the `shown` ones."""

    link: int
    had: Array
    units: Array
    shown: NDArray[np.int64]


@dataclass(frozen=True)
class Group:
    """A candidate cause: `mixing` (k, d) turns its d numbers into sizes of the model's columns `columns` (k,).

    `usual` (d,) is the size that is common of each number, `bounds` (2, d) what it cannot pass, in SI; `sizes` are the
    parameters of its numbers, `labels` (k,) the place and parameter of each column. `at` are joints or links from 1,
    `family` what only one variant may be taken of, `variants` how many the family has. `tied`: one number for all
    places. What changes a link's ten parameters has a `body`. A `nuisance` is fitted with the rest and never named.
    It counts only as far as it explains more than the plain terms `beside` it of the joints that it moves.
    """

    effect: Effect
    at: tuple[int, ...]
    shapes: Mapping[str, float]
    columns: NDArray[np.int64]
    mixing: Array
    usual: Array
    bounds: Array
    sizes: tuple[Parameter, ...]
    labels: tuple[tuple[tuple[int, ...], str], ...]
    family: tuple[str, tuple[int, ...]]
    variants: int
    tied: bool = False
    nuisance: bool = False
    body: Body | None = None
    beside: tuple[Effect, ...] = ()

    @property
    def plain(self) -> bool:
        """Whether it is a term that every drive has."""
        return self.effect in PLAIN and not self.tied

    @property
    def rank(self) -> int:
        """How many numbers it has."""
        return self.mixing.shape[1]

    def values(self, numbers: Array) -> Array:
        """The sizes of its columns by its numbers."""
        return self.mixing @ numbers


def groups_of(sources: Sequence[Source], arm: Arm, masses: Array, clock: float, rules: Rules) -> list[Group]:
    """The candidates of sources, each alone and what has a number in common together; `masses` (n, 10) are the links'
    inertial parameters by the arm file, `clock` s by which torques may be late without being a delay."""
    variants = Counter(source.place for source in sources)
    by_effect: dict[tuple[str, tuple[tuple[str, float], ...]], list[Source]] = {}
    groups: list[Group] = []
    for source in sources:
        by_effect.setdefault((source.effect.id, tuple(source.shapes.items())), []).append(source)
        alone = _alone(source, arm, masses, variants[source.place], rules)
        groups += [alone, _clock_beside(alone, clock)] if source.delays else [alone]
    tied = (_tied(alike, arm, masses, variants[alike[0].place], rules) for alike in by_effect.values())
    return [*groups, *(group for group in tied if group is not None)]


def _alone(source: Source, arm: Arm, masses: Array, variants: int, rules: Rules) -> Group:
    """The candidate of one source alone."""
    at = tuple(index + 1 for index in source.at)
    return Group(
        source.effect,
        at,
        source.shapes,
        source.columns,
        np.eye(len(source.sizes)),
        source.usual,
        _bounds(source, arm, rules.fitting.usual, alone=True),
        source.sizes,
        tuple((at, size.name) for size in source.sizes),
        (source.effect.id, at),
        variants,
        nuisance=source.effect is SHARPER,
        body=_body(source, arm, masses),
        beside=_plain(source),
    )


def _clock_beside(delay: Group, clock: float) -> Group:
    """By part of a sample torques may be late or early to coordinates: no delay, but how a log was written."""
    return replace(
        delay,
        shapes={},
        usual=np.array([clock / 3.0]),  # what is within its reach is within three standard deviations
        bounds=np.array([[-np.inf], [np.inf]]),
        family=("clock", delay.at),
        variants=1,
        nuisance=True,
        beside=(),
    )


def _tied(alike: Sequence[Source], arm: Arm, masses: Array, variants: int, rules: Rules) -> Group | None:
    """One candidate of an effect at all of its places together; None of what has no number in common."""
    first, effect = alike[0], alike[0].effect
    inertia = isinstance(effect.torques, OfInertia)
    if len(alike) < 2 or len(first.at) != 1:
        return None
    if effect.together or (effect.recording.of_instrument and first.by_load):
        usual, sizes, shapes = first.usual, first.sizes, first.shapes
        mixing = np.tile(np.eye(len(sizes)), (len(alike), 1))
        bounds = _bounds(first, arm, rules.fitting.usual)
    elif inertia and effect.place == "link":
        # All that the arm weighs by one factor: what nobody tells from all torque constants.
        held = [dict(zip(PARAMETERS, row.tolist(), strict=True)) for row in masses]
        mixing = np.array([[held[source.at[0]][size.name]] for source in alike for size in source.sizes])
        usual, shapes, variants = np.array([rules.motion.scaled]), {}, 1
        sizes = (Parameter("share", "dimensionless", "of all masses", -1.0, 1.0, (0.0, rules.motion.scaled), ""),)
        bounds = np.array([[-1.0], [1.0]]) * rules.fitting.usual * rules.motion.scaled
    else:
        return None
    at = tuple(source.at[0] + 1 for source in alike)
    columns = np.concatenate([source.columns for source in alike])
    labels = tuple(((source.at[0] + 1,), size.name) for source in alike for size in source.sizes)
    # One number by which all masses grow together stands in for no rotor.
    beside = () if inertia else _plain(first)
    named = (effect.id, at)
    return Group(
        effect, at, shapes, columns, mixing, usual, bounds, sizes, labels, named, variants, tied=True, beside=beside
    )


def _plain(source: Source) -> tuple[Effect, ...]:
    """What drives have anyway and a cause varies: bodies turn with rotors, all else that acts at a joint stands in for
    any of its plain terms."""
    if isinstance(source.effect.torques, OfInertia):
        return (ARMATURE,)
    return PLAIN if source.effect.place == "joint" and source.effect not in PLAIN else ()


def _body(source: Source, arm: Arm, masses: Array) -> Body | None:
    made = source.effect.torques
    if not isinstance(made, OfInertia):
        return None
    names = [size.name for size in source.effect.torque_sizes]
    parameters = [made.parameters(arm, Settings(source.at, {name: 1.0})) for name in names]
    link = source.at[0] if source.at else arm.size - 1
    had = masses[link].copy()
    for entry in arm.effects:
        more = EFFECTS[entry.effect].torques
        if isinstance(more, OfInertia):
            had += more.parameters(arm, Settings(tuple(at - 1 for at in entry.at), entry.parameters))[link]
    shown = np.array([names.index(size.name) for size in source.sizes], dtype=np.int64)
    return Body(link, had, np.stack([values_by_link[link] for values_by_link in parameters], axis=1), shown)


def _bounds(source: Source, arm: Arm, most_usual: float, *, alone: bool = False) -> Array:
    """What its sizes cannot pass (2, d), less what the arm file has of them already."""
    at = tuple(index + 1 for index in source.at)
    had = [0.0] * len(source.sizes)
    for entry in arm.effects:
        shaped_alike = all(entry.parameters.get(name) == value for name, value in source.shapes.items())
        if entry.effect == source.effect.id and shaped_alike and (not entry.at or set(at) <= set(entry.at)):
            more = (entry.parameters.get(size.name, 0.0) for size in source.sizes)
            had = [present + value for present, value in zip(had, more, strict=True)]
    limits: list[tuple[float, float]] = []
    for size, present in zip(source.sizes, had, strict=True):
        most = most_usual * max(map(abs, size.typical)) if size.kind in _OF_ALL_ROBOTS else np.inf
        if source.effect.drive.gives:  # with what the file has anyway no drive gives less than nothing
            present = drive_compliance(arm, source.at[0])
        least = 0.0 if source.effect.drive.gives else size.lower
        limits.append((max(least - present, -most), min(size.upper - present, most)))
    bounds = np.array(limits, dtype=float).reshape(-1, 2).T
    if alone and source.delays:
        # Encoders of one arm are read alike: no single drive's torque is logged before it is given.
        bounds[0] = 0.0
    return bounds
