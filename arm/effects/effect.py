"""What an effect is: a name, its parameters, what a recording must hold to show it, and the twists it puts in.

An effect displaces and turns the chain a little at some of its nodes; the chain carries that to the tip:
dp_tip = dp_i + dphi_i x (p_tip - p_i). Simulation, optimiser and diagnosis all use the same object.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from ..statics import PoseState
from ..vectors import ZERO, Scalar, Vector, scale

NodeKind = Literal["base", "joint", "link", "tip"]
"""The base's origin, a joint's axis, the far end of a link, or the tip."""

Condition = Literal["time", "warming", "sides", "velocities", "accelerations", "loaded_for"]
"""What an effect may ask of the conditions of a reading; the fields of `arm.conditions.Conditions`."""

Only = Literal["joints that turn", "joints that slide", "joints after the first"]
"""Which joints an effect can move, where not all."""

Role = Literal["size", "shape", "given"]
"""How a parameter enters: the displacement grows from nothing with a `size`; a `shape` (a lag, a threshold, an order)
changes its pattern and is searched on a grid; what is `given` comes with the arm and is not fitted."""


Cause = Literal["geometry", "flexibility", "loads", "play and friction", "angle errors", "warming", "measurement"]
"""What kind of thing is at work; effects of one cause are summed up together where there are many."""


@dataclass(frozen=True)
class Twist:
    """A small displacement (m) and rotation (rad), in the base frame, at joint or far end of link `index` (from 0)."""

    node: NodeKind
    index: int
    translation: Vector = ZERO
    rotation: Vector = ZERO


@dataclass(frozen=True)
class Interval:
    """Play along one motion: anything from -1 to 1 times `twists`. `seating` is the load that pushes it one way."""

    twists: tuple[Twist, ...]
    seating: Scalar


@dataclass(frozen=True)
class Disc:
    """Play within a disc of `radius` (m) normal to `normal` (unit), at joint `index`. `seating` is the load carried
    (N)."""

    index: int
    radius: float
    normal: Vector
    seating: Vector


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: its kind of quantity (see materials.quantities), bounds and typical size in SI, source.

    `role` says how a fit treats it (see `Role`), `grid` the values at which a search tries a shape; where the pattern
    depends on how large the loads are, `relative_to_load` makes them shares of the drive's greatest load. What moves a
    joint `across` its motion is of the same kind on slides. What is `of_all` is tried only where the effect acts
    everywhere together, and then instead of the other sizes. An `optional` size is tried as nought too.
    """

    name: str
    kind: str
    meaning: str
    lower: float
    upper: float
    typical: tuple[float, float]
    source: str
    role: Role = "given"
    grid: tuple[float, ...] = ()
    relative_to_load: bool = False
    across: bool = False
    of_all: bool = False
    optional: bool = False


@dataclass(frozen=True)
class Settings:
    """Where an effect acts (joints or links from 0; empty: everywhere) and the values of its parameters (SI)."""

    at: tuple[int, ...] = ()
    values: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))

    def acts_at(self, index: int) -> bool:
        """Whether the effect acts at joint or link `index` (from 0)."""
        return not self.at or index in self.at


_ON_SLIDES: Mapping[str, str] = MappingProxyType(
    {
        "angle": "length",
        "angle_per_temperature": "length_per_temperature",
        "compliance": "linear_compliance",
        "torque": "force",
        "torsional_stiffness": "linear_stiffness",
    }
)
"""The kinds of quantity of turning joints and what takes their place along a slide."""


def kind_at(parameter: Parameter, *, slides: bool) -> str:
    """A parameter's kind of quantity where the effect acts on slides: a length for an angle, N/m for N*m/rad."""
    return _ON_SLIDES.get(parameter.kind, parameter.kind) if slides and not parameter.across else parameter.kind


def no_twists(state: PoseState, settings: Settings) -> Iterable[Twist]:
    """Nothing: for effects that are pure play."""
    del state, settings
    return ()


def no_play(state: PoseState, settings: Settings) -> Iterable[Interval | Disc]:
    """Nothing: for effects without play."""
    del state, settings
    return ()


@dataclass(frozen=True)
class Effect:
    """One kind of physics that moves the tip.

    `automatic`: in the model wherever the arm file has its data, unless `leave_out` names it; otherwise only where
    `effects` names it. `needs` says what a recording must hold to show it, `aliases` what it cannot be told from.
    `twists` gives what it does at a pose, `play` what it leaves free. A recording knows more than a design: there
    `seated` says where the play came to lie, by the load or by the side of approach.
    `together` marks physics that all links or joints usually share (one material, one air): a diagnosis then also
    tries one parameter for all of them. `before_encoder` marks what moves the joint away from its command but is seen
    by the encoder: it moves the tip only as long as the coordinates are commands. `requires` names the conditions
    without which it moves nothing, `enough` the sets of parameters of which an entry must hold one to say anything
    (none named: any one parameter that is a size), `only` the joints outside which it moves nothing.
    `through_flexibility` marks loads that move the tip by what gives in the arm, what `effects` add to that included.
    `least_travel` (rad, m) is how far a joint must have gone in a recording for the effect to be sought there.
    """

    id: str
    title: str
    formula: str
    place: Literal["joint", "link", "base", "tip"]
    cause: Cause
    automatic: bool
    needs: str
    aliases: tuple[str, ...]
    source: str
    parameters: tuple[Parameter, ...] = ()
    twists: Callable[[PoseState, Settings], Iterable[Twist]] = no_twists
    play: Callable[[PoseState, Settings], Iterable[Interval | Disc]] = no_play
    seated: Callable[[PoseState, Settings], Iterable[Twist]] = no_twists
    together: bool = False
    before_encoder: bool = False
    requires: tuple[Condition, ...] = ()
    enough: tuple[tuple[str, ...], ...] = ()
    only: Only | None = None
    through_flexibility: bool = False
    least_travel: float = 0.0

    def can_act(self, index: int, *, revolute: bool) -> bool:
        """Whether the effect can move anything at joint `index` (from 0), or at the link it carries."""
        if self.only == "joints after the first":
            return index > 0
        return self.only is None or revolute == (self.only == "joints that turn")

    @property
    def sizes(self) -> tuple[Parameter, ...]:
        """The parameters with which the displacement grows from nothing."""
        return tuple(parameter for parameter in self.parameters if parameter.role == "size")

    @property
    def shapes(self) -> tuple[Parameter, ...]:
        """The parameters that change the pattern, and are searched on their grids."""
        return tuple(parameter for parameter in self.parameters if parameter.role == "shape")

    def lacking(self, given: Collection[str]) -> str | None:
        """What parameters named `given` lack for the effect to move anything, as words; None where they do."""
        sets = self.enough or tuple((parameter.name,) for parameter in self.sizes)
        if self.automatic or not sets or any(set(each) <= set(given) for each in sets):
            return None
        return ", or ".join(" and ".join(each) for each in sets)


def drive_motion(state: PoseState, index: int, amount: Scalar) -> tuple[Twist, ...]:
    """What the arm does when drive `index` moves by `amount` (rad or m).

    In a serial arm with relative angles all that follows turns; where angles are absolute (the drive holds its link
    against the base) only the link itself turns and carries the rest along.
    """
    joint = state.joints[index]
    moved = scale(amount, joint.axis)
    if not joint.revolute:
        return (Twist("joint", index, translation=moved),)
    if state.absolute:
        back = scale(-1.0, moved)
        return (Twist("joint", index, rotation=moved), Twist("link", index + joint.spans - 1, rotation=back))
    return (Twist("joint", index, rotation=moved),)
